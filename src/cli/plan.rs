//! `roughcast plan`.

use std::io::{self, Write};
use std::path::PathBuf;

use super::options::selection::{SelectionOptions, print_problems};
use super::plan_merge;
use super::terminal::outcome::Outcome;
use crate::run::{Job, Plan, PlannedAsset, plan_assets};
use crate::text::{counted, printable};

/// Print the jobs that a bake would run, and run none.
///
/// A job bakes one asset, and its id covers everything that decides on its outputs. Run a plan with `bake --plan FILE`,
/// or a part of it with `--shard I/N`, on any machine that has the files at the same relative paths.
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true, disable_help_subcommand = true)]
#[command(after_help = "Example:\n  roughcast plan assets -o baked --json > plan.json\n  \
    roughcast bake --plan plan.json --shard 1/8 --report reports/1.json\n  \
    roughcast plan merge plan.json reports/*.json")]
pub struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    /// .gltf or .glb files, or folders that are searched for them, relative to the working folder.
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// Print the whole plan, with inputs, outputs and command lines.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    selection: SelectionOptions,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    Merge(plan_merge::Args),
}

/// Why an asset has no place in a plan.
struct Unplanned {
    reason: String,
    outcome: Outcome,
}

/// Prints the plan.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    if let Some(Command::Merge(args)) = &args.command {
        return plan_merge::run(args, out, err);
    }
    let selected = match args.selection.selection().find(&args.inputs) {
        Ok(selected) => selected,
        Err(reason) => {
            writeln!(err, "error: {reason}")?;
            return Ok(Outcome::Usage);
        }
    };
    let (is_safe, mut outcome) = print_problems(&selected, false, err)?;
    if !is_safe {
        return Ok(outcome);
    }
    let mut jobs = Vec::new();
    for PlannedAsset { name, job } in plan_assets(&selected.assets) {
        let job = job.map_err(|error| {
            let outcome = if error.is_transient() { Outcome::Retry } else { Outcome::Failed };
            Unplanned { reason: error.to_string(), outcome }
        });
        match job.and_then(checked) {
            Ok(job) => jobs.push(job),
            Err(Unplanned { reason, outcome: ended }) => {
                writeln!(err, "error: {name}: {reason}")?;
                outcome = outcome.and(ended);
            }
        }
        if outcome == Outcome::Usage {
            return Ok(outcome);
        }
    }
    if args.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&Plan::new(jobs)).map_err(io::Error::other)?)?;
    } else {
        jobs.iter().try_for_each(|job| print_job(job, out))?;
    }
    Ok(outcome)
}

/// Checks that other machines can run `job`, too.
fn checked(job: Job) -> Result<Job, Unplanned> {
    if job.source.is_absolute() || job.output.is_absolute() {
        let reason = "expected paths relative to the working folder, found an absolute one; other machines have other \
                      folders, so name relative paths";
        return Err(Unplanned { reason: reason.to_owned(), outcome: Outcome::Usage });
    }
    let missing = job.inputs.iter().find(|input| input.blake3.is_none());
    let missing =
        missing.map(|input| format!("expected a readable file at {}; the document refers to it", input.path.display()));
    match missing.or_else(|| job.check_names().err().map(|error| error.to_string())) {
        Some(reason) => Err(Unplanned { reason, outcome: Outcome::Failed }),
        None => Ok(job),
    }
}

fn print_job(job: &Job, out: &mut dyn Write) -> io::Result<()> {
    let (from, to) = (job.source.display().to_string(), job.output.display().to_string());
    let (from, to) = (printable(&from), printable(&to));
    let (inputs, megabytes) = (counted(job.inputs.len(), "input"), job.cost as f64 / 1e6);
    writeln!(out, "{:.12}  {from} -> {to}, {inputs}, {megabytes:.1} MB", job.id)
}
