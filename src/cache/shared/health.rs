//! Whether a store answers, so that a bake neither waits for one that is away nor complains of it twice.

use std::error::Error as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use object_store::Error;

use crate::cache::CacheError;

/// For how long a store that did not answer is not asked.
const REST: Duration = Duration::from_secs(60);

/// What is known of a store.
#[derive(Debug, Default)]
pub struct Health {
    asleep_until: Mutex<Option<Instant>>,
    was_reported: AtomicBool,
    is_read_only: AtomicBool,
}

impl Health {
    /// Whether to ask it.
    pub fn is_awake(&self) -> bool {
        let until = self.asleep_until.lock().map_or(None, |until| *until);
        until.is_none_or(|until| until <= Instant::now())
    }

    /// Whether to put into it.
    pub fn is_writable(&self) -> bool {
        !self.is_read_only.load(Ordering::Relaxed) && self.is_awake()
    }

    /// Lets it rest.
    ///
    /// # Errors
    /// [`CacheError::Unreachable`] the first time.
    pub fn get_failed(&self, url: &str, error: &Error) -> Result<(), CacheError> {
        if let Ok(mut until) = self.asleep_until.lock() {
            *until = Some(Instant::now() + REST);
        }
        if self.was_reported.swap(true, Ordering::Relaxed) {
            return Ok(());
        }
        Err(CacheError::Unreachable { url: url.to_owned(), reason: reason(error) })
    }

    /// The same, except that it is only read from where it takes nothing.
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

/// The innermost reason in one line, without the store's answer, which may name keys.
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
mod tests {
    use super::*;

    fn denied() -> Error {
        Error::PermissionDenied { path: "a".to_owned(), source: "<Key>secret</Key>".into() }
    }

    fn away() -> Error {
        Error::Generic { store: "S3", source: "refused: <Key>secret</Key>".into() }
    }

    #[test]
    fn a_store_that_is_away_is_told_once_and_rests() {
        let health = Health::default();
        assert!(health.is_awake() && health.is_writable());
        let told = health.get_failed("s3://a", &away()).expect_err("a warning");
        assert_eq!(told.to_string(), "s3://a: expected a store that answers, found: refused; go on without it");
        assert!(!health.is_awake() && !health.is_writable());
        assert!(health.get_failed("s3://a", &away()).is_ok() && health.put_failed("s3://a", &away()).is_ok());
        *health.asleep_until.lock().expect("a lock") = Some(Instant::now());
        assert!(health.is_awake() && health.is_writable());
    }

    #[test]
    fn a_store_that_takes_nothing_is_read_from() {
        let health = Health::default();
        let told = health.put_failed("s3://a", &denied()).expect_err("a warning");
        assert!(matches!(&told, CacheError::ReadOnly { reason, .. } if reason == "no permission"), "{told}");
        assert!(health.is_awake() && !health.is_writable());
        assert!(health.put_failed("s3://a", &denied()).is_ok());
    }
}
