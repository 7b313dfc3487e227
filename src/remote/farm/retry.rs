//! Trying again, ever more slowly.

use std::future::Future;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use super::error::RemoteError;
use crate::remote::outcome::Counts;

/// How long to wait before the second attempt.
const FIRST: Duration = Duration::from_millis(250);

/// The longest wait.
const LONGEST: Duration = Duration::from_secs(15);

/// Attempts at something.
pub struct Attempts<'c> {
    left: u32,
    wait: Duration,
    counts: &'c Mutex<Counts>,
}

impl<'c> Attempts<'c> {
    /// Returns the first attempt and at most `retries` more, which are counted in `counts`.
    pub fn new(retries: u32, counts: &'c Mutex<Counts>) -> Self {
        Self { left: retries, wait: FIRST, counts }
    }

    /// Waits for the next attempt after `error`.
    ///
    /// # Errors
    /// `error` itself, if it will not pass or there were attempts enough.
    pub async fn after(&mut self, error: RemoteError) -> Result<(), RemoteError> {
        if self.left == 0 || !error.is_passing() {
            return Err(error);
        }
        self.left -= 1;
        self.counts.lock().unwrap_or_else(PoisonError::into_inner).retries += 1;
        // Callers that were refused together do not come back together.
        let wait = self.wait.mul_f64(0.5 + 0.5 * fraction());
        self.wait = (2 * self.wait).min(LONGEST);
        tokio::time::sleep(wait).await;
        Ok(())
    }

    /// Calls until it works, or there were attempts enough.
    ///
    /// # Errors
    /// The last one.
    pub async fn at<T, F>(mut self, mut call: impl FnMut() -> F) -> Result<T, RemoteError>
    where
        F: Future<Output = Result<T, RemoteError>>,
    {
        loop {
            match call().await {
                Ok(value) => return Ok(value),
                // Whoever called knows what to send again.
                Err(error) if error.is_missing() => return Err(error),
                Err(error) => self.after(error).await?,
            }
        }
    }
}

/// A random number from 0 to 1, as far as the hasher of the standard library is random.
fn fraction() -> f64 {
    (random() >> 11) as f64 / (1u64 << 53) as f64
}

/// 64 random bits. Neither secrets nor outputs depend on them.
pub fn random() -> u64 {
    use std::hash::{BuildHasher, Hasher, RandomState};
    RandomState::new().build_hasher().finish()
}
