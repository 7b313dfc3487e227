//! Which paths matter: all below the watched folder, some files elsewhere, and the folders on the way to it.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use crate::output;
use crate::project::FILE_NAME;

/// The paths that matter, without links and dots in their folders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scope {
    root: PathBuf,
    /// Folders that are written to.
    ours: Vec<PathBuf>,
    /// Files that are read and lie elsewhere.
    elsewhere: BTreeSet<PathBuf>,
}

impl Scope {
    /// What matters to assets below `root`, if `ours` are the folders that are written to and `files` those that are read.
    pub fn new<'p>(root: &Path, ours: &[&Path], files: impl IntoIterator<Item = &'p Path>) -> Self {
        let root = real(root);
        let ours = ours.iter().map(|folder| real(folder)).collect();
        let mut folders = HashMap::new();
        let real_files = files.into_iter().map(|file| match (file.is_symlink(), file.parent(), file.file_name()) {
            (false, Some(folder), Some(name)) => folders.entry(folder).or_insert_with(|| real(folder)).join(name),
            // What it names is read.
            _ => real(file),
        });
        let elsewhere = real_files.filter(|file| !file.starts_with(&root)).collect();
        Self { root, ours, elsewhere }
    }

    /// Whether something that happened to `path` is a reason to look.
    pub fn concerns(&self, path: &Path) -> bool {
        let is_config =
            || path.file_name() == Some(FILE_NAME.as_ref()) && path.parent().is_some_and(|p| self.root.starts_with(p));
        if path.starts_with(&self.root) {
            return !self.ours.iter().any(|folder| path.starts_with(folder));
        }
        // The root's own way, which may be renamed, made or linked anew, and folders on the way to other files.
        self.root.starts_with(path) || is_config() || self.elsewhere.iter().any(|file| file.starts_with(path))
    }

    /// The folder whose whole content is to be watched.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Folders whose own entries are to be watched: those above the root, and those of files elsewhere and above them.
    pub fn folders(&self) -> BTreeSet<PathBuf> {
        let files = self.elsewhere.iter().chain([&self.root]);
        let above = files.flat_map(|file| file.ancestors().skip(1));
        above.filter(|folder| !folder.starts_with(&self.root)).map(Path::to_owned).collect()
    }
}

/// `path` without links and dots, whether or not it exists; as it is where it cannot be resolved.
pub fn real(path: &Path) -> PathBuf {
    output::real(path).or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn what_is_read_concerns_and_what_is_written_does_not() {
        let none = Path::new("/no-such-folder");
        let path = |name: &str| none.join(name);
        let files = [path("work/shared/wood.png"), path("work/assets/a.png")];
        let files = files.iter().map(PathBuf::as_path);
        let scope = Scope::new(&path("work/assets"), &[&path("work/assets/out"), &path("work/out")], files);
        for (name, concerns) in [
            ("work/assets", true),
            ("work/assets/new/b.gltf", true),
            ("work/assets/out/a.gltf", false),
            ("work/assets/out", false),
            ("work/out/a.gltf", false),
            ("work/other.png", false),
            ("work/shared/wood.png", true),
            ("work/shared/stone.png", false),
            ("work/shared", true),
            ("work", true),
            ("work/roughcast.toml", true),
            ("roughcast.toml", true),
            ("work/shared/roughcast.toml", false),
        ] {
            assert_eq!(scope.concerns(&path(name)), concerns, "{name}");
        }
        let folders = scope.folders();
        for name in ["", "work", "work/shared"] {
            assert!(folders.contains(&path(name)), "{name}");
        }
        assert!(folders.iter().all(|folder| !folder.starts_with(path("work/assets"))), "{folders:?}");
    }
}
