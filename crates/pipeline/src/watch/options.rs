//! What is watched, and how.

use std::path::PathBuf;
use std::time::Duration;

use super::hook::Hook;
use crate::cache::Cache;
use crate::project::Selection;

/// What is watched, and how.
pub struct WatchOptions {
    /// The watched folder, which need not exist yet.
    pub folder: PathBuf,
    /// How its assets are selected and configured.
    pub selection: Selection,
    /// The output folder.
    pub output: PathBuf,
    /// The cache.
    pub cache: Option<Cache>,
    /// The folder of the cache, which is no reason to look.
    pub cache_folder: Option<PathBuf>,
    /// How long a file must stay as it is before it counts as written.
    pub settle: Duration,
    /// The time between two looks, instead of events of the system.
    pub poll: Option<Duration>,
    /// The command that runs after outputs changed.
    pub hook: Option<Hook>,
}
