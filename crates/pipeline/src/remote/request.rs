//! Requests for jobs on a server.

use crate::cache::DiskCache;
pub use crate::report::{Counts, Origin};
use crate::run::{Job, RunError};
pub use crate::run::{JobFailure, RemoteOutcome as Outcome, Wait};

/// A request to run jobs on a server.
pub struct JobRequest<'a> {
    /// The jobs, each with its index.
    pub jobs: Vec<(usize, &'a Job)>,
    /// The disk cache that receives the outputs.
    pub disk_cache: &'a DiskCache,
    /// Checks whether a job may run.
    pub check: &'a (dyn Fn(&Job) -> Result<(), RunError> + Sync),
    /// Called when the counts change.
    pub changed: &'a (dyn Fn(Counts) + Sync),
}
