//! Paths that may be written.

use std::io;
use std::path::{Path, PathBuf};

use super::error::PublishError;
use super::real::real;
use super::write::{Staged, publish, write_new, write_unsynced};
use crate::digest::Digest;

/// Returns the folder of `path`, which is empty for a name without a folder.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// A path that may be written. [`super::Guard`] makes one after it has checked the path.
#[derive(Debug)]
pub struct OutputPath {
    path: PathBuf,
}

impl OutputPath {
    /// Makes an output path. Only the guard of this module calls this function.
    pub(super) fn new(path: &Path) -> Self {
        Self { path: path.to_owned() }
    }

    /// Returns the output path for `path` below the folder `root`, whose files belong to the tool alone, such as a
    /// cache.
    ///
    /// # Errors
    /// The system's, and an error for a link below `root` that leads out of `root`.
    pub fn below(root: &Path, path: &Path) -> io::Result<Self> {
        let folder = folder_of(path);
        let leads_to = real(folder)?;
        if leads_to.starts_with(real(root)?) {
            return Ok(Self::new(path));
        }
        let found = format!("a link to {}, which is outside of the folder; remove the link", leads_to.display());
        Err(io::Error::new(io::ErrorKind::InvalidInput, found))
    }

    /// Returns the path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file whole or not at all, synced to the disk, and makes its folder.
    ///
    /// # Errors
    /// [`PublishError::Write`].
    pub fn write(&self, bytes: &[u8]) -> Result<(), PublishError> {
        publish(Vec::new(), Some(self.stage(bytes)?))
    }

    /// Writes the file under a temporary name in its folder, without publishing it.
    ///
    /// # Errors
    /// [`PublishError::Write`].
    pub fn stage(&self, bytes: &[u8]) -> Result<Staged, PublishError> {
        Staged::new(&self.path, bytes).map_err(|error| PublishError::Write { path: self.path.clone(), error })
    }

    /// Copies `from` under a temporary name into the folder of this path. Returns `None` if its digest is not `blake3`.
    /// The file is read once and hashed while it is copied.
    ///
    /// # Errors
    /// [`PublishError::Copy`] and [`PublishError::Write`].
    pub fn stage_copy(&self, from: &Path, blake3: Digest) -> Result<Option<Staged>, PublishError> {
        Staged::copy(&self.path, from, blake3)
    }

    /// Writes a new file whole or not at all, into an existing folder.
    ///
    /// # Errors
    /// The system's, also if the file exists.
    pub fn write_new(&self, bytes: &[u8]) -> io::Result<()> {
        write_new(&self.path, bytes)
    }

    /// Writes the file whole or not at all, without syncing: a power failure may lose the file, so readers must verify
    /// it.
    ///
    /// # Errors
    /// The system's.
    pub fn write_unsynced(&self, bytes: &[u8]) -> io::Result<()> {
        write_unsynced(&self.path, bytes)
    }
}
