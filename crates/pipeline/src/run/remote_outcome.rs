//! How a job ended that a server may have run.

use crate::report::Origin;
use crate::run::error::RunError;

/// Why a job failed, in words that do not depend on the machine that ran the job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobFailure {
    /// The message for the user.
    pub message: String,
    /// Whether the error is transient, so that another try may succeed.
    pub is_transient: bool,
}

impl From<&RunError> for JobFailure {
    fn from(error: &RunError) -> Self {
        Self { message: error.to_string(), is_transient: error.is_transient() }
    }
}

/// The end of a job that was sent to a server: where the outputs came from, or why there are none.
pub type RemoteOutcome = Result<Origin, JobFailure>;

/// Waits for the job of an index and returns how that job ended. Returns `None` for a job that was not sent.
pub type Wait<'a> = &'a (dyn Fn(usize) -> Option<RemoteOutcome> + Sync);
