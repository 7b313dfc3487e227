//! Jobs run side by side, each from the cache if it is there, and are written and told of in order.

use std::io::{self, Write};
use std::time::Instant;

use super::Outcome;
use super::cached::CacheOptions;
use super::jobs::Planned;
use super::progress::Progress;
use super::report::Asset;
use crate::bake::{Places, Settings};
use crate::cache::CacheError;
use crate::plan::{self, Job, Lookup, RunError};

/// How jobs are run.
pub struct Work<'a> {
    /// The cache.
    pub cache: &'a CacheOptions,
    /// Settings of the run: an asset tells its own where they are others.
    pub settings: &'a Settings,
    /// Whether a job may be run.
    pub check: &'a (dyn Fn(&Job) -> Result<(), RunError> + Sync),
    /// No progress bar.
    pub is_quiet: bool,
}

impl Work<'_> {
    /// Runs `planned` and tells of each, with what complaints go to. Returns what became of each, and how it all ended.
    ///
    /// # Errors
    /// When `err` cannot be written to, or `tell` cannot tell.
    pub fn run(
        &self,
        planned: Vec<Planned>,
        err: &mut dyn Write,
        tell: &mut dyn FnMut(&Asset, &mut dyn Write) -> io::Result<()>,
    ) -> io::Result<(Vec<Asset>, Outcome)> {
        let cache = self.cache.cache();
        let progress = Progress::new(planned.len(), self.is_quiet);
        let mut places = Places::default();
        // What to tell of an error, and whether trying again may help.
        let told = |error: &RunError| (error.to_string(), error.is_passing());
        let prepare = |index: usize| {
            let start = Instant::now();
            let Planned { name, job } = &planned[index];
            progress.set(index, 0.0, name);
            let prepared = job.as_ref().map_err(told).and_then(|job| {
                (self.check)(job).map_err(|error| told(&error))?;
                let lookup = cache.as_ref().map(|cache| Lookup::new(job, cache));
                let prepared = plan::prepare(job, lookup, &|share| progress.set(index, share, name));
                Ok((job, prepared.map_err(|error| told(&error))?))
            });
            (prepared, start.elapsed().as_secs_f64())
        };
        let (mut assets, mut outcome) = (Vec::with_capacity(planned.len()), Outcome::Done);
        plan::in_order(planned.len(), rayon::current_num_threads(), prepare, |index, (prepared, seconds)| {
            let start = Instant::now();
            let name = &planned[index].name;
            let mut warn = |error: &CacheError| {
                // The bake does not depend on who reads this.
                let _ = progress.suspend(|| writeln!(err, "warning: {name}: {error}"));
            };
            let result = prepared.and_then(|(job, prepared)| {
                let done = plan::finish(job, prepared, &mut places, cache.as_ref(), &mut warn);
                done.and_then(|done| Ok((job.typed_settings()?, done))).map_err(|error| told(&error))
            });
            let seconds = seconds + start.elapsed().as_secs_f64();
            let asset = match result {
                Ok((own, done)) => Asset::done(name.clone(), &done, seconds, (own != *self.settings).then_some(own)),
                Err((message, is_passing)) => {
                    outcome = outcome.and(if is_passing { Outcome::Retry } else { Outcome::Failed });
                    progress.suspend(|| writeln!(err, "error: {name}: {message}"))?;
                    Asset::failed(name.clone(), seconds, message)
                }
            };
            progress.set(index, 1.0, name);
            progress.suspend(|| tell(&asset, err))?;
            assets.push(asset);
            Ok::<(), io::Error>(())
        })?;
        progress.finish();
        if let Some(cache) = &cache {
            self.cache.trim(cache, err)?;
        }
        Ok((assets, outcome))
    }
}
