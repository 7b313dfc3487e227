//! The result of a bake of an asset.

use std::path::PathBuf;

use super::new_file::NewFile;
use crate::gltf::document::Container;
use crate::report::AssetReport;

/// A baked asset, ready to be written.
#[non_exhaustive]
pub struct BakedAsset {
    /// The document.
    pub document: Vec<u8>,
    /// Which kind of document it is.
    pub container: Container,
    /// New files.
    pub files: Vec<NewFile>,
    /// Files that the document refers to and that did not change, by their paths relative to the document.
    pub copies: Vec<PathBuf>,
    /// What was done.
    pub report: AssetReport,
}
