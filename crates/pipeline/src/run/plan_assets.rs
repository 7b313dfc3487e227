//! Assets that are planned for a run, and the choice of those that are run.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::output::Guard;
use crate::project::{Input, Resolved};
use crate::run::error::RunError;
use crate::run::job::Job;
use crate::run::plan_file::Plan;
use crate::run::shard::Shard;

/// An asset of a run.
pub struct PlannedAsset {
    /// The source, as the user named it.
    pub name: String,
    /// The job, or why the asset cannot be planned.
    pub job: Result<Job, RunError>,
}

/// No job has the id that was asked for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected the id of a job, found {id}, which none has; `roughcast plan` prints them")]
pub struct UnknownJob {
    /// The id, or its first digits.
    pub id: String,
}

/// Plans every asset. Files are hashed in parallel; the order of the assets stays.
pub fn plan_assets(assets: &[(Input, Resolved)]) -> Vec<PlannedAsset> {
    let planned = assets.par_iter().map(|(input, resolved)| PlannedAsset {
        name: input.path.display().to_string(),
        job: Job::new(&input.path, &input.folder, Some(&input.stem), &resolved.values),
    });
    planned.collect()
}

impl Plan {
    /// Returns the jobs of the plan as assets of a run.
    pub fn into_assets(self) -> Vec<PlannedAsset> {
        let asset = |job: Job| PlannedAsset { name: job.source.display().to_string(), job: Ok(job) };
        self.jobs.into_iter().map(asset).collect()
    }
}

/// Returns the guard of a run of `planned`. The run may write inside `output` only, if an output folder is known, and
/// never over what the jobs or the run itself (`others`) read.
pub fn guard<'p>(
    planned: &[PlannedAsset],
    output: Option<&Path>,
    others: impl IntoIterator<Item = &'p PathBuf>,
) -> Guard {
    let mut guard = output.map_or_else(Guard::default, Guard::inside);
    others.into_iter().for_each(|path| guard.add_source(path));
    planned.iter().filter_map(|planned| planned.job.as_ref().ok()).for_each(|job| job.protect(&mut guard));
    guard
}

/// Keeps the jobs of `shard`. Assets that cannot be planned stay, so that every part reports them.
pub fn keep_shard(planned: &mut Vec<PlannedAsset>, shard: Shard) {
    let jobs: Vec<&Job> = planned.iter().filter_map(|planned| planned.job.as_ref().ok()).collect();
    let mut picks = shard.picks(&jobs).into_iter();
    planned.retain(|planned| planned.job.is_err() || picks.next().unwrap_or(true));
}

/// Keeps the jobs whose ids begin with `id`.
///
/// # Errors
/// [`UnknownJob`] where there is none.
pub fn keep_job(planned: &mut Vec<PlannedAsset>, id: &str) -> Result<(), UnknownJob> {
    planned.retain(|planned| planned.job.as_ref().is_ok_and(|job| job.id.to_string().starts_with(id)));
    if planned.is_empty() { Err(UnknownJob { id: id.to_owned() }) } else { Ok(()) }
}
