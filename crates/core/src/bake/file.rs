//! New files of a baked asset.

use std::path::PathBuf;

/// A file to be written beside the document.
#[derive(Clone, Debug, PartialEq)]
pub struct NewFile {
    /// Relative to the document.
    pub path: PathBuf,
    /// Its content.
    pub bytes: Vec<u8>,
}
