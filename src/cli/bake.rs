//! `roughcast bake`.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::{Instant, SystemTime};

use super::Outcome;
use super::depfile::depfile;
use super::jobs::{self, JobOptions, Planned};
use super::progress::Progress;
use super::report::{Asset, Report};
use super::selection::Selection;
use crate::bake::{Places, Settings, write_file};
use crate::cache::{Cache, CacheError};
use crate::plan::{self, Lookup, RunError};

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
    /// Write which files each output was made from, as a Makefile for Make and Ninja.
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
    /// Keep outputs in this folder, and take from it what was baked before. Several runs may share it.
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Largest size of that folder; what was not used for longest goes first. K, M, G and T are powers of 1024.
    #[arg(long, value_name = "SIZE", value_parser = size, default_value = "10G")]
    cache_size: u64,
    #[command(flatten)]
    jobs: JobOptions,
    #[command(flatten)]
    selection: Selection,
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
    let mut outcome = Outcome::Done;
    let (planned, failed, settings, configs) = match args.jobs.planned() {
        Some(Err(reason)) => return usage(err, &reason),
        Some(Ok(planned)) => (planned, Vec::new(), Settings::default(), Vec::new()),
        None => {
            let selected = match args.selection.find(&args.inputs) {
                Ok(selected) => selected,
                Err(reason) => return usage(err, &reason),
            };
            let (is_safe, so_far) = selected.complain(err)?;
            if args.print_config {
                for (input, resolved) in &selected.assets {
                    print(out, &format!("# {}\n{resolved}\n", input.path.display()))?;
                }
            }
            if args.print_config || !is_safe {
                return Ok(so_far);
            }
            outcome = so_far;
            (jobs::plan(&selected.assets), selected.errors, selected.settings, selected.configs)
        }
    };
    let planned = match args.jobs.choose(planned) {
        Ok(planned) => planned,
        Err(reason) => return usage(err, &reason),
    };
    let cache = args.cache.as_deref().map(Cache::new);
    let dependencies = depfile(planned.iter().filter_map(|planned| planned.job.as_ref().ok()), &configs);
    let progress = Progress::new(planned.len(), args.quiet);
    let mut report = Report {
        version: env!("CARGO_PKG_VERSION"),
        settings: settings.to_json(settings.model),
        assets: failed.iter().map(|e| Asset::failed(e.path().display().to_string(), 0.0, e.to_string())).collect(),
    };
    let mut places = Places::default();
    // What to tell of an error, and whether trying again may help.
    let told = |error: &RunError| (error.to_string(), error.is_passing());
    // Assets are baked side by side, and written and told of in order.
    let prepare = |index: usize| {
        let start = Instant::now();
        let Planned { name, job } = &planned[index];
        progress.set(index, 0.0, name);
        let prepared = job.as_ref().map_err(told).and_then(|job| {
            args.jobs.check(job).map_err(|error| told(&error))?;
            let lookup = cache.as_ref().map(|cache| Lookup::new(job, cache));
            let prepared = plan::prepare(job, lookup, &|share| progress.set(index, share, name));
            Ok((job, prepared.map_err(|error| told(&error))?))
        });
        (prepared, start.elapsed().as_secs_f64())
    };
    plan::in_order(planned.len(), rayon::current_num_threads(), prepare, |index, (prepared, seconds)| {
        let name = &planned[index].name;
        let start = Instant::now();
        let mut warn = |error: &CacheError| {
            // The bake does not depend on who reads this.
            let _ = progress.suspend(|| writeln!(err, "warning: {name}: {error}"));
        };
        let result = prepared.and_then(|(job, prepared)| {
            let done = plan::finish(job, prepared, &mut places, cache.as_ref(), &mut warn);
            done.and_then(|done| Ok((job.typed_settings()?, done))).map_err(|error| told(&error))
        });
        let seconds = seconds + start.elapsed().as_secs_f64();
        let asset = match result {
            Ok((own, done)) => {
                if args.depfile.is_some() && done.is_cached {
                    // Make takes what is older than an input for stale, and would ask again and again.
                    let _ = File::open(&done.output).and_then(|file| file.set_modified(SystemTime::now()));
                }
                Asset::done(name.clone(), &done, seconds, (own != settings).then_some(own))
            }
            Err((message, is_passing)) => {
                outcome = outcome.and(if is_passing { Outcome::Retry } else { Outcome::Failed });
                progress.suspend(|| writeln!(err, "error: {name}: {message}"))?;
                Asset::failed(name.clone(), seconds, message)
            }
        };
        progress.set(index, 1.0, name);
        if !args.quiet && !args.json {
            progress.suspend(|| print(out, &asset.summary()))?;
        }
        report.assets.push(asset);
        Ok::<(), io::Error>(())
    })?;
    progress.finish();
    if let Some(cache) = &cache
        && let Err(error) = cache.trim(args.cache_size)
    {
        writeln!(err, "warning: {error}")?;
    }
    let json = if args.json || args.report.is_some() {
        serde_json::to_string_pretty(&report).map_err(io::Error::other)? + "\n"
    } else {
        String::new()
    };
    for (path, text) in [(&args.report, &json), (&args.depfile, &dependencies)] {
        if let Some(path) = path
            && let Err(error) = write_file(path, text.as_bytes())
        {
            writeln!(err, "error: {error}")?;
            outcome = outcome.and(Outcome::Failed);
        }
    }
    if args.json {
        print(out, &json)?;
    }
    Ok(outcome)
}

/// A reader that has seen enough (`roughcast bake ... | head`) does not end the bake.
fn print(out: &mut dyn Write, text: &str) -> io::Result<()> {
    match out.write_all(text.as_bytes()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

/// A number of bytes, with K, M, G or T for powers of 1024.
fn size(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let power = match text[digits.len()..].to_ascii_uppercase().as_str() {
        "" => Some(0),
        "K" => Some(1),
        "M" => Some(2),
        "G" => Some(3),
        "T" => Some(4),
        _ => None,
    };
    let bytes = power.and_then(|power| digits.parse::<u64>().ok()?.checked_mul(1 << (10 * power)));
    bytes.ok_or_else(|| format!("expected a number of bytes such as 500M or 10G, found {text:?}"))
}
