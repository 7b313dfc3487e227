//! `roughcast bake`.

use std::fs::File;
use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Instant, SystemTime};

use super::options::cache::CacheOptions;
use super::options::job_choice::{JobOptions, JobsError};
use super::options::remote::{RemoteOptionError, RemoteOptions};
use super::options::selection::{SelectionOptions, print_problems};
use super::terminal::outcome::Outcome;
use super::terminal::summary::{notes_to_act_on, summary, total};
use super::work::{Work, Worked};
use crate::cache::CacheError;
use crate::note::{Note, unnamed_engine};
use crate::output::lock::{Kind, OutputLock};
use crate::output::{OutputPath, PublishError};
use crate::project::{InputError, NamedServer, Selected, SelectionError};
use crate::report::{AssetOutcome, RunReport, Status};
use crate::run::{DepfileError, PlannedAsset, guard, plan_assets, split_depfile};
use crate::settings::{RecordedSettings, Settings};
use crate::text::printable;

/// Bake glTF assets: KTX2 textures with the lost roughness in their mips, and a glTF that refers to them.
///
/// Reads .gltf and .glb files and folders of them. Writes a .glb for a .glb, with the KTX2 textures inside, and a .gltf
/// with external textures for a .gltf. Never changes a source.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  roughcast bake helmet.glb -o helmet-baked.glb\n  \
    roughcast bake helmet.gltf -o helmet.glb\n  \
    roughcast bake assets -o baked --engine bevy")]
pub struct Args {
    /// .gltf or .glb files, or folders that are searched for them.
    #[arg(required_unless_present = "plan", value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// Write what was done, chosen and skipped to a JSON file.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Write which files each output was made from, as a Makefile for Make and Ninja. An asset fails if a
    /// file of it has a name that they cannot read.
    #[arg(long, value_name = "FILE")]
    depfile: Option<PathBuf>,
    /// Print the report instead of a summary.
    #[arg(long)]
    json: bool,
    /// Print errors only.
    #[arg(short, long, conflicts_with = "json")]
    quiet: bool,
    /// Print all notes, not only those that ask for something. The report always has them all.
    #[arg(short, long, conflicts_with_all = ["quiet", "json"])]
    verbose: bool,
    /// Print the settings of each asset and where each comes from, and bake nothing.
    #[arg(long, conflicts_with_all = ["json", "plan"])]
    print_config: bool,
    #[command(flatten)]
    cache: CacheOptions,
    #[command(flatten)]
    jobs: JobOptions,
    #[command(flatten)]
    selection: SelectionOptions,
    #[command(flatten)]
    remote: RemoteOptions,
}

/// Why nothing is baked.
#[derive(Debug, thiserror::Error)]
enum BakeCommandError {
    /// Standard output or standard error cannot be written to.
    #[error(transparent)]
    Io(#[from] io::Error),
    #[error(transparent)]
    Cache(#[from] CacheError),
    #[error(transparent)]
    Jobs(#[from] JobsError),
    #[error(transparent)]
    Selection(#[from] SelectionError),
    #[error(transparent)]
    Publish(#[from] PublishError),
    #[error(transparent)]
    Remote(#[from] RemoteOptionError),
}

/// What is to be baked.
#[derive(Default)]
struct Order {
    planned: Vec<PlannedAsset>,
    /// Inputs that cannot be used.
    errors: Vec<InputError>,
    settings: Settings,
    configs: Vec<PathBuf>,
    server: Option<NamedServer>,
    /// Notes on the engines of the presets; none for a plan, which has no presets.
    notes: Vec<Note>,
    /// Whether nothing says how the engine of an asset shades anisotropic lobes.
    leaves_engine_open: bool,
    /// The output folder; `None` for a plan, whose jobs name their own.
    output: Option<PathBuf>,
    /// The lock on the output folder, held until all outputs are written. A plan takes no lock, because other parts of
    /// the plan write to the same folders.
    _lock: Option<OutputLock>,
    /// The outcome so far.
    outcome: Outcome,
}

/// Assets with dependencies that a depfile cannot name, each with the reason.
type Refused = Vec<(PlannedAsset, DepfileError)>;

/// Runs the command.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    match args.bake(out, err) {
        Ok(outcome) => Ok(outcome),
        Err(BakeCommandError::Io(error)) => Err(error),
        Err(reason) => {
            writeln!(err, "error: {reason}")?;
            Ok(Outcome::Usage)
        }
    }
}

impl Args {
    fn bake(&self, out: &mut dyn Write, err: &mut dyn Write) -> Result<Outcome, BakeCommandError> {
        let start = Instant::now();
        let cache = self.cache.open()?;
        let mut order = match self.order(out, err)? {
            ControlFlow::Continue(order) => order,
            ControlFlow::Break(outcome) => return Ok(outcome),
        };
        let others = order.configs.iter().chain(self.jobs.plan_file());
        let mut guard = guard(&order.planned, order.output.as_deref(), others);
        let mut place = |path: &Option<PathBuf>| path.as_ref().map(|path| guard.reserve_file(path)).transpose();
        let (report_path, depfile_path) = (place(&self.report)?, place(&self.depfile)?);
        self.jobs.choose(&mut order.planned)?;
        let (dependencies, refused) = self.dependencies(&mut order, err)?;
        let work = Work {
            cache: cache.as_ref(),
            settings: &order.settings,
            remote: self.remote.options(order.server.as_ref())?,
            check: &|job| self.jobs.check(job),
            is_quiet: self.quiet,
        };
        let worked = work.run(&order.planned, &mut guard, err, &mut |asset, _| {
            if self.quiet || self.json { Ok(()) } else { out.write_all(summary(asset, self.verbose).as_bytes()) }
        })?;
        order.outcome = order.outcome.and(worked.outcome);
        if self.depfile.is_some() {
            touch_cached(&worked.assets);
        }
        if order.leaves_engine_open && worked.assets.iter().any(|asset| asset.report.has_anisotropic_lobes()) {
            order.notes.push(unnamed_engine());
        }
        if !self.quiet && !self.json {
            out.write_all(total(&worked.assets, start.elapsed()).as_bytes())?;
            if !self.verbose {
                out.write_all(notes_to_act_on(&worked.assets).as_bytes())?;
            }
            order.notes.iter().try_for_each(|note| writeln!(out, "note: {note}"))?;
        }
        let mut outcome = order.outcome;
        let json = if self.json || self.report.is_some() { report(order, refused, worked)? } else { String::new() };
        outcome = outcome.and(write_files([(report_path, &json), (depfile_path, &dependencies)], err)?);
        if self.json {
            out.write_all(json.as_bytes())?;
        }
        Ok(outcome)
    }

    /// Returns what is to be baked: the jobs of a plan, or the assets that are selected. Breaks where nothing is to be
    /// baked.
    fn order(&self, out: &mut dyn Write, err: &mut dyn Write) -> Result<ControlFlow<Outcome, Order>, BakeCommandError> {
        let output = self.selection.output.as_deref();
        if let Some(planned) = self.jobs.planned(output)? {
            return Ok(ControlFlow::Continue(Order { planned, ..Order::default() }));
        }
        let selected = self.selection.selection().find(&self.inputs)?;
        let (is_safe, outcome) = print_problems(&selected, self.quiet, err)?;
        if self.print_config {
            for (input, resolved) in &selected.assets {
                writeln!(out, "# {}\n{resolved}", printable(&input.path.display().to_string()))?;
            }
        }
        if self.print_config || !is_safe {
            return Ok(ControlFlow::Break(outcome));
        }
        let _lock = self.lock(&selected, err)?;
        let planned = plan_assets(&selected.assets);
        let (notes, leaves_engine_open) = (selected.notes_on_engines(), selected.leaves_engine_open());
        let Selected { output, errors, settings, configs, remote: server, .. } = selected;
        let output = Some(output);
        let order =
            Order { planned, errors, settings, configs, server, notes, leaves_engine_open, output, _lock, outcome };
        Ok(ControlFlow::Continue(order))
    }

    /// Locks the output folder, and says so when that takes long.
    fn lock(&self, selected: &Selected, err: &mut dyn Write) -> io::Result<Option<OutputLock>> {
        if selected.assets.is_empty() {
            return Ok(None);
        }
        let kind = if self.jobs.are_parts() { Kind::Parts } else { Kind::Alone };
        OutputLock::take(&selected.output, kind, &mut |message| {
            message.map_or(Ok(()), |message| writeln!(err, "note: {message}")).map(|()| true)
        })
    }

    /// Returns the text of the depfile. Assets that a depfile cannot name are removed from `order`, printed and
    /// returned.
    fn dependencies(&self, order: &mut Order, err: &mut dyn Write) -> io::Result<(String, Refused)> {
        if self.depfile.is_none() {
            return Ok(Default::default());
        }
        let (dependencies, refused) = split_depfile(&mut order.planned, &order.configs);
        for (planned, error) in &refused {
            order.outcome = order.outcome.and(Outcome::Failed);
            writeln!(err, "error: {}: {error}", planned.name)?;
        }
        Ok((dependencies, refused))
    }
}

/// Sets the times of outputs from the cache to now. Make takes outputs that are older than an input for out of date,
/// and would run the command in every build.
fn touch_cached(assets: &[AssetOutcome]) {
    let cached = assets.iter().filter(|asset| asset.status == Status::Cached);
    for output in cached.filter_map(|asset| asset.output.as_ref()) {
        let _ = File::open(output).and_then(|file| file.set_modified(SystemTime::now()));
    }
}

/// Returns the report of the run as JSON.
fn report(order: Order, refused: Refused, worked: Worked) -> io::Result<String> {
    let errors = order
        .errors
        .iter()
        .map(|error| AssetOutcome::failed(error.path().display().to_string(), None, 0.0, error.to_string(), false));
    let refused = refused.into_iter().map(|(PlannedAsset { name, job }, error)| {
        AssetOutcome::failed(name, job.ok().map(|job| job.id), 0.0, error.to_string(), false)
    });
    let assets = errors.chain(refused).chain(worked.assets).collect();
    let settings = RecordedSettings::new(&order.settings, order.settings.model);
    let report = RunReport::new(settings, assets, order.notes, worked.remote);
    Ok(serde_json::to_string_pretty(&report).map_err(io::Error::other)? + "\n")
}

/// Writes files of the run itself, and prints those that cannot be written.
fn write_files(files: [(Option<OutputPath>, &String); 2], err: &mut dyn Write) -> io::Result<Outcome> {
    let mut outcome = Outcome::Done;
    for (path, text) in files {
        if let Some(path) = path
            && let Err(error) = path.write(text.as_bytes())
        {
            writeln!(err, "error: {error}")?;
            outcome = Outcome::Failed;
        }
    }
    Ok(outcome)
}
