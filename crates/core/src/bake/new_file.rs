//! New files of a baked asset.

use std::path::PathBuf;

/// A file to be written beside the document.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct NewFile {
    /// Relative to the document.
    pub path: PathBuf,
    /// Its content.
    pub bytes: Vec<u8>,
}

impl NewFile {
    /// Returns a file at `path`, which is relative to the document.
    pub fn new(path: impl Into<PathBuf>, bytes: Vec<u8>) -> Self {
        Self { path: path.into(), bytes }
    }
}
