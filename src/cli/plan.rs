//! `roughcast plan`.

use std::io::{self, Write};
use std::path::PathBuf;

use super::jobs::plan;
use super::merge;
use super::outcome::Outcome;
use super::selection::Selection;
use crate::run::Plan;
use crate::text::printable;

/// Print the jobs that a bake would run, and run none.
///
/// A job is one asset, named by all that decides on its outputs. Run a plan with `bake --plan FILE`, in parts with
/// `--shard I/N`, on any machine that has the files at the same relative paths.
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
    selection: Selection,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    Merge(merge::Args),
}

/// Prints the plan.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    if let Some(Command::Merge(args)) = &args.command {
        return merge::run(args, out, err);
    }
    let selected = match args.selection.find(&args.inputs) {
        Ok(selected) => selected,
        Err(reason) => {
            writeln!(err, "error: {reason}")?;
            return Ok(Outcome::Usage);
        }
    };
    let (is_safe, mut outcome) = selected.complain(false, err)?;
    if !is_safe {
        return Ok(outcome);
    }
    let mut jobs = Vec::new();
    for planned in plan(&selected.assets) {
        let failed = match planned.job {
            // The plan is for other machines too.
            Ok(job) if job.source.is_absolute() || job.output.is_absolute() => {
                writeln!(
                    err,
                    "error: {}: expected paths relative to the working folder, found an absolute one",
                    planned.name
                )?;
                return Ok(Outcome::Usage);
            }
            Ok(job) => {
                let missing = job.inputs.iter().find(|input| input.blake3.is_none());
                let missing = missing.map(|input| {
                    format!("expected a readable file at {}; the document refers to it", input.path.display())
                });
                let Some(reason) = missing.or_else(|| job.check_names().err().map(|error| error.to_string())) else {
                    jobs.push(job);
                    continue;
                };
                outcome = outcome.and(Outcome::Failed);
                reason
            }
            Err(error) => {
                outcome = outcome.and(if error.is_passing() { Outcome::Retry } else { Outcome::Failed });
                error.to_string()
            }
        };
        writeln!(err, "error: {}: {failed}", planned.name)?;
    }
    if args.json {
        let plan = Plan { version: env!("CARGO_PKG_VERSION").to_owned(), jobs };
        writeln!(out, "{}", serde_json::to_string_pretty(&plan).map_err(io::Error::other)?)?;
    } else {
        for job in &jobs {
            let (from, to) = (job.source.display().to_string(), job.output.display().to_string());
            writeln!(
                out,
                "{:.12}  {} -> {}, {} inputs, {:.1} MB",
                job.id,
                printable(&from),
                printable(&to),
                job.inputs.len(),
                job.cost as f64 / 1e6
            )?;
        }
    }
    Ok(outcome)
}
