//! The paths that matter: everything below the watched folder, some files elsewhere, and the folders above both.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use crate::output;
use crate::project::FILE_NAME;

/// The paths that matter. Their folders have neither links nor dots.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scope {
    root: PathBuf,
    /// Folders that are written to.
    ours: Vec<PathBuf>,
    /// Files that are read and lie elsewhere.
    elsewhere: BTreeSet<PathBuf>,
}

impl Scope {
    /// Returns the paths that matter to assets below `root`. `ours` are the folders that are written to, and `files`
    /// are the files that are read.
    pub fn new<'p>(root: &Path, ours: &[&Path], files: impl IntoIterator<Item = &'p Path>) -> Self {
        let root = real(root);
        let ours = ours.iter().map(|folder| real(folder)).collect();
        let mut folders = HashMap::new();
        let real_files = files.into_iter().map(|file| match (file.is_symlink(), file.parent(), file.file_name()) {
            (false, Some(folder), Some(name)) => folders.entry(folder).or_insert_with(|| real(folder)).join(name),
            // The file that the link leads to is read.
            _ => real(file),
        });
        let elsewhere = real_files.filter(|file| !file.starts_with(&root)).collect();
        Self { root, ours, elsewhere }
    }

    /// Returns whether an event of `path` is a reason to look.
    pub fn concerns(&self, path: &Path) -> bool {
        let is_config =
            || path.file_name() == Some(FILE_NAME.as_ref()) && path.parent().is_some_and(|p| self.root.starts_with(p));
        if path.starts_with(&self.root) {
            return !self.ours.iter().any(|folder| path.starts_with(folder));
        }
        // Folders above the root, which may be renamed, made or linked again, and folders above files elsewhere.
        self.root.starts_with(path) || is_config() || self.elsewhere.iter().any(|file| file.starts_with(path))
    }

    /// Returns the folder whose whole content is to be watched.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Returns the folders whose direct entries are to be watched: the folders above the root and above files
    /// elsewhere.
    pub fn folders(&self) -> BTreeSet<PathBuf> {
        let files = self.elsewhere.iter().chain([&self.root]);
        let above = files.flat_map(|file| file.ancestors().skip(1));
        above.filter(|folder| !folder.starts_with(&self.root)).map(Path::to_owned).collect()
    }
}

/// Returns `path` without links and dots, whether or not it exists, or `path` itself where it cannot be resolved.
pub fn real(path: &Path) -> PathBuf {
    output::real(path).or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_owned())
}

#[cfg(test)]
mod tests;
