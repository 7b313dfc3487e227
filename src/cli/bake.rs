//! `roughcast bake`.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::SystemTime;

use super::cached::CacheOptions;
use super::depfile;
use super::jobs::{self, JobOptions, Planned};
use super::outcome::Outcome;
use super::remote::RemoteOptions;
use super::report::{Asset, Report, Status};
use super::selection::Selection;
use super::work::{Work, Worked};
use crate::output::PublishError;
use crate::output::lock::{Kind, OutputLock};
use crate::settings::Settings;
use crate::text::printable;

/// Bake glTF assets: KTX2 textures with the lost roughness in their mips, and a glTF that refers to them.
///
/// Reads .gltf and .glb files and folders of them; writes to another folder and never touches a source.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast bake assets/helmet.gltf -o baked --engine bevy")]
pub struct Args {
    /// .gltf or .glb files, or folders that are searched for them.
    #[arg(required_unless_present = "plan", value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// Write what was done, chosen and skipped to a JSON file.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Write which files each output was made from, as a Makefile for Make and Ninja. An asset whose files
    /// have names that these cannot read fails.
    #[arg(long, value_name = "FILE")]
    depfile: Option<PathBuf>,
    /// Print that report instead of a summary.
    #[arg(long)]
    json: bool,
    /// Print errors only.
    #[arg(short, long, conflicts_with = "json")]
    quiet: bool,
    /// Print the settings of each asset and where each comes from, and bake nothing.
    #[arg(long, conflicts_with_all = ["json", "plan"])]
    print_config: bool,
    #[command(flatten)]
    cache: CacheOptions,
    #[command(flatten)]
    jobs: JobOptions,
    #[command(flatten)]
    selection: Selection,
    #[command(flatten)]
    remote: RemoteOptions,
}

/// Bakes what `args` name.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let usage = |err: &mut dyn Write, reason: &dyn Display| -> io::Result<Outcome> {
        writeln!(err, "error: {reason}")?;
        Ok(Outcome::Usage)
    };
    let cache = match args.cache.open() {
        Ok(cache) => cache,
        Err(reason) => return usage(err, &reason),
    };
    let mut outcome = Outcome::Done;
    // Held until all outputs are written. Jobs of a plan take none: other parts of the plan write to their folders, too.
    let mut _lock = None;
    let planned = args.jobs.planned(args.selection.output.as_deref());
    let (planned, failed, settings, configs, server, output) = match planned {
        Some(Err(reason)) => return usage(err, &reason),
        Some(Ok(planned)) => (planned, Vec::new(), Settings::default(), Vec::new(), None, None),
        None => {
            let selected = match args.selection.find(&args.inputs) {
                Ok(selected) => selected,
                Err(reason) => return usage(err, &reason),
            };
            let (is_safe, so_far) = selected.complain(args.quiet, err)?;
            if args.print_config {
                for (input, resolved) in &selected.assets {
                    writeln!(out, "# {}\n{resolved}", printable(&input.path.display().to_string()))?;
                }
            }
            if args.print_config || !is_safe {
                return Ok(so_far);
            }
            outcome = so_far;
            if !selected.assets.is_empty() {
                let kind = if args.jobs.are_parts() { Kind::Parts } else { Kind::Alone };
                _lock = OutputLock::take(&selected.output, kind, &mut |message| {
                    message.map_or(Ok(()), |message| writeln!(err, "note: {message}")).map(|()| true)
                })?;
            }
            let output = Some(selected.output);
            let planned = jobs::plan(&selected.assets);
            (planned, selected.errors, selected.settings, selected.configs, selected.remote, output)
        }
    };
    let mut guard = jobs::guard(&planned, output.as_deref(), configs.iter().chain(args.jobs.plan_file()));
    let mut place = |path: &Option<PathBuf>| path.as_ref().map(|path| guard.place(path)).transpose();
    let places = (|| Ok::<_, PublishError>([place(&args.report)?, place(&args.depfile)?]))();
    let [report_place, depfile_place] = match places {
        Ok(places) => places,
        Err(reason) => return usage(err, &reason),
    };
    let mut planned = match args.jobs.choose(planned) {
        Ok(planned) => planned,
        Err(reason) => return usage(err, &reason),
    };
    let (dependencies, refused) = match args.depfile {
        Some(_) => depfile::split(&mut planned, &configs),
        None => Default::default(),
    };
    for (planned, error) in &refused {
        outcome = outcome.and(Outcome::Failed);
        writeln!(err, "error: {}: {error}", planned.name)?;
    }
    let remote = match args.remote.options(server.as_ref()) {
        Ok(remote) => remote,
        Err(reason) => return usage(err, &reason),
    };
    let work = Work {
        cache: cache.as_ref(),
        settings: &settings,
        remote,
        check: &|job| args.jobs.check(job),
        is_quiet: args.quiet,
    };
    let Worked { assets, outcome: ended, remote } = work.run(planned, &mut guard, err, &mut |asset, _| {
        if args.quiet || args.json { Ok(()) } else { out.write_all(asset.summary().as_bytes()) }
    })?;
    outcome = outcome.and(ended);
    if args.depfile.is_some() {
        for output in assets.iter().filter(|a| a.status == Status::Cached).filter_map(|a| a.output.as_ref()) {
            // Make takes what is older than an input for stale, and would ask again and again.
            let _ = File::open(output).and_then(|file| file.set_modified(SystemTime::now()));
        }
    }
    let failed = failed.iter().map(|e| Asset::failed(e.path().display().to_string(), None, 0.0, e.to_string(), false));
    let refused = refused.into_iter().map(|(Planned { name, job }, error)| {
        Asset::failed(name, job.ok().map(|job| job.id), 0.0, error.to_string(), false)
    });
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        settings: settings.to_json(settings.model),
        assets: failed.chain(refused).chain(assets).collect(),
        remote,
    };
    let json = if args.json || args.report.is_some() {
        serde_json::to_string_pretty(&report).map_err(io::Error::other)? + "\n"
    } else {
        String::new()
    };
    for (place, text) in [(report_place, &json), (depfile_place, &dependencies)] {
        if let Some(place) = place
            && let Err(error) = place.write(text.as_bytes())
        {
            writeln!(err, "error: {error}")?;
            outcome = outcome.and(Outcome::Failed);
        }
    }
    if args.json {
        out.write_all(json.as_bytes())?;
    }
    Ok(outcome)
}
