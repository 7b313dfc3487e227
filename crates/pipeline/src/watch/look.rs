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
    inode: Inode,
}

/// Number of the inode and time of its last change, where the system has them. They differ for a file that was replaced
/// by one of equal size and time. Programs can set the time of a file, but not the time of this change, which a rename
/// on most file systems renews, too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Inode {
    number: u64,
    changed: Option<SystemTime>,
}

impl Look {
    /// Looks at the file at `path`; returns `None` where there is none.
    pub fn at(path: &Path) -> Option<Self> {
        let facts = fs::metadata(path).ok()?;
        Some(Self { bytes: facts.len(), modified: facts.modified().ok(), inode: inode(&facts) })
    }
}

#[cfg(unix)]
fn inode(facts: &fs::Metadata) -> Inode {
    use std::os::unix::fs::MetadataExt;
    let seconds = u64::try_from(facts.ctime()).unwrap_or_default();
    let since_1970 = Duration::from_secs(seconds) + Duration::from_nanos(facts.ctime_nsec().unsigned_abs());
    Inode { number: facts.ino(), changed: SystemTime::UNIX_EPOCH.checked_add(since_1970) }
}

#[cfg(not(unix))]
fn inode(_: &fs::Metadata) -> Inode {
    Inode::default()
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
        let is_before = |time: SystemTime| since.duration_since(time).is_ok_and(|age| age > RESOLUTION);
        // A file with an old time may have been moved into the place of the file that was read.
        let is_old = |look: Look| look.modified.is_some_and(is_before) && look.inode.changed.is_none_or(is_before);
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
