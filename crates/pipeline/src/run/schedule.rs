//! The scheduler: runs jobs in parallel, each from the cache if possible, and publishes and reports them in order.

use std::io;
use std::time::Instant;

use rayon::prelude::*;

use crate::cache::{Cache, CacheError};
use crate::output::Guard;
use crate::report::{AssetOutcome, Counts, Origin, Status};
use crate::run::budget::MemoryBudget;
use crate::run::error::RunError;
use crate::run::in_order::in_order;
use crate::run::job::Job;
use crate::run::plan_assets::PlannedAsset;
use crate::run::remote_outcome::{JobFailure, Wait};
use crate::run::restore::Lookup;
use crate::run::run_job::{Done, Prepared, finish, prepare};
use crate::settings::{RecordedSettings, Settings};

/// Receives the progress of a run, from any thread.
pub trait Progress: Sync {
    /// Reports that the work on the asset `index` (from 0), which is called `name`, has reached `share` (0 to 1).
    fn advance(&self, index: usize, share: f32, name: &str);

    /// Reports what a server has done so far.
    fn count(&self, counts: Counts);
}

/// Receives what a run reports, in the order of the assets.
pub trait RunEvents {
    /// Reports a problem that stops nothing.
    fn warn(&mut self, warning: &str);

    /// Reports what became of an asset.
    ///
    /// # Errors
    /// Any error ends the run.
    fn asset(&mut self, asset: AssetOutcome) -> io::Result<()>;
}

/// How the jobs of a run are executed.
pub struct Scheduler<'a> {
    /// The cache.
    pub cache: Option<&'a Cache>,
    /// The settings of the run. The outcome of an asset records its own settings if they differ from these.
    pub settings: &'a Settings,
    /// Checks that a job may be run.
    pub check: &'a (dyn Fn(&Job) -> Result<(), RunError> + Sync),
    /// Receives the progress.
    pub progress: &'a dyn Progress,
}

/// A job whose outputs are in memory.
struct PreparedJob<'p> {
    job: &'p Job,
    origin: Option<Origin>,
    prepared: Prepared,
}

/// The result of the parallel part of a job, and the seconds that the part took.
type PreparedAsset<'p> = (Result<PreparedJob<'p>, JobFailure>, f64);

impl Scheduler<'_> {
    /// Prepares the jobs of `planned` in parallel and publishes them in order, where `guard` allows it. `wait` waits
    /// for jobs that a server runs.
    ///
    /// # Errors
    /// The first error of `events`.
    pub fn run(
        &self,
        planned: &[PlannedAsset],
        guard: &mut Guard,
        wait: Wait<'_>,
        events: &mut dyn RunEvents,
    ) -> io::Result<()> {
        let threads = rayon::current_num_threads();
        let budget = MemoryBudget::new(threads);
        let prepare = |index: usize| self.prepare(index, &planned[index], &budget, wait);
        in_order(planned.len(), threads, prepare, |index, prepared| {
            let asset = &planned[index];
            let outcome = self.publish(asset, prepared, guard, &mut |warning| events.warn(warning));
            self.progress.advance(index, 1.0, &asset.name);
            events.asset(outcome)
        })
    }

    /// Runs the part of a job that depends on no other job.
    fn prepare<'p>(
        &self,
        index: usize,
        asset: &'p PlannedAsset,
        budget: &MemoryBudget,
        wait: Wait<'_>,
    ) -> PreparedAsset<'p> {
        let start = Instant::now();
        let PlannedAsset { name, job } = asset;
        self.progress.advance(index, 0.0, name);
        let prepared = job.as_ref().map_err(JobFailure::from).and_then(|job| {
            let origin = wait(index).transpose()?;
            if origin.is_none() {
                (self.check)(job).map_err(|error| JobFailure::from(&error))?;
            }
            let mut lookup = self.cache.map(|cache| Lookup::new(job, cache));
            if let Some(lookup) = lookup.as_mut().filter(|_| origin.is_some()) {
                lookup.share();
            }
            let prepared = prepare(job, lookup, budget, &|share| self.progress.advance(index, share, name));
            Ok(PreparedJob { job, origin, prepared })
        });
        (prepared, start.elapsed().as_secs_f64())
    }

    /// Writes the outputs of a job and returns what became of the asset.
    fn publish(
        &self,
        asset: &PlannedAsset,
        (prepared, seconds): PreparedAsset<'_>,
        guard: &mut Guard,
        warn: &mut dyn FnMut(&str),
    ) -> AssetOutcome {
        let start = Instant::now();
        let name = &asset.name;
        let mut warn = |error: CacheError| {
            let subject = if error.is_general() { String::new() } else { format!("{name}: ") };
            warn(&format!("{subject}{error}"));
        };
        let result = prepared.and_then(|PreparedJob { job, origin, prepared }| {
            let done = finish(job, prepared, guard, &mut warn);
            let done = done.and_then(|done| Ok((job.settings.settings()?, done)));
            let (settings, done) = done.map_err(|error| JobFailure::from(&error))?;
            Ok((job, origin, settings, done))
        });
        let seconds = seconds + start.elapsed().as_secs_f64();
        match result {
            Ok((job, origin, settings, done)) => AssetOutcome {
                job: Some(job.id),
                settings: (settings != *self.settings).then(|| RecordedSettings::new(&settings, settings.model)),
                ..done.outcome(name.clone(), origin, seconds)
            },
            Err(JobFailure { message, is_transient }) => {
                let job = asset.job.as_ref().ok().map(|job| job.id);
                AssetOutcome::failed(name.clone(), job, seconds, message, is_transient)
            }
        }
    }
}

impl Done {
    /// Returns the outcome of the asset `input`, whose job took `seconds` and whose outputs came from `origin`.
    pub fn outcome(&self, input: String, origin: Option<Origin>, seconds: f64) -> AssetOutcome {
        AssetOutcome {
            job: None,
            input,
            output: Some(self.output.display().to_string()),
            status: self.status(origin),
            remote: origin,
            settings: None,
            seconds,
            input_bytes: self.inputs,
            bytes: self.bytes,
            error: None,
            retry: false,
            report: self.report.clone(),
        }
    }

    /// Returns how the job ended, whose outputs came from `origin`.
    pub fn status(&self, origin: Option<Origin>) -> Status {
        match &self.report.textures {
            // Outputs that a worker baked are new, although they come through a cache.
            _ if self.is_cached && origin != Some(Origin::Executed) => Status::Cached,
            textures if textures.is_empty() => Status::Copied,
            _ => Status::Baked,
        }
    }
}

/// Returns the jobs that `cache` does not have, with their indices, and what is wrong with the cache.
pub fn uncached<'p>(planned: &'p [PlannedAsset], cache: &Cache) -> (Vec<(usize, &'p Job)>, Vec<CacheError>) {
    let jobs = planned.par_iter().enumerate().filter_map(|(index, planned)| Some((index, planned.job.as_ref().ok()?)));
    let looked_up = jobs.map(|(index, job)| {
        let mut warnings = Vec::new();
        let is_cached = cache.entry(job.id, &|entry| job.fits(entry), &mut |error| warnings.push(error)).is_some();
        ((!is_cached).then_some((index, job)), warnings)
    });
    let (jobs, warnings): (Vec<_>, Vec<_>) = looked_up.unzip();
    (jobs.into_iter().flatten().collect(), warnings.into_iter().flatten().collect())
}
