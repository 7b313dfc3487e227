//! Which configurations the user trusts.
//!
//! A `roughcast.toml` is trusted if `--config` names it or if it lies in the working folder. Any other configuration
//! was found beside the assets and may have come with them, from strangers. The output folder that such a configuration
//! names must lie below the working folder, outside of hidden folders. Its server is not used.

use std::path::{Component, Path, PathBuf};

use super::remote::RemoteValues;
use crate::output::real;

/// The server that a configuration names.
pub struct NamedServer {
    /// What the configuration sets for the server.
    pub values: RemoteValues,
    /// The configuration.
    pub config: PathBuf,
    /// Whether the configuration is trusted.
    pub is_trusted: bool,
}

/// Returns whether `folder`, which has neither links nor dots, is the working folder.
pub fn is_working_folder(folder: &Path) -> bool {
    real(Path::new("")).is_ok_and(|here| here == folder)
}

/// Returns whether a configuration that came with assets may name `path`: `path` lies below the working folder, and no
/// part of `path` is hidden. Hidden folders hold keys and settings of other programs.
pub fn is_harmless(path: &Path) -> bool {
    let (Ok(here), Ok(path)) = (real(Path::new("")), real(path)) else { return false };
    let is_visible = |part: Component<'_>| !part.as_os_str().as_encoded_bytes().starts_with(b".");
    path.strip_prefix(here).is_ok_and(|below| below.components().next().is_some() && below.components().all(is_visible))
}
