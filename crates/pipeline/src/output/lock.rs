//! Locks that keep bakes with different settings from mixing their outputs in one folder.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
#[cfg(unix)]
use std::time::Duration;

/// An output folder that no other run writes to, until this value is dropped.
///
/// The lock is an advisory lock on the folder itself: it leaves no file behind and ends with its process. Without such
/// locks in the system or the file system, nothing is locked.
#[derive(Debug)]
pub struct OutputLock {
    /// Open as long as the lock is held.
    #[cfg_attr(not(unix), expect(dead_code, reason = "locks are for Unix"))]
    folder: File,
    /// Folders that were made for this run, the deepest first. Empty ones are removed at the end.
    made: Vec<PathBuf>,
}

/// How many runs may write to the folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Only this run.
    Alone,
    /// Parts of a run, side by side: they write different assets.
    Parts,
}

/// Pause between two tries.
#[cfg(unix)]
const PAUSE: Duration = Duration::from_millis(20);

/// Number of tries after which a run reports that it waits: 2 s.
#[cfg(unix)]
const PATIENCE: usize = 100;

impl OutputLock {
    /// Locks `folder`, and makes the folder if it does not exist. While another run holds the lock, `wait` is called
    /// before each pause and returns whether to wait on; one call has a message for the user. Returns `None` if `wait`
    /// returns false, and on systems without locks.
    ///
    /// # Errors
    /// That of `wait`.
    #[cfg(unix)]
    pub fn take(
        folder: &Path,
        kind: Kind,
        wait: &mut dyn FnMut(Option<&str>) -> io::Result<bool>,
    ) -> io::Result<Option<Self>> {
        use std::fs::{self, TryLockError};
        use std::os::unix::fs::MetadataExt;
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let message = format!("waiting for another run of roughcast that writes to {}", folder.display());
        let mut tries = 0;
        while let Some(lock) = Self::open(folder) {
            loop {
                let locked = match kind {
                    Kind::Alone => lock.folder.try_lock(),
                    Kind::Parts => lock.folder.try_lock_shared(),
                };
                match locked {
                    Ok(()) => break,
                    Err(TryLockError::Error(_)) => return Ok(None),
                    Err(TryLockError::WouldBlock) => {
                        tries += 1;
                        if !wait((tries == PATIENCE).then_some(&message))? {
                            return Ok(None);
                        }
                        std::thread::sleep(PAUSE);
                    }
                }
            }
            // The run that held the lock may have removed the folder if it was empty.
            let identity = |facts: fs::Metadata| (facts.dev(), facts.ino());
            let own = lock.folder.metadata().map(identity);
            if matches!((own, fs::metadata(folder).map(identity)), (Ok(own), Ok(there)) if own == there) {
                return Ok(Some(lock));
            }
        }
        Ok(None)
    }

    /// Returns `None`, since Windows does not open folders.
    #[cfg(not(unix))]
    pub fn take(_: &Path, _: Kind, _: &mut dyn FnMut(Option<&str>) -> io::Result<bool>) -> io::Result<Option<Self>> {
        Ok(None)
    }

    /// Makes and opens `folder`. Returns `None` if that fails; the first write to the folder then reports the error.
    #[cfg(unix)]
    fn open(folder: &Path) -> Option<Self> {
        let is_missing = |above: &&Path| !above.as_os_str().is_empty() && !above.exists();
        let made = folder.ancestors().take_while(is_missing).map(Path::to_owned).collect();
        std::fs::create_dir_all(folder).ok()?;
        Some(Self { folder: File::open(folder).ok()?, made })
    }

    /// Keeps the folders that were made, even if they are empty.
    pub fn keep_folders(mut self) -> Self {
        self.made.clear();
        self
    }
}

impl Drop for OutputLock {
    fn drop(&mut self) {
        for folder in &self.made {
            // Fails if the folder is not empty.
            let _ = std::fs::remove_dir(folder);
        }
    }
}
