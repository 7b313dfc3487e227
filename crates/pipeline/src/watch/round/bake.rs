//! Bakes what was planned at a look.

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::Round;
use crate::cache::CacheError;
use crate::output::lock::{Kind, OutputLock};
use crate::output::{Guard, PublishError};
use crate::project::{Input, Resolved};
use crate::run::{Lookup, MemoryBudget, RunError, Written, finish, prepare};
use crate::watch::asset::{KnownAsset, Planned, State};
use crate::watch::journal::Journal;
use crate::watch::ledger::Removed;

/// The shortest time after which a lock or a vanished disk is tried again.
const RETRY: Duration = Duration::from_secs(1);

/// The shortest pause after a failed try, in durations of the try: a disk may stay full for long.
const RETRY_SHARE: u32 = 10;

/// When to try failed assets again.
#[derive(Default)]
struct Retry(Option<Duration>);

impl Retry {
    fn after(&mut self, delay: Option<Duration>) {
        self.0 = [self.0, delay].into_iter().flatten().min();
    }
}

/// A planned asset and what its bake needs.
struct PlannedInput<'i, 'c> {
    input: &'i Input,
    resolved: &'i Resolved,
    planned: Planned,
    lookup: Option<Lookup<'c>>,
}

impl Round {
    /// Bakes what is `planned`. Returns after how long to try again, if another try may succeed.
    pub(super) fn bake(
        &mut self,
        selected: &[(Input, Resolved)],
        mut planned: Vec<Option<Planned>>,
        stop: &AtomicBool,
        journal: &mut Journal<'_>,
    ) -> io::Result<Option<Duration>> {
        self.drop_known_jobs(selected, &mut planned);
        if planned.iter().all(Option::is_none) {
            return Ok(None);
        }
        let lock = OutputLock::take(&self.output, Kind::Alone, &mut |message| {
            message.map_or(Ok(()), |message| journal.note(&message)).map(|()| !stop.load(Ordering::Acquire))
        })?;
        // Folders that come and go above the outputs would be a reason to look again.
        let _lock = lock.map(OutputLock::keep_folders);
        let cache = self.cache.clone();
        let look_up =
            |planned: &Option<Planned>| Some(Lookup::new(planned.as_ref()?.job.as_ref().ok()?, cache.as_ref()?));
        let lookups: Vec<Option<Lookup<'_>>> = planned.par_iter().map(look_up).collect();
        let (mut guard, mut retry) = (self.guard(&planned), Retry::default());
        for (((input, resolved), planned), lookup) in selected.iter().zip(planned).zip(lookups) {
            let Some(planned) = planned else {
                if self.loses_a_path(input, &mut guard) {
                    retry.after(Some(Duration::ZERO));
                }
                continue;
            };
            if stop.load(Ordering::Acquire) {
                return Ok(retry.0);
            }
            retry.after(self.bake_asset(PlannedInput { input, resolved, planned, lookup }, &mut guard, journal)?);
        }
        self.drop_incomplete(selected, &mut guard);
        Ok(retry.0)
    }

    /// Removes assets from `planned` whose job ended before: their files were touched, or changed and changed back.
    fn drop_known_jobs(&mut self, selected: &[(Input, Resolved)], planned: &mut [Option<Planned>]) {
        for ((input, resolved), slot) in selected.iter().zip(planned) {
            if let Some(known) = self.assets.get_mut(&input.path)
                && let Some(planned) = slot.take_if(|planned| known.has_job(planned, input))
            {
                (known.seen, known.values) = (planned.seen, resolved.values.clone());
            }
        }
    }

    /// Registers the outputs of an unchanged asset in `guard`. An asset keeps its paths unless an asset before it takes
    /// one of them, as in a bake of all assets. Returns whether one is taken; then the asset is to be baked again.
    fn loses_a_path(&mut self, input: &Input, guard: &mut Guard) -> bool {
        let Some(KnownAsset { state, .. }) = self.assets.get_mut(&input.path) else { return false };
        let State::Done(written) = state else { return false };
        if written.iter().all(|file| guard.reserve_existing(&file.path, &file.source)) {
            return false;
        }
        *state = State::Failed { error: String::new(), again: true, kept: std::mem::take(written) };
        true
    }

    /// Bakes one asset. Returns after how long to try again, if another try may succeed.
    fn bake_asset(
        &mut self,
        asset: PlannedInput<'_, '_>,
        guard: &mut Guard,
        journal: &mut Journal<'_>,
    ) -> io::Result<Option<Duration>> {
        let PlannedInput { input, resolved, planned: Planned { job, seen }, lookup } = asset;
        let (start, name) = (Instant::now(), input.path.display().to_string());
        let id = job.as_ref().ok().map(|job| job.id);
        let mut warn = |error: CacheError| {
            let subject = if error.is_general() { String::new() } else { format!("{name}: ") };
            // Whether anybody reads the warning changes nothing.
            let _ = journal.warn(&format_args!("{subject}{error}"));
        };
        let result = job.and_then(|job| {
            let prepared = prepare(&job, lookup, &MemoryBudget::new(1), &|_| ());
            finish(&job, prepared, guard, &mut warn)
        });
        let mut retry = None;
        let state = match result {
            Ok(done) => {
                journal.baked(&name, &done, start.elapsed().as_secs_f64())?;
                let removed = |path: &PathBuf| Removed { path: path.clone(), asset: input.path.clone() };
                journal.removed(&done.removed.iter().map(removed).collect::<Vec<_>>())?;
                self.ledger.set(&input.path, &self.output, &done.written);
                State::Done(done.written)
            }
            Err(error) => {
                retry = retry_after(&error, start.elapsed());
                let text = error.to_string();
                let known = self.assets.get(&input.path);
                let kept: Vec<Written> = match keeps_outputs(&error) {
                    true => known.map(|known| known.outputs().to_vec()).unwrap_or_default(),
                    false => Vec::new(),
                };
                // A file that changed during the bake is a file that had not settled.
                let is_news = !matches!(error, RunError::Changed { .. });
                if is_news && !known.is_some_and(|known| known.has_failed_before(&text, &seen)) {
                    journal.failed(Some(&name), &text, kept.last().map(|document| document.path.as_path()))?;
                }
                if kept.is_empty() {
                    self.ledger.set(&input.path, &self.output, &[]);
                }
                State::Failed { error: text, again: depends_on_more(&error), kept }
            }
        };
        let known = KnownAsset { output: input.folder.clone(), values: resolved.values.clone(), id, seen, state };
        self.assets.insert(input.path.clone(), known);
        Ok(retry)
    }

    /// Drops the kept outputs of assets that cannot be baked where another asset takes one of their paths: they are
    /// incomplete from then on.
    fn drop_incomplete(&mut self, selected: &[(Input, Resolved)], guard: &mut Guard) {
        for (input, _) in selected {
            if let Some(KnownAsset { state: State::Failed { kept, .. }, .. }) = self.assets.get_mut(&input.path)
                && !kept.iter().all(|file| guard.reserve_existing(&file.path, &file.source))
            {
                kept.clear();
                self.ledger.set(&input.path, &self.output, &[]);
            }
        }
    }
}

/// Returns when to try again, even if nothing happens, after a try that took `took`.
fn retry_after(error: &RunError, took: Duration) -> Option<Duration> {
    match error {
        RunError::Changed { .. } => Some(Duration::ZERO),
        _ => error.is_transient().then_some(RETRY.max(took.saturating_mul(RETRY_SHARE))),
    }
}

/// Returns whether earlier outputs of the asset stay, since no other asset needs their paths.
fn keeps_outputs(error: &RunError) -> bool {
    !matches!(
        error,
        RunError::Publish(
            PublishError::SamePlace { .. } | PublishError::SameName { .. } | PublishError::OverSource { .. }
        )
    )
}

/// Returns whether the failure depends on more than the files of the asset.
fn depends_on_more(error: &RunError) -> bool {
    let is_of_output = matches!(error, RunError::Publish(_) | RunError::NoOutput { .. } | RunError::OtherSource { .. });
    error.is_transient() || is_of_output
}
