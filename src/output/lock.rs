//! Keeps bakes of different settings into one folder from mixing their outputs.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
#[cfg(unix)]
use std::time::Duration;

/// An output folder that no other run writes to, until this is dropped.
///
/// The lock is an advisory one on the folder itself: it leaves no file behind and ends with its process. Where a system or a
/// file system has no such locks, there is none.
#[derive(Debug)]
pub struct OutputLock {
    /// Open as long as the lock is held.
    #[cfg_attr(not(unix), expect(dead_code, reason = "locks are for Unix"))]
    folder: File,
    /// Folders that were made for it, the deepest first. Those that are empty in the end go again.
    made: Vec<PathBuf>,
}

/// How many runs may write to the folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// This one.
    Alone,
    /// Parts of a run, side by side: they write different assets.
    Parts,
}

/// How long a run waits between two tries, and after how many it says so: 2 s.
#[cfg(unix)]
const PAUSE: Duration = Duration::from_millis(20);
#[cfg(unix)]
const PATIENCE: usize = 100;

impl OutputLock {
    /// Locks `folder`, which is made if it is not there. As long as another run holds the lock, `wait` is asked again and again
    /// whether to wait on, once with a message for a person. Returns `None` where not, and where there are no locks.
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
            // The run that held the lock may have removed the folder, which was empty then.
            let identity = |facts: fs::Metadata| (facts.dev(), facts.ino());
            let own = lock.folder.metadata().map(identity);
            if matches!((own, fs::metadata(folder).map(identity)), (Ok(own), Ok(there)) if own == there) {
                return Ok(Some(lock));
            }
        }
        Ok(None)
    }

    /// Windows does not open folders.
    #[cfg(not(unix))]
    pub fn take(_: &Path, _: Kind, _: &mut dyn FnMut(Option<&str>) -> io::Result<bool>) -> io::Result<Option<Self>> {
        Ok(None)
    }

    /// Opens and makes `folder`; `None` where that cannot be done, which is told when something is written to it.
    #[cfg(unix)]
    fn open(folder: &Path) -> Option<Self> {
        let is_missing = |above: &&Path| !above.as_os_str().is_empty() && !above.exists();
        let made = folder.ancestors().take_while(is_missing).map(Path::to_owned).collect();
        std::fs::create_dir_all(folder).ok()?;
        Some(Self { folder: File::open(folder).ok()?, made })
    }

    /// Keeps the folders that were made, be they empty.
    pub fn keep_folders(mut self) -> Self {
        self.made.clear();
        self
    }
}

impl Drop for OutputLock {
    fn drop(&mut self) {
        for folder in &self.made {
            // Fails where anything was written.
            let _ = std::fs::remove_dir(folder);
        }
    }
}
