//! What is asked of a server, and what becomes of each job.

use serde::Serialize;

use super::tally::Counts;
use crate::cache::Cache;
use crate::plan::{Job, RunError};

/// Jobs for a server.
pub struct Errand<'a> {
    /// The jobs, each with its index.
    pub jobs: Vec<(usize, &'a Job)>,
    /// Where their outputs are put.
    pub cache: &'a Cache,
    /// Whether a job may be run.
    pub check: &'a (dyn Fn(&Job) -> Result<(), RunError> + Sync),
    /// Told when numbers change.
    pub changed: &'a (dyn Fn(Counts) + Sync),
}

/// Where the outputs of a job come from, once the cache has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Origin {
    /// A worker baked it.
    Executed,
    /// The server had them.
    Cached,
}

/// Why a job failed. Reads as it would here, if the job itself failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobFailure {
    /// What to tell.
    pub message: String,
    /// Whether trying again may help.
    pub is_passing: bool,
}

impl From<&RunError> for JobFailure {
    fn from(error: &RunError) -> Self {
        Self { message: error.to_string(), is_passing: error.is_passing() }
    }
}

/// What became of a job.
pub type Outcome = Result<Origin, JobFailure>;

/// What became of the job of an index; waits for it. `None` for jobs that were not sent.
pub type Wait<'a> = &'a (dyn Fn(usize) -> Option<Outcome> + Sync);
