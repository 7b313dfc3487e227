//! Runs planned assets, on the workers of a server if there is one.

use std::io;

use super::farm::{Remote, RemoteError};
use super::options::Options;
use super::request::JobRequest;
use crate::cache::Cache;
use crate::output::Guard;
use crate::report::Counts;
use crate::run::{Job, PlannedAsset, RunEvents, Scheduler, uncached};

/// Why no job was run.
#[derive(Debug, thiserror::Error)]
pub enum ScheduleError {
    /// Results cannot be reported, or there is no folder for temporary files.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The server cannot be used.
    #[error(transparent)]
    Remote(#[from] RemoteError),
}

/// Runs the jobs of `planned` where `guard` allows it: on workers of the server that `options` name, else on this
/// machine. Afterwards the cache has its size limit again. Returns what the server did.
///
/// # Errors
/// [`ScheduleError`]; failures of jobs are outcomes of their assets.
pub fn schedule(
    planned: &[PlannedAsset],
    scheduler: &Scheduler<'_>,
    options: Option<&Options>,
    guard: &mut Guard,
    events: &mut dyn RunEvents,
) -> Result<Option<Counts>, ScheduleError> {
    let Some(options) = options else {
        scheduler.run(planned, guard, &|_| None, events)?;
        trim(scheduler.cache, events);
        return Ok(None);
    };
    // Outputs of a server come through a cache folder, which lasts for this run only if the user names none.
    let is_kept = scheduler.cache.is_some_and(|cache| cache.disk().is_some());
    let scratch = if is_kept { None } else { Some(tempfile::tempdir()?) };
    let mut cache = scheduler.cache.cloned().unwrap_or_default();
    if let Some(scratch) = &scratch {
        cache = cache.with_disk(scratch.path());
    }
    let scheduler = Scheduler { cache: Some(&cache), ..*scheduler };
    let (jobs, warnings) = uncached(planned, &cache);
    warnings.iter().for_each(|error| events.warn(&error.to_string()));
    let counts = if jobs.is_empty() {
        scheduler.run(planned, guard, &|_| None, events)?;
        Counts::default()
    } else {
        run_on_server(planned, jobs, &scheduler, options, guard, events)?
    };
    trim(Some(&cache).filter(|_| is_kept), events);
    Ok(Some(counts))
}

/// Sends `jobs` to the server and publishes all assets of `planned`.
fn run_on_server(
    planned: &[PlannedAsset],
    jobs: Vec<(usize, &Job)>,
    scheduler: &Scheduler<'_>,
    options: &Options,
    guard: &mut Guard,
    events: &mut dyn RunEvents,
) -> Result<Counts, ScheduleError> {
    let Some(disk_cache) = scheduler.cache.and_then(Cache::disk) else { return Ok(Counts::default()) };
    let remote = Remote::connect(options.clone())?;
    let changed = |counts: Counts| scheduler.progress.count(counts);
    let request = JobRequest { jobs, disk_cache, check: scheduler.check, changed: &changed };
    remote.run_jobs(&request, |wait| scheduler.run(planned, guard, wait, events))?;
    Ok(remote.counts())
}

/// Removes what was not used for longest from `cache` until it has its size limit.
fn trim(cache: Option<&Cache>, events: &mut dyn RunEvents) {
    if let Some(cache) = cache {
        cache.trim(&mut |error| events.warn(&error.to_string()));
    }
}
