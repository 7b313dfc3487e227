//! Paths that may be written.

use std::io;
use std::path::{Path, PathBuf};

use super::error::PublishError;
use super::real::real;
use super::write::{Staged, show, write_new, write_unsynced};
use crate::digest::Digest;

/// A path that may be written. [`super::Guard`] makes one after it has checked the path.
#[derive(Debug)]
pub struct OutputPath {
    path: PathBuf,
}

impl OutputPath {
    /// Only the guard of this module says so.
    pub(super) fn new(path: &Path) -> Self {
        Self { path: path.to_owned() }
    }

    /// Returns the place of `path` below the folder `root`, whose files belong to the tool alone, such as a cache.
    ///
    /// # Errors
    /// The system's, or that a link below `root` leads out of it.
    pub fn below(root: &Path, path: &Path) -> io::Result<Self> {
        let folder = path.parent().unwrap_or(Path::new(""));
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

    /// Writes the file whole or not at all, to the disk itself, and makes its folder.
    ///
    /// # Errors
    /// [`PublishError::Write`].
    pub fn write(&self, bytes: &[u8]) -> Result<(), PublishError> {
        show(Vec::new(), Some(self.stage(bytes)?))
    }

    /// Writes the file beside its place, where nobody sees it yet.
    ///
    /// # Errors
    /// [`PublishError::Write`].
    pub fn stage(&self, bytes: &[u8]) -> Result<Staged, PublishError> {
        Staged::new(&self.path, bytes).map_err(|error| PublishError::Write { path: self.path.clone(), error })
    }

    /// Copies `from` beside its place, where nobody sees it yet, if its digest is `blake3`; returns `None` where it is another.
    /// The file is read once, and hashed on the way.
    ///
    /// # Errors
    /// [`PublishError::Copy`] and [`PublishError::Write`].
    pub fn stage_copy(&self, from: &Path, blake3: Digest) -> Result<Option<Staged>, PublishError> {
        Staged::copy(&self.path, from, blake3)
    }

    /// Writes the file whole or not at all if there is none, in a folder that is there.
    ///
    /// # Errors
    /// The system's, also where a file is there.
    pub fn write_new(&self, bytes: &[u8]) -> io::Result<()> {
        write_new(&self.path, bytes)
    }

    /// Writes the file whole or not at all. It may be gone after a power failure, so whoever reads it must verify it.
    ///
    /// # Errors
    /// The system's.
    pub fn write_unsynced(&self, bytes: &[u8]) -> io::Result<()> {
        write_unsynced(&self.path, bytes)
    }
}
