//! Options that choose which jobs are run.

use std::env;
use std::path::{Path, PathBuf};

use crate::run::{
    Job, Misplaced, Part, PartError, Plan, PlanError, PlannedAsset, RunError, UnknownJob, confine, keep_job, keep_shard,
};

/// What a plan has settled: ids of arguments and of groups of arguments that conflict with `--plan`.
const NOT_WITH_A_PLAN: [&str; 7] =
    ["inputs", "config", "no_config", "lobe", "TextureOptions", "DocumentOptions", "ViewOptions"];

/// Which jobs are run.
#[derive(Debug, clap::Args)]
pub struct JobOptions {
    /// Run one job only: an id of `roughcast plan`, or its first digits (8 at least).
    #[arg(long, value_name = "ID", value_parser = job_id)]
    job: Option<String>,
    /// Run the jobs of a file that `roughcast plan --json` wrote, in the same working folder. They may write below that
    /// folder, and below the folder that -o names.
    #[arg(long, value_name = "FILE", conflicts_with_all = NOT_WITH_A_PLAN)]
    plan: Option<PathBuf>,
    /// Run the I-th of N parts that cost about the same, from 1. Without I (`/8`) the index of an array job decides:
    /// SLURM_ARRAY_TASK_ID, AWS_BATCH_JOB_ARRAY_INDEX or JOB_COMPLETION_INDEX, which count from 0.
    #[arg(long, value_name = "[I]/N")]
    shard: Option<Part>,
}

/// Why no job is run.
#[derive(Debug, thiserror::Error)]
pub enum JobsError {
    /// The plan cannot be read.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The plan names folders that it may not write to.
    #[error("{}: {error}", path.display())]
    Misplaced {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: Misplaced,
    },
    /// No job has the id.
    #[error(transparent)]
    UnknownJob(#[from] UnknownJob),
    /// The environment has no index of a part.
    #[error(transparent)]
    Part(#[from] PartError),
}

impl JobOptions {
    /// Returns the jobs of the plan that `--plan` names; `output` is the folder of `-o`.
    ///
    /// # Errors
    /// [`JobsError`]: if one job may not write to its output folder, no job of the plan is run.
    pub fn planned(&self, output: Option<&Path>) -> Result<Option<Vec<PlannedAsset>>, JobsError> {
        let Some(path) = &self.plan else { return Ok(None) };
        let plan = Plan::read(path)?;
        confine(&plan, output).map_err(|error| JobsError::Misplaced { path: path.to_owned(), error })?;
        Ok(Some(plan.into_assets()))
    }

    /// Returns whether other runs may bake other jobs of this selection at the same time.
    pub fn are_parts(&self) -> bool {
        self.job.is_some() || self.shard.is_some()
    }

    /// Returns the file of the plan.
    pub fn plan_file(&self) -> Option<&PathBuf> {
        self.plan.as_ref()
    }

    /// Checks that a job of a plan is still the job that its files make.
    ///
    /// # Errors
    /// [`RunError::NotAsPlanned`], or why the job cannot be planned any more.
    pub fn check(&self, job: &Job) -> Result<(), RunError> {
        if self.plan.is_some() { job.check() } else { Ok(()) }
    }

    /// Keeps the jobs that are to be run.
    ///
    /// # Errors
    /// [`JobsError::UnknownJob`], [`JobsError::Part`].
    pub fn choose(&self, planned: &mut Vec<PlannedAsset>) -> Result<(), JobsError> {
        if let Some(part) = self.shard {
            keep_shard(planned, part.shard(&|name| env::var(name).ok())?);
        }
        if let Some(id) = &self.job {
            keep_job(planned, id)?;
        }
        Ok(())
    }
}

fn job_id(text: &str) -> Result<String, String> {
    let is_id = (8..=64).contains(&text.len()) && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
    if is_id { Ok(text.to_owned()) } else { Err(format!("expected 8 to 64 hexadecimal digits, found {text:?}")) }
}
