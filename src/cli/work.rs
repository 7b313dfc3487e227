//! Running jobs with a progress bar, and printing what becomes of them.

use std::io::{self, Write};

use super::terminal::outcome::Outcome;
use super::terminal::progress::ProgressLine;
use crate::cache::Cache;
use crate::output::Guard;
use crate::remote::{self, Options, ScheduleError};
use crate::report::{AssetOutcome, Counts, Status};
use crate::run::{Job, PlannedAsset, RunError, RunEvents, Scheduler};
use crate::settings::Settings;

/// How jobs are run.
pub struct Work<'a> {
    /// The cache.
    pub cache: Option<&'a Cache>,
    /// The settings of the run.
    pub settings: &'a Settings,
    /// The server that bakes, if there is one.
    pub remote: Option<Options>,
    /// Checks that a job may be run.
    pub check: &'a (dyn Fn(&Job) -> Result<(), RunError> + Sync),
    /// Whether the progress bar is hidden.
    pub is_quiet: bool,
}

/// What became of all jobs.
pub struct Worked {
    /// The outcomes of the assets, in order.
    pub assets: Vec<AssetOutcome>,
    /// The outcome of the run.
    pub outcome: Outcome,
    /// What a server did, if there is one.
    pub remote: Option<Counts>,
}

/// Prints the events of a run around a progress bar, and collects the outcomes.
struct Printer<'a> {
    progress: &'a ProgressLine,
    err: &'a mut dyn Write,
    print: &'a mut dyn FnMut(&AssetOutcome, &mut dyn Write) -> io::Result<()>,
    assets: Vec<AssetOutcome>,
    outcome: Outcome,
}

impl RunEvents for Printer<'_> {
    fn warn(&mut self, warning: &str) {
        // Whether anybody reads the warning changes nothing.
        let _ = self.progress.suspend(|| writeln!(self.err, "warning: {warning}"));
    }

    fn asset(&mut self, asset: AssetOutcome) -> io::Result<()> {
        if let Some(error) = &asset.error {
            self.progress.suspend(|| writeln!(self.err, "error: {}: {error}", asset.input))?;
        }
        self.outcome = self.outcome.and(match asset.status {
            Status::Failed if asset.retry => Outcome::Retry,
            Status::Failed => Outcome::Failed,
            _ => Outcome::Done,
        });
        self.progress.suspend(|| (self.print)(&asset, self.err))?;
        self.assets.push(asset);
        Ok(())
    }
}

impl Work<'_> {
    /// Runs `planned` where `guard` allows it. Prints warnings and errors to `err`, and every outcome with `print`.
    ///
    /// # Errors
    /// When `err` cannot be written to, and the errors of `print`.
    pub fn run(
        &self,
        planned: &[PlannedAsset],
        guard: &mut Guard,
        err: &mut dyn Write,
        print: &mut dyn FnMut(&AssetOutcome, &mut dyn Write) -> io::Result<()>,
    ) -> io::Result<Worked> {
        let progress = ProgressLine::new(planned.len(), self.is_quiet);
        let scheduler =
            Scheduler { cache: self.cache, settings: self.settings, check: self.check, progress: &progress };
        let (assets, outcome) = (Vec::with_capacity(planned.len()), Outcome::Done);
        let mut printer = Printer { progress: &progress, err, print, assets, outcome };
        let scheduled = remote::schedule(planned, &scheduler, self.remote.as_ref(), guard, &mut printer);
        let Printer { assets, outcome, err, .. } = printer;
        progress.finish();
        match scheduled {
            Ok(remote) => Ok(Worked { assets, outcome, remote }),
            Err(ScheduleError::Io(error)) => Err(error),
            Err(ScheduleError::Remote(error)) => {
                writeln!(err, "error: {error}")?;
                let ended = if error.is_transient() { Outcome::Retry } else { Outcome::Usage };
                Ok(Worked { assets, outcome: outcome.and(ended), remote: None })
            }
        }
    }
}
