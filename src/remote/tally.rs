//! What was done on a server, in numbers.

use std::sync::atomic::{AtomicU64, Ordering};

use super::outcome::Counts;

/// Numbers that any thread adds to.
#[derive(Debug, Default)]
pub struct Tally {
    pub(super) queued: AtomicU64,
    pub(super) running: AtomicU64,
    pub(super) actions: AtomicU64,
    pub(super) executed: AtomicU64,
    pub(super) cached: AtomicU64,
    pub(super) done: AtomicU64,
    pub(super) known: AtomicU64,
    pub(super) retries: AtomicU64,
    pub(super) uploaded_blobs: AtomicU64,
    pub(super) uploaded_bytes: AtomicU64,
    pub(super) downloaded_blobs: AtomicU64,
    pub(super) downloaded_bytes: AtomicU64,
}

impl Tally {
    /// The numbers now.
    pub fn counts(&self) -> Counts {
        let now = |number: &AtomicU64| number.load(Ordering::Relaxed);
        Counts {
            queued: now(&self.queued),
            running: now(&self.running),
            done: now(&self.done),
            known: now(&self.known),
            actions: now(&self.actions),
            executed: now(&self.executed),
            cached: now(&self.cached),
            retries: now(&self.retries),
            uploaded_blobs: now(&self.uploaded_blobs),
            uploaded_bytes: now(&self.uploaded_bytes),
            downloaded_blobs: now(&self.downloaded_blobs),
            downloaded_bytes: now(&self.downloaded_bytes),
        }
    }
}

/// Adds to a number.
pub fn add(number: &AtomicU64, more: u64) {
    number.fetch_add(more, Ordering::Relaxed);
}

/// Takes from a number.
pub fn take(number: &AtomicU64, less: u64) {
    number.fetch_sub(less, Ordering::Relaxed);
}
