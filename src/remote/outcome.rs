//! What is asked of a server, and what becomes of each job.

use serde::Serialize;

use crate::cache::Folder;
use crate::run::{Job, RunError};

/// Jobs for a server.
pub struct Errand<'a> {
    /// The jobs, each with its index.
    pub jobs: Vec<(usize, &'a Job)>,
    /// Where their outputs are put.
    pub folder: &'a Folder,
    /// Whether a job may be run.
    pub check: &'a (dyn Fn(&Job) -> Result<(), RunError> + Sync),
    /// PartReport when numbers change.
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

/// What a server did so far, in numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Counts {
    /// Jobs that wait for a worker.
    #[serde(skip)]
    pub queued: u64,
    /// Jobs on workers.
    #[serde(skip)]
    pub running: u64,
    /// Jobs that are done, well or not.
    #[serde(skip)]
    pub done: u64,
    /// Those of them that the server had.
    #[serde(skip)]
    pub known: u64,
    /// Actions that the jobs were grouped into.
    pub actions: u64,
    /// Executions, repetitions among them.
    pub executed: u64,
    /// Actions whose result the server had.
    pub cached: u64,
    /// Times that something was tried again.
    pub retries: u64,
    /// Blobs sent.
    pub uploaded_blobs: u64,
    /// Their bytes, before compression.
    pub uploaded_bytes: u64,
    /// Blobs fetched.
    pub downloaded_blobs: u64,
    /// Their bytes, after decompression.
    pub downloaded_bytes: u64,
}
