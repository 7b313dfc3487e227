//! Jobs run side by side, each from the cache if it is there, and are written and told of in order.

use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Instant;

use super::Outcome;
use super::jobs::Planned;
use super::progress::Progress;
use super::report::Asset;
use crate::bake::{Places, Settings};
use crate::cache::{Cache, CacheError};
use crate::plan::{self, Job, Lookup, RunError};

/// Where bakes are kept.
#[derive(Debug, clap::Args)]
pub struct CacheOptions {
    /// Keep outputs in this folder, and take from it what was baked before. Several runs may share it.
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Largest size of that folder; what was not used for longest goes first. K, M, G and T are powers of 1024.
    #[arg(long, value_name = "SIZE", value_parser = size, default_value = "10G")]
    cache_size: u64,
}

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
        let cache = self.cache.cache.as_deref().map(Cache::new);
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
        if let Some(cache) = &cache
            && let Err(error) = cache.trim(self.cache.cache_size)
        {
            writeln!(err, "warning: {error}")?;
        }
        Ok((assets, outcome))
    }
}

/// A number of bytes, with K, M, G or T for powers of 1024.
fn size(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let power = match text[digits.len()..].to_ascii_uppercase().as_str() {
        "" => Some(0),
        "K" => Some(1),
        "M" => Some(2),
        "G" => Some(3),
        "T" => Some(4),
        _ => None,
    };
    let bytes = power.and_then(|power| digits.parse::<u64>().ok()?.checked_mul(1 << (10 * power)));
    bytes.ok_or_else(|| format!("expected a number of bytes such as 500M or 10G, found {text:?}"))
}
