//! Whether files are still being written: those that look the same for a while are not.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::look::Look;

/// Files that were found to be other than before, and since when they look as they do.
#[derive(Debug)]
pub struct Settling {
    window: Duration,
    files: BTreeMap<PathBuf, (Option<Look>, Instant)>,
}

impl Settling {
    /// A file is settled once it has looked the same for `window`.
    pub fn new(window: Duration) -> Self {
        Self { window, files: BTreeMap::new() }
    }

    /// Whether the file at `path`, which looks like `look` at `now`, is settled. If not, ask again.
    pub fn is_settled(&mut self, path: &Path, look: Option<Look>, now: Instant) -> bool {
        match self.files.get(path) {
            Some((known, since)) if *known == look => now.duration_since(*since) >= self.window,
            _ => {
                self.files.insert(path.to_owned(), (look, now));
                self.window.is_zero()
            }
        }
    }

    /// When the next file may have settled, if any has not by `now`. Forgets them all otherwise.
    pub fn pending(&mut self, now: Instant) -> Option<Instant> {
        // What has settled is kept as long as anything beside it may be waited for.
        let pending = self.files.values().map(|(_, since)| *since + self.window).filter(|at| *at > now).min();
        if pending.is_none() {
            self.files.clear();
        }
        pending
    }
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    #[test]
    fn a_file_settles_when_it_stays_for_the_window() {
        let (start, path) = (Instant::now(), Path::new("a.png"));
        let at = |ms| start + Duration::from_millis(ms);
        let look = |bytes| Some(Look::new(bytes, SystemTime::UNIX_EPOCH));
        let mut settling = Settling::new(Duration::from_millis(50));
        for (ms, look, is_settled) in [
            (0, look(1), false),
            (40, look(1), false),
            (45, look(2), false),
            (94, look(2), false),
            (95, look(2), true),
            (96, None, false),
            (120, look(3), false),
            (169, look(3), false),
            (170, look(3), true),
        ] {
            assert_eq!(settling.is_settled(path, look, at(ms)), is_settled, "at {ms} ms");
        }
    }

    #[test]
    fn others_do_not_hold_a_file_up() {
        let (start, window) = (Instant::now(), Duration::from_millis(50));
        let mut settling = Settling::new(window);
        let look = Some(Look::new(1, SystemTime::UNIX_EPOCH));
        settling.is_settled(Path::new("a"), look, start);
        settling.is_settled(Path::new("b"), look, start + window / 2);
        assert_eq!(settling.pending(start), Some(start + window));
        assert!(settling.is_settled(Path::new("a"), look, start + window));
        assert!(!settling.is_settled(Path::new("b"), look, start + window));
        assert_eq!(settling.pending(start + window), Some(start + window / 2 + window));
        assert_eq!(settling.pending(start + 2 * window), None);
    }
}
