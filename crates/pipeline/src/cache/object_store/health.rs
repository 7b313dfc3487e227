//! The health of an object store. A bake neither waits for a store that does not answer, nor reports it twice.

use std::error::Error as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use object_store::Error;

use crate::cache::CacheError;

/// Time for which a store that did not answer is not used.
const PAUSE: Duration = Duration::from_secs(60);

/// What is known about a store.
#[derive(Debug, Default)]
pub struct Health {
    paused_until: Mutex<Option<Instant>>,
    was_reported: AtomicBool,
    is_read_only: AtomicBool,
}

impl Health {
    /// Returns whether the store may be read.
    pub fn is_available(&self) -> bool {
        let until = self.paused_until.lock().map_or(None, |until| *until);
        until.is_none_or(|until| until <= Instant::now())
    }

    /// Returns whether the store may be written.
    pub fn is_writable(&self) -> bool {
        !self.is_read_only.load(Ordering::Relaxed) && self.is_available()
    }

    /// Pauses the use of the store.
    ///
    /// # Errors
    /// [`CacheError::Unreachable`] the first time.
    pub fn get_failed(&self, url: &str, error: &Error) -> Result<(), CacheError> {
        if let Ok(mut until) = self.paused_until.lock() {
            *until = Some(Instant::now() + PAUSE);
        }
        if self.was_reported.swap(true, Ordering::Relaxed) {
            return Ok(());
        }
        Err(CacheError::Unreachable { url: url.to_owned(), reason: reason(error) })
    }

    /// Pauses the use of the store, or only its writes if it refuses new objects.
    ///
    /// # Errors
    /// [`CacheError::ReadOnly`] or [`CacheError::Unreachable`] the first time.
    pub fn put_failed(&self, url: &str, error: &Error) -> Result<(), CacheError> {
        match error {
            Error::PermissionDenied { .. } | Error::NotImplemented { .. } | Error::NotSupported { .. } => {
                if self.is_read_only.swap(true, Ordering::Relaxed) {
                    return Ok(());
                }
                Err(CacheError::ReadOnly { url: url.to_owned(), reason: reason(error) })
            }
            _ => self.get_failed(url, error),
        }
    }
}

/// Returns the innermost reason in one line, without the store's answer, which may contain keys.
pub fn reason(error: &Error) -> String {
    match error {
        Error::PermissionDenied { .. } => return "no permission".to_owned(),
        Error::Unauthenticated { .. } => return "no valid credentials".to_owned(),
        _ => {}
    }
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(inner) = source {
        text = inner.to_string();
        source = inner.source();
    }
    let line = text.lines().next().unwrap_or_default().split('<').next().unwrap_or_default();
    line.trim_end_matches([' ', ':']).to_owned()
}

#[cfg(test)]
mod tests;
