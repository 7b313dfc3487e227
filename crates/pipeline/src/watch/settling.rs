//! Whether files are still being written. A file that looks equal for a while is complete.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::look::Look;

/// Files that changed, with their looks and the time of their last change.
#[derive(Debug)]
pub struct Settling {
    window: Duration,
    files: BTreeMap<PathBuf, (Option<Look>, Instant)>,
}

impl Settling {
    /// Returns a record without files. A file is settled once its look has not changed for `window`.
    pub fn new(window: Duration) -> Self {
        Self { window, files: BTreeMap::new() }
    }

    /// Returns whether the file at `path`, which looks like `look` at `now`, is settled. If it is not, ask again later.
    pub fn is_settled(&mut self, path: &Path, look: Option<Look>, now: Instant) -> bool {
        match self.files.get(path) {
            Some((known, since)) if *known == look => now.duration_since(*since) >= self.window,
            _ => {
                self.files.insert(path.to_owned(), (look, now));
                self.window.is_zero()
            }
        }
    }

    /// Returns when the next file may have settled. If all files have settled by `now`, forgets them.
    pub fn pending(&mut self, now: Instant) -> Option<Instant> {
        // Settled files are kept as long as another file is waited for.
        let pending = self.files.values().map(|(_, since)| *since + self.window).filter(|at| *at > now).min();
        if pending.is_none() {
            self.files.clear();
        }
        pending
    }
}

#[cfg(test)]
mod tests;
