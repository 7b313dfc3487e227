//! Jobs run side by side, each from the cache if it is there, and are written and told of in order.

use std::io::{self, Write};
use std::time::Instant;

use rayon::prelude::*;

use super::jobs::Planned;
use super::outcome::Outcome;
use super::progress::Progress;
use super::report::Asset;
use crate::cache::{Cache, CacheError};
use crate::output::Guard;
use crate::remote::{Counts, Errand, JobFailure, Options, Remote, Wait};
use crate::run as plan;
use crate::run::{Job, Lookup, MemoryBudget, RunError};
use crate::settings::Settings;

/// What became of jobs.
pub struct Worked {
    /// Each, in order.
    pub assets: Vec<Asset>,
    /// How it all ended.
    pub outcome: Outcome,
    /// What a server did, if there is one.
    pub remote: Option<Counts>,
}

/// How jobs are run.
pub struct Work<'a> {
    /// The cache.
    pub cache: Option<&'a Cache>,
    /// Settings of the run: an asset tells its own where they are others.
    pub settings: &'a Settings,
    /// The server that bakes, if it is not this machine.
    pub remote: Option<Options>,
    /// Whether a job may be run.
    pub check: &'a (dyn Fn(&Job) -> Result<(), RunError> + Sync),
    /// No progress bar.
    pub is_quiet: bool,
}

/// Where outputs and complaints of a run go.
struct Outlet<'a> {
    guard: &'a mut Guard,
    progress: &'a Progress,
    err: &'a mut dyn Write,
}

impl Work<'_> {
    /// Runs `planned` and tells of each, with what complaints go to. `guard` decides what may be written.
    ///
    /// # Errors
    /// When `err` cannot be written to, or `tell` cannot tell.
    pub fn run(
        &self,
        planned: Vec<Planned>,
        guard: &mut Guard,
        err: &mut dyn Write,
        tell: &mut dyn FnMut(&Asset, &mut dyn Write) -> io::Result<()>,
    ) -> io::Result<Worked> {
        // What a server bakes goes through a folder, be it for this run only.
        let is_local = self.remote.is_none() || self.cache.is_some_and(|cache| cache.folder().is_some());
        let scratch = if is_local { None } else { Some(tempfile::tempdir()?) };
        let cache = match &scratch {
            None => self.cache.cloned(),
            Some(scratch) => Some(self.cache.cloned().unwrap_or_default().with_folder(scratch.path())),
        };
        let errand = match self.remote.as_ref().zip(cache.as_ref()) {
            None => None,
            Some((options, cache)) => {
                let (jobs, warnings) = unknown(&planned, cache);
                warnings.iter().try_for_each(|error| writeln!(err, "warning: {error}"))?;
                Some((options, jobs))
            }
        };
        let remote = match errand.filter(|(_, jobs)| !jobs.is_empty()) {
            None => None,
            Some((options, jobs)) => match Remote::connect(options.clone()) {
                Ok(remote) => Some((remote, jobs)),
                Err(error) => {
                    writeln!(err, "error: {error}")?;
                    let outcome = if error.is_passing() { Outcome::Retry } else { Outcome::Usage };
                    return Ok(Worked { assets: Vec::new(), outcome, remote: None });
                }
            },
        };
        let progress = Progress::new(planned.len(), self.is_quiet);
        let (mut assets, mut outcome) = (Vec::with_capacity(planned.len()), Outcome::Done);
        let mut publish = |wait: Wait<'_>| {
            let outlet = Outlet { guard: &mut *guard, progress: &progress, err: &mut *err };
            self.publish(&planned, cache.as_ref(), outlet, wait, &mut |asset, ended, err| {
                outcome = outcome.and(ended);
                progress.suspend(|| tell(&asset, err))?;
                assets.push(asset);
                Ok(())
            })
        };
        match (&remote, cache.as_ref().and_then(Cache::folder)) {
            (Some((remote, jobs)), Some(folder)) => {
                let changed = |counts: Counts| progress.count(counts);
                let errand = Errand { jobs: jobs.clone(), folder, check: self.check, changed: &changed };
                remote.ahead(&errand, publish)?;
            }
            _ => publish(&|_| None)?,
        }
        progress.finish();
        if let Some(cache) = cache.filter(|_| is_local) {
            cache.trim(&mut |error| drop(writeln!(err, "warning: {error}")));
        }
        let counts = remote.map_or_else(Counts::default, |(remote, _)| remote.counts());
        Ok(Worked { assets, outcome, remote: self.remote.as_ref().map(|_| counts) })
    }

    /// Prepares jobs side by side and publishes them in order. `wait` tells of those that somebody else runs.
    fn publish(
        &self,
        planned: &[Planned],
        cache: Option<&Cache>,
        outlet: Outlet<'_>,
        wait: Wait<'_>,
        take: &mut dyn FnMut(Asset, Outcome, &mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let Outlet { guard, progress, err } = outlet;
        let threads = rayon::current_num_threads();
        let budget = MemoryBudget::new(threads);
        let told = |error: &RunError| JobFailure::from(error);
        let prepare = |index: usize| {
            let start = Instant::now();
            let Planned { name, job } = &planned[index];
            progress.set(index, 0.0, name);
            let prepared = job.as_ref().map_err(told).and_then(|job| {
                let origin = wait(index).transpose()?;
                if origin.is_none() {
                    (self.check)(job).map_err(|error| told(&error))?;
                }
                let mut lookup = cache.map(|cache| Lookup::new(job, cache));
                if let Some(lookup) = lookup.as_mut().filter(|_| origin.is_some()) {
                    lookup.share();
                }
                Ok((job, origin, plan::prepare(job, lookup, &budget, &|share| progress.set(index, share, name))))
            });
            (prepared, start.elapsed().as_secs_f64())
        };
        plan::in_order(planned.len(), threads, prepare, |index, (prepared, seconds)| {
            let start = Instant::now();
            let name = &planned[index].name;
            let mut warn = |error: CacheError| {
                let whose = if error.is_general() { String::new() } else { format!("{name}: ") };
                // The bake does not depend on who reads this.
                let _ = progress.suspend(|| writeln!(err, "warning: {whose}{error}"));
            };
            let result = prepared.and_then(|(job, origin, prepared)| {
                let done = plan::finish(job, prepared, guard, &mut warn);
                let done = done.and_then(|done| Ok((job.typed_settings()?, done))).map_err(|error| told(&error))?;
                Ok((job, origin, done))
            });
            let seconds = seconds + start.elapsed().as_secs_f64();
            let mut ended = Outcome::Done;
            let asset = match result {
                Ok((job, origin, (own, done))) => {
                    let own = (own != *self.settings).then_some(own);
                    Asset::done(name.clone(), Some(job.id), &done, origin, seconds, own)
                }
                Err(JobFailure { message, is_passing }) => {
                    ended = if is_passing { Outcome::Retry } else { Outcome::Failed };
                    progress.suspend(|| writeln!(err, "error: {name}: {message}"))?;
                    let job = planned[index].job.as_ref().ok().map(|job| job.id);
                    Asset::failed(name.clone(), job, seconds, message, is_passing)
                }
            };
            progress.set(index, 1.0, name);
            take(asset, ended, err)
        })
    }
}

/// The jobs that `cache` does not know, with their indexes, and what is wrong with it.
fn unknown<'p>(planned: &'p [Planned], cache: &Cache) -> (Vec<(usize, &'p Job)>, Vec<CacheError>) {
    let jobs = planned.par_iter().enumerate().filter_map(|(index, planned)| Some((index, planned.job.as_ref().ok()?)));
    let looked_up = jobs.map(|(index, job)| {
        let mut warnings = Vec::new();
        let is_known = cache.entry(job.id, &|entry| job.fits(entry), &mut |error| warnings.push(error)).is_some();
        ((!is_known).then_some((index, job)), warnings)
    });
    let (jobs, warnings): (Vec<_>, Vec<_>) = looked_up.unzip();
    (jobs.into_iter().flatten().collect(), warnings.into_iter().flatten().collect())
}
