//! `roughcast plan merge`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::jobs::{JobsError, read_plan};
use super::outcome::Outcome;
use crate::bake::read_file;
use crate::output::Guard;
use crate::run::{Merged, PartReport};
use crate::text::printable;

/// Tell what is missing and what failed of a plan that was run in parts.
///
/// Goes by the reports of the parts and looks whether all outputs are there; without reports it only looks. Exit code 1: some
/// jobs failed for good and all others are done; 4: some were not run, or are worth another try.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast plan merge plan.json reports/*.json --rest rest.json\n  \
    roughcast bake --plan rest.json")]
pub struct Args {
    /// What `roughcast plan --json` wrote.
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    /// What `bake --report` wrote for each part.
    #[arg(value_name = "REPORT")]
    reports: Vec<PathBuf>,
    /// Write a plan of the jobs that are to be run, or run again.
    #[arg(long, value_name = "FILE")]
    rest: Option<PathBuf>,
    /// Go by the reports alone: the outputs are elsewhere.
    #[arg(long, requires = "reports")]
    no_outputs: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Prints what is missing.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let read = || -> Result<_, JobsError> {
        let reports: Result<Vec<PartReport>, JobsError> = args.reports.iter().map(|path| read_report(path)).collect();
        Ok((read_plan(&args.plan)?, reports?))
    };
    let (plan, reports) = match read() {
        Ok(read) => read,
        Err(error) => {
            writeln!(err, "error: {error}")?;
            return Ok(Outcome::Usage);
        }
    };
    let mut guard = Guard::default();
    plan.jobs.iter().for_each(|job| job.protect(&mut guard));
    args.reports.iter().chain([&args.plan]).for_each(|path| guard.add_source(path));
    let rest = match args.rest.as_ref().map(|path| guard.place(path)).transpose() {
        Ok(rest) => rest,
        Err(error) => {
            writeln!(err, "error: {error}")?;
            return Ok(Outcome::Usage);
        }
    };
    for (path, report) in args.reports.iter().zip(&reports) {
        if report.is_foreign(&plan) {
            writeln!(err, "warning: {}: expected a report of this plan, found none of its jobs there", path.display())?;
        }
    }
    let merged = Merged::new(&plan, &reports, !args.no_outputs);
    // Unlike that of a bake, since 1 says that all others are done.
    let mut outcome = match (merged.missing.is_empty(), merged.failed.is_empty()) {
        (false, _) => Outcome::Retry,
        (true, false) => Outcome::Failed,
        (true, true) => Outcome::Done,
    };
    if let Some(place) = rest {
        let json = serde_json::to_string_pretty(&merged.rest(&plan)).map_err(io::Error::other)? + "\n";
        if let Err(error) = place.write(json.as_bytes()) {
            writeln!(err, "error: {error}")?;
            outcome = outcome.and(Outcome::Failed);
        }
    }
    if args.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&merged).map_err(io::Error::other)?)?;
    } else {
        let Merged { jobs, done, failed, missing } = &merged;
        writeln!(out, "{jobs} jobs: {done} done, {} failed, {} missing", failed.len(), missing.len())?;
        for (word, list) in [("failed", failed), ("missing", missing)] {
            for open in list {
                writeln!(out, "{word} {}: {}", printable(&open.source), printable(&open.reason))?;
            }
        }
    }
    Ok(outcome)
}

fn read_report(path: &Path) -> Result<PartReport, JobsError> {
    let bytes = read_file(path).map_err(|error| JobsError::Read { path: path.to_owned(), error })?;
    serde_json::from_slice(&bytes)
        .map_err(|error| JobsError::NoReport { path: path.to_owned(), reason: error.to_string() })
}
