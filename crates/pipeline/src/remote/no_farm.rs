//! The client of build farms in builds without the feature `remote`.

use super::options::Options;
use super::request::{Counts, JobRequest, Wait};

/// A server, which cannot exist in this build.
pub enum Remote {}

/// The error of every connection in this build.
#[derive(Clone, Debug, thiserror::Error)]
#[error(
    "--remote: expected a build with the feature `remote`, found one without; `cargo install --path . --features remote`"
)]
pub struct RemoteError;

impl RemoteError {
    /// Returns whether the error is transient, so that another attempt may succeed.
    pub fn is_transient(&self) -> bool {
        false
    }
}

impl Remote {
    /// Fails.
    ///
    /// # Errors
    /// [`RemoteError`].
    pub fn connect(_: Options) -> Result<Self, RemoteError> {
        Err(RemoteError)
    }

    /// Returns the numbers of what was done so far.
    pub fn counts(&self) -> Counts {
        match *self {}
    }

    /// Runs the jobs of `request`.
    pub fn run_jobs<R>(&self, _: &JobRequest<'_>, _: impl FnOnce(Wait<'_>) -> R) -> R {
        match *self {}
    }
}
