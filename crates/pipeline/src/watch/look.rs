//! Finds whether a file changed without reading the file.

use std::fs;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// The coarsest resolution of file times, which is that of FAT. A file that changed less than this before it was read
/// may change again and look as before.
const RESOLUTION: Duration = Duration::from_secs(2);

/// Size, times and identity of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    bytes: u64,
    modified: Option<SystemTime>,
    /// Inode and time of the last change of the inode, where the system has them. They differ for a file that was
    /// replaced by one of equal size and time.
    identity: (u64, i64, i64),
}

impl Look {
    /// Looks at the file at `path`; returns `None` where there is none.
    pub fn at(path: &Path) -> Option<Self> {
        let facts = fs::metadata(path).ok()?;
        Some(Self { bytes: facts.len(), modified: facts.modified().ok(), identity: identity(&facts) })
    }
}

#[cfg(unix)]
fn identity(facts: &fs::Metadata) -> (u64, i64, i64) {
    use std::os::unix::fs::MetadataExt;
    (facts.ino(), facts.ctime(), facts.ctime_nsec())
}

#[cfg(not(unix))]
fn identity(_: &fs::Metadata) -> (u64, i64, i64) {
    (0, 0, 0)
}

/// A file as it looked when it was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    look: Option<Look>,
    /// Whether a file that looks the same surely has the bytes that were read.
    is_certain: bool,
}

impl Seen {
    /// Returns what is known of a file that had `look` after it was read. Reading began at `since`, and `was_found`
    /// says whether it found a file.
    pub fn new(look: Option<Look>, was_found: bool, since: SystemTime) -> Self {
        let is_old = |look: Look| {
            let age = look.modified.and_then(|modified| since.duration_since(modified).ok());
            age.is_some_and(|age| age > RESOLUTION)
        };
        Self { look, is_certain: look.is_some() == was_found && look.is_none_or(is_old) }
    }

    /// Returns whether the file, which now looks like `now`, surely has the bytes that were read.
    pub fn is_unchanged(&self, now: Option<Look>) -> bool {
        self.is_certain && self.look == now
    }

    /// Returns how the file looked; `None` where there was none.
    pub fn look(&self) -> Option<Look> {
        self.look
    }

    /// Returns whether the file, which now looks like `now`, looks as before.
    pub fn looks_like(&self, now: Option<Look>) -> bool {
        self.look == now
    }
}

#[cfg(test)]
mod tests;
