//! Baking what was planned at a look.

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::super::asset::{Asset, Planned, State};
use super::super::events::EventWriter;
use super::Round;
use crate::cache::CacheError;
use crate::output::lock::{Kind, OutputLock};
use crate::output::{Guard, PublishError};
use crate::project::{Input, Resolved};
use crate::run as plan;
use crate::run::{Lookup, MemoryBudget, RunError, Written};
use crate::watch::Removed;

/// After how long a lock or a vanished disk is tried again, at least.
const RETRY: Duration = Duration::from_secs(1);

/// How many times as long as a try the pause after it is, at least: a disk may stay full for long.
const RETRY_SHARE: u32 = 10;

impl Round {
    /// Bakes what is `planned`; returns after how long to try again, if that may help.
    pub(super) fn work(
        &mut self,
        selected: &[(Input, Resolved)],
        mut planned: Vec<Option<Planned>>,
        stop: &AtomicBool,
        events: &mut EventWriter<'_>,
    ) -> io::Result<Option<Duration>> {
        for ((input, resolved), slot) in selected.iter().zip(&mut planned) {
            if let Some(known) = self.assets.get_mut(&input.path)
                && let Some(planned) = slot.take_if(|planned| known.is_as(planned, input))
            {
                // Touched, or changed and changed back.
                (known.seen, known.values) = (planned.seen, resolved.values.clone());
            }
        }
        if planned.iter().all(Option::is_none) {
            return Ok(None);
        }
        let lock = OutputLock::take(&self.output, Kind::Alone, &mut |message| {
            message.map_or(Ok(()), |message| events.note(&message)).map(|()| !stop.load(Ordering::Acquire))
        })?;
        // Folders that come and go above the outputs would be a reason to look again.
        let _lock = lock.map(OutputLock::keep_folders);
        let look_up =
            |planned: &Option<Planned>| Some(Lookup::new(planned.as_ref()?.job.as_ref().ok()?, self.cache.as_ref()?));
        let lookups: Vec<Option<Lookup>> = planned.par_iter().map(look_up).collect();
        let (mut guard, budget) = (self.guard(&planned), MemoryBudget::new(1));
        let mut retry: Option<Duration> = None;
        let mut soon = |after: Option<Duration>| retry = [retry, after].into_iter().flatten().min();
        for (((input, resolved), planned), lookup) in selected.iter().zip(planned).zip(lookups) {
            let Some(Planned { job, seen }) = planned else {
                // An asset keeps its places unless one before it takes them, as in a bake of all.
                if let Some(Asset { state, .. }) = self.assets.get_mut(&input.path)
                    && let State::Done(written) = state
                    && !written.iter().all(|file| guard.hold(&file.path, &file.source))
                {
                    *state = State::Failed { error: String::new(), again: true, kept: std::mem::take(written) };
                    soon(Some(Duration::ZERO));
                }
                continue;
            };
            if stop.load(Ordering::Acquire) {
                return Ok(retry);
            }
            let (start, name) = (Instant::now(), input.path.display().to_string());
            let id = job.as_ref().ok().map(|job| job.id);
            let mut warn = |error: CacheError| {
                let whose = if error.is_general() { String::new() } else { format!("{name}: ") };
                // The bake does not depend on who reads this.
                let _ = events.warn(&format_args!("{whose}{error}"));
            };
            let result = job.and_then(|job| {
                let prepared = plan::prepare(&job, lookup, &budget, &|_| ());
                plan::finish(&job, prepared, &mut guard, &mut warn)
            });
            let state = match result {
                Ok(done) => {
                    events.baked(name, &done, start.elapsed().as_secs_f64())?;
                    let removed = |path: &PathBuf| Removed { path: path.clone(), asset: input.path.clone() };
                    events.removed(&done.removed.iter().map(removed).collect::<Vec<_>>())?;
                    self.ledger.set(&input.path, &self.output, &done.written);
                    State::Done(done.written)
                }
                Err(error) => {
                    soon(retry_after(&error, start.elapsed()));
                    let text = error.to_string();
                    let known = self.assets.get(&input.path);
                    let kept: Vec<Written> = match keeps_outputs(&error) {
                        true => known.map(|known| known.outputs().to_vec()).unwrap_or_default(),
                        false => Vec::new(),
                    };
                    // A file that was written to meanwhile is one that had not settled.
                    let is_news = !matches!(error, RunError::Changed { .. });
                    if is_news && !known.is_some_and(|known| known.has_failed_so(&text, &seen)) {
                        events.failed(Some(&name), &text, kept.last().map(|document| document.path.as_path()))?;
                    }
                    if kept.is_empty() {
                        self.ledger.set(&input.path, &self.output, &[]);
                    }
                    State::Failed { error: text, again: depends_on_more(&error), kept }
                }
            };
            let asset = Asset { output: input.folder.clone(), values: resolved.values.clone(), id, seen, state };
            self.assets.insert(input.path.clone(), asset);
        }
        self.drop_mixed(selected, &mut guard);
        Ok(retry)
    }

    /// Gives up outputs of assets that cannot be baked where another asset needs a place among them: they are not whole any
    /// more.
    fn drop_mixed(&mut self, selected: &[(Input, Resolved)], guard: &mut Guard) {
        for (input, _) in selected {
            if let Some(Asset { state: State::Failed { kept, .. }, .. }) = self.assets.get_mut(&input.path)
                && !kept.iter().all(|file| guard.hold(&file.path, &file.source))
            {
                kept.clear();
                self.ledger.set(&input.path, &self.output, &[]);
            }
        }
    }
}

/// Returns when to try again, even if nothing happens, after a try that took so long.
fn retry_after(error: &RunError, took: Duration) -> Option<Duration> {
    match error {
        RunError::Changed { .. } => Some(Duration::ZERO),
        _ => error.is_passing().then_some(RETRY.max(took.saturating_mul(RETRY_SHARE))),
    }
}

/// Returns whether earlier outputs of the asset stay: no other asset needs their places.
fn keeps_outputs(error: &RunError) -> bool {
    !matches!(
        error,
        RunError::Publish(
            PublishError::SamePlace { .. } | PublishError::SameName { .. } | PublishError::OverSource { .. }
        )
    )
}

/// Returns whether it is not the asset's files alone that are wrong.
fn depends_on_more(error: &RunError) -> bool {
    let is_of_output = matches!(error, RunError::Publish(_) | RunError::NoOutput { .. } | RunError::OtherSource { .. });
    error.is_passing() || is_of_output
}
