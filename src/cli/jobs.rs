//! Which jobs a command line asks for: all of a selection, those of a plan, or some of either.

use std::env;
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::part::{Part, PartError};
use crate::bake::read_file;
use crate::output::Guard;
use crate::project::{Input, Resolved};
use crate::run::{Job, Misplaced, Plan, RunError, confine};

/// A job by its asset's name for a person, or why it cannot be planned.
pub struct Planned {
    /// The source, as it was named.
    pub name: String,
    /// The job.
    pub job: Result<Job, RunError>,
}

/// Plans every asset. Their files are hashed side by side; the order stays.
pub fn plan(assets: &[(Input, Resolved)]) -> Vec<Planned> {
    let planned = assets.par_iter().map(|(input, resolved)| Planned {
        name: input.path.display().to_string(),
        job: Job::new(&input.path, &input.folder, &resolved.values),
    });
    planned.collect()
}

/// What decides where a run of `planned` may write: nowhere but inside `output`, if that is known, never over what the jobs or
/// the run itself read (`others`).
pub fn guard<'p>(planned: &[Planned], output: Option<&Path>, others: impl IntoIterator<Item = &'p PathBuf>) -> Guard {
    let mut guard = output.map_or_else(Guard::default, Guard::inside);
    others.into_iter().for_each(|path| guard.add_source(path));
    planned.iter().filter_map(|planned| planned.job.as_ref().ok()).for_each(|job| job.protect(&mut guard));
    guard
}

/// What a plan has settled: all of a selection, by the ids of arguments and of groups of them.
const NOT_WITH_A_PLAN: [&str; 7] =
    ["inputs", "config", "no_config", "lobe", "TextureOptions", "DocumentOptions", "ViewOptions"];

/// Which jobs of all.
#[derive(Debug, clap::Args)]
pub struct JobOptions {
    /// Run this job only: an id of `roughcast plan`, or its first digits (8 at least).
    #[arg(long, value_name = "ID", value_parser = job_id)]
    job: Option<String>,
    /// Run the jobs of a file that `roughcast plan --json` wrote, in the same working folder. They may write below that folder,
    /// and below the one that -o names.
    #[arg(long, value_name = "FILE", conflicts_with_all = NOT_WITH_A_PLAN)]
    plan: Option<PathBuf>,
    /// Run the I-th of N parts that cost about the same, from 1. Without I (`/8`) it is the one that the index of an array
    /// job names: SLURM_ARRAY_TASK_ID, AWS_BATCH_JOB_ARRAY_INDEX or JOB_COMPLETION_INDEX, which count from 0.
    #[arg(long, value_name = "[I]/N")]
    shard: Option<Part>,
}

/// Why there are no jobs.
#[derive(Debug, thiserror::Error)]
pub enum JobsError {
    /// The plan cannot be read.
    #[error("{}: expected a readable file, found: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// The file is no plan.
    #[error("{}: expected a plan as `roughcast plan --json` writes it, found: {reason}", path.display())]
    NoPlan {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        reason: String,
    },
    /// The file is no report.
    #[error("{}: expected a report as `bake --report` writes it, found: {reason}", path.display())]
    NoReport {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        reason: String,
    },
    /// The plan is for another version, whose jobs these are not.
    #[error("{}: expected a plan of version {}, found one of {version}; plan again", path.display(), env!("CARGO_PKG_VERSION"))]
    OtherVersion {
        /// The file.
        path: PathBuf,
        /// Its version.
        version: String,
    },
    /// The plan leads to places where it may not write.
    #[error("{}: {error}", path.display())]
    Misplaced {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: Misplaced,
    },
    /// No job has the id.
    #[error("expected the id of a job, found {id}, which none has; `roughcast plan` prints them")]
    NoJob {
        /// What was asked for.
        id: String,
    },
    /// The part cannot be told.
    #[error(transparent)]
    Part(#[from] PartError),
}

impl JobOptions {
    /// Returns the jobs of the plan that is to be run, if one is named; `output` is what the user says of output folders.
    ///
    /// # Errors
    /// [`JobsError`]: a plan of which one job may not write where it says is not run at all.
    pub fn planned(&self, output: Option<&Path>) -> Option<Result<Vec<Planned>, JobsError>> {
        let named = |job: Job| Planned { name: job.source.display().to_string(), job: Ok(job) };
        self.plan.as_deref().map(|path| {
            let plan = read_plan(path)?;
            confine(&plan, output).map_err(|error| JobsError::Misplaced { path: path.to_owned(), error })?;
            Ok(plan.jobs.into_iter().map(named).collect())
        })
    }

    /// Returns whether other runs may bake other jobs of the same selection at the same time.
    pub fn are_parts(&self) -> bool {
        self.job.is_some() || self.shard.is_some()
    }

    /// The file of the plan, if one is named.
    pub fn plan_file(&self) -> Option<&PathBuf> {
        self.plan.as_ref()
    }

    /// Checks that a job of a plan is what its files make of it now.
    ///
    /// # Errors
    /// [`RunError::NotAsPlanned`], or why it cannot be planned any more.
    pub fn check(&self, job: &Job) -> Result<(), RunError> {
        if self.plan.is_some() { job.check() } else { Ok(()) }
    }

    /// Those of `planned` that are asked for. What cannot be planned has no id: it is told unless one job is asked for.
    ///
    /// # Errors
    /// [`JobsError::NoJob`], [`JobsError::Part`].
    pub fn choose(&self, mut planned: Vec<Planned>) -> Result<Vec<Planned>, JobsError> {
        if let Some(part) = self.shard {
            let shard = part.shard(&|name| env::var(name).ok())?;
            let jobs: Vec<&Job> = planned.iter().filter_map(|planned| planned.job.as_ref().ok()).collect();
            let mut picks = shard.picks(&jobs).into_iter();
            planned.retain(|planned| planned.job.is_err() || picks.next().unwrap_or(true));
        }
        if let Some(id) = &self.job {
            planned.retain(|planned| planned.job.as_ref().is_ok_and(|job| job.id.to_string().starts_with(id)));
            if planned.is_empty() {
                return Err(JobsError::NoJob { id: id.clone() });
            }
        }
        Ok(planned)
    }
}

/// Reads a plan of this version.
///
/// # Errors
/// [`JobsError`].
pub fn read_plan(path: &Path) -> Result<Plan, JobsError> {
    let bytes = read_file(path).map_err(|error| JobsError::Read { path: path.to_owned(), error })?;
    let plan: Plan = serde_json::from_slice(&bytes)
        .map_err(|error| JobsError::NoPlan { path: path.to_owned(), reason: error.to_string() })?;
    if plan.version != env!("CARGO_PKG_VERSION") {
        return Err(JobsError::OtherVersion { path: path.to_owned(), version: plan.version });
    }
    Ok(plan)
}

fn job_id(text: &str) -> Result<String, String> {
    let is_id = (8..=64).contains(&text.len()) && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
    if is_id { Ok(text.to_owned()) } else { Err(format!("expected 8 to 64 hexadecimal digits, found {text:?}")) }
}
