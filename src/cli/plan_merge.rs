//! `roughcast plan merge`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::terminal::outcome::Outcome;
use crate::input_file::{Unreadable, read_file};
use crate::output::{Guard, OutputPath, PublishError};
use crate::report::{PartReport, ReportError};
use crate::run::{Merged, Plan, PlanError};
use crate::text::printable;

/// List the jobs of a plan that failed or are missing after the plan was run in parts.
///
/// Reads the reports of the parts and checks that all outputs exist; without reports, only the outputs decide. Exit
/// code 1: some jobs failed permanently and all others are done; 4: some jobs were not run, or another try may succeed.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast plan merge plan.json reports/*.json --rest rest.json\n  \
    roughcast bake --plan rest.json")]
pub struct Args {
    /// The file that `roughcast plan --json` wrote.
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    /// The file that `bake --report` wrote for each part.
    #[arg(value_name = "REPORT")]
    reports: Vec<PathBuf>,
    /// Write a plan of the jobs that are to be run, or to be run again.
    #[arg(long, value_name = "FILE")]
    rest: Option<PathBuf>,
    /// Read the reports only: the outputs are elsewhere.
    #[arg(long, requires = "reports")]
    no_outputs: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Why nothing is merged.
#[derive(Debug, thiserror::Error)]
enum MergeError {
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error("{}: expected a readable file, found: {}", path.display(), Unreadable(error))]
    Read { path: PathBuf, error: io::Error },
    #[error("{}: {error}", path.display())]
    Report { path: PathBuf, error: ReportError },
    #[error(transparent)]
    Publish(#[from] PublishError),
}

/// Merges the reports and prints which jobs failed or are missing.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let (plan, reports, rest) = match args.read() {
        Ok(read) => read,
        Err(error) => {
            writeln!(err, "error: {error}")?;
            return Ok(Outcome::Usage);
        }
    };
    for (path, _) in args.reports.iter().zip(&reports).filter(|(_, report)| plan.is_foreign(report)) {
        writeln!(
            err,
            "warning: {}: expected a report of this plan, found none of its jobs there; leave the report out, or name \
             its plan",
            path.display()
        )?;
    }
    let merged = Merged::new(&plan, &reports, !args.no_outputs);
    // A permanent failure does not outweigh missing jobs here: exit code 1 means that all other jobs are done.
    let mut outcome = match (merged.missing.is_empty(), merged.failed.is_empty()) {
        (false, _) => Outcome::Retry,
        (true, false) => Outcome::Failed,
        (true, true) => Outcome::Done,
    };
    if let Some(path) = rest {
        let json = serde_json::to_string_pretty(&merged.rest(&plan)).map_err(io::Error::other)? + "\n";
        if let Err(error) = path.write(json.as_bytes()) {
            writeln!(err, "error: {error}")?;
            outcome = outcome.and(Outcome::Failed);
        }
    }
    if args.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&merged).map_err(io::Error::other)?)?;
    } else {
        print(&merged, out)?;
    }
    Ok(outcome)
}

impl Args {
    /// Reads the plan and the reports. Returns them with the path of the plan of the rest.
    fn read(&self) -> Result<(Plan, Vec<PartReport>, Option<OutputPath>), MergeError> {
        let reports = self.reports.iter().map(|path| read_report(path)).collect::<Result<Vec<_>, _>>()?;
        let plan = Plan::read(&self.plan)?;
        let mut guard = Guard::default();
        plan.jobs.iter().for_each(|job| job.protect(&mut guard));
        self.reports.iter().chain([&self.plan]).for_each(|path| guard.add_source(path));
        let rest = self.rest.as_ref().map(|path| guard.reserve_file(path)).transpose()?;
        Ok((plan, reports, rest))
    }
}

fn print(merged: &Merged, out: &mut dyn Write) -> io::Result<()> {
    let Merged { jobs, done, failed, missing, .. } = merged;
    writeln!(out, "{jobs} jobs: {done} done, {} failed, {} missing", failed.len(), missing.len())?;
    for (word, list) in [("failed", failed), ("missing", missing)] {
        for open in list {
            writeln!(out, "{word} {}: {}", printable(&open.source), printable(&open.reason))?;
        }
    }
    Ok(())
}

fn read_report(path: &Path) -> Result<PartReport, MergeError> {
    let bytes = read_file(path).map_err(|error| MergeError::Read { path: path.to_owned(), error })?;
    PartReport::parse(&bytes).map_err(|error| MergeError::Report { path: path.to_owned(), error })
}
