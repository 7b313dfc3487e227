//! What tells that a file is another, without reading it.

use std::fs;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// Files that changed less than this before they were read may change again without looking other than before: 2 s is the
/// resolution of times on FAT, the coarsest.
const RESOLUTION: Duration = Duration::from_secs(2);

/// Size, times and identity of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    bytes: u64,
    modified: Option<SystemTime>,
    /// Inode and time of its last change, where there are such: they tell of replaced files that keep size and time.
    identity: (u64, i64, i64),
}

impl Look {
    /// Of the file at `path`; `None` where there is none.
    pub fn at(path: &Path) -> Option<Self> {
        let facts = fs::metadata(path).ok()?;
        Some(Self { bytes: facts.len(), modified: facts.modified().ok(), identity: identity(&facts) })
    }

    /// Of a file of `bytes` that was modified at `modified`.
    #[cfg(test)]
    pub fn new(bytes: u64, modified: SystemTime) -> Self {
        Self { bytes, modified: Some(modified), identity: (0, 0, 0) }
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

/// A file as it was when it was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    look: Option<Look>,
    is_certain: bool,
}

impl Seen {
    /// `look` was taken after the file was read; the reading, which found a file or not, began at `since`.
    pub fn new(look: Option<Look>, was_found: bool, since: SystemTime) -> Self {
        let is_old = |look: Look| {
            let age = look.modified.and_then(|modified| since.duration_since(modified).ok());
            age.is_some_and(|age| age > RESOLUTION)
        };
        Self { look, is_certain: look.is_some() == was_found && look.is_none_or(is_old) }
    }

    /// Whether the file surely has the bytes that were read, if it looks like `now`.
    pub fn is_still(&self, now: Option<Look>) -> bool {
        self.is_certain && self.look == now
    }

    /// How the file looked; `None` where there was none.
    pub fn look(&self) -> Option<Look> {
        self.look
    }

    /// Whether the file looks as it did.
    pub fn looks_like(&self, now: Option<Look>) -> bool {
        self.look == now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: u64) -> SystemTime {
        SystemTime::UNIX_EPOCH + Duration::from_secs(seconds)
    }

    #[test]
    fn an_old_file_that_looks_the_same_is_the_same() {
        let look = Some(Look::new(10, at(100)));
        assert!(Seen::new(look, true, at(103)).is_still(look));
        assert!(!Seen::new(look, true, at(103)).is_still(Some(Look::new(11, at(100)))));
        assert!(!Seen::new(look, true, at(103)).is_still(Some(Look::new(10, at(99)))));
        assert!(!Seen::new(look, true, at(103)).is_still(None));
        assert!(Seen::new(None, false, at(103)).is_still(None));
    }

    #[test]
    fn a_file_may_change_within_the_resolution_of_its_time() {
        let look = Some(Look::new(10, at(100)));
        for since in [98, 100, 102] {
            let seen = Seen::new(look, true, at(since));
            assert!(!seen.is_still(look) && seen.looks_like(look), "{since}");
        }
    }

    #[test]
    fn a_file_that_came_or_went_while_it_was_read_is_read_again() {
        let look = Some(Look::new(10, at(100)));
        assert!(!Seen::new(look, false, at(200)).is_still(look));
        assert!(!Seen::new(None, true, at(200)).is_still(None));
    }
}
