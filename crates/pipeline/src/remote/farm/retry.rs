//! Attempts with growing pauses between them.

use std::future::Future;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use backon::{BackoffBuilder, ExponentialBackoff, ExponentialBuilder};

use super::error::RemoteError;
use crate::remote::request::Counts;

/// Waits between attempts: each is twice the one before, up to 7.5 seconds. Jitter adds up to the wait itself, so that
/// callers that were refused together do not come back together.
const WAITS: ExponentialBuilder = ExponentialBuilder::new()
    .with_min_delay(Duration::from_millis(125))
    .with_max_delay(Duration::from_millis(7500))
    .with_jitter();

/// The attempts of one operation.
pub struct Attempts<'c> {
    waits: ExponentialBackoff,
    counts: &'c Mutex<Counts>,
}

impl<'c> Attempts<'c> {
    /// Returns attempts with at most `retries` after the first, which are counted in `counts`.
    pub fn new(retries: u32, counts: &'c Mutex<Counts>) -> Self {
        Self { waits: WAITS.with_max_times(retries as usize).build(), counts }
    }

    /// Waits until the next attempt after `error`.
    ///
    /// # Errors
    /// `error` itself, if it is not transient or no attempt is left.
    pub async fn after(&mut self, error: RemoteError) -> Result<(), RemoteError> {
        if !error.is_transient() {
            return Err(error);
        }
        let Some(wait) = self.waits.next() else { return Err(error) };
        self.counts.lock().unwrap_or_else(PoisonError::into_inner).retries += 1;
        tokio::time::sleep(wait).await;
        Ok(())
    }

    /// Calls until it succeeds or no attempt is left.
    ///
    /// # Errors
    /// The last error.
    pub async fn at<T, F>(mut self, mut call: impl FnMut() -> F) -> Result<T, RemoteError>
    where
        F: Future<Output = Result<T, RemoteError>>,
    {
        loop {
            match call().await {
                Ok(value) => return Ok(value),
                // The caller must first send the missing blobs again.
                Err(error) if error.is_missing() => return Err(error),
                Err(error) => self.after(error).await?,
            }
        }
    }
}

/// Returns 128 random bits in hexadecimal digits. Neither secrets nor outputs depend on them.
pub fn random_id() -> String {
    format!("{:032x}", fastrand::u128(..))
}
