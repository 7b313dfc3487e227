//! What takes the place of a server in a build without the feature `remote`.

use super::options::Options;
use super::outcome::{Counts, Errand, Wait};

/// A server, of which there is none.
pub enum Remote {}

/// Why there is none.
#[derive(Clone, Debug, thiserror::Error)]
#[error(
    "--remote: expected a build with the feature `remote`, found one without; `cargo install --path . --features remote`"
)]
pub struct RemoteError;

impl RemoteError {
    /// Whether trying again may help.
    pub fn is_passing(&self) -> bool {
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

    /// What was done so far.
    pub fn counts(&self) -> Counts {
        match *self {}
    }

    /// Runs the jobs of `errand`.
    pub fn ahead<R>(&self, _: &Errand<'_>, _: impl FnOnce(Wait<'_>) -> R) -> R {
        match *self {}
    }
}
