//! The output registry, which alone decides whether a path may be written.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::case::case_folded;
use super::error::PublishError;
use super::path::OutputPath;
use super::real::{is_same_file, real};
use super::sweep::sweep;

/// Decides whether paths may be written, from the files that a run reads, that its jobs will write, and that it has
/// written.
///
/// A source is never written, whatever links and dots lead to it. Two outputs never share a path. Outputs of assets
/// stay inside the output folder.
#[derive(Debug, Default)]
pub struct Guard {
    /// The output folder; if `None`, outputs stay inside the folder of their document.
    root: Option<PathBuf>,
    /// Resolved paths of the files that are read.
    sources: HashSet<PathBuf>,
    /// Files and folders that jobs will write.
    declared: HashSet<PathBuf>,
    /// Outputs of the run, by their paths in lower case, since some file systems ignore case.
    registered: HashMap<PathBuf, Registered>,
    /// Folders as given, and their resolved paths.
    folders: HashMap<PathBuf, PathBuf>,
    /// Folders from which the temporary files of killed runs were removed.
    swept: HashSet<PathBuf>,
}

/// An output of the run.
#[derive(Debug)]
struct Registered {
    /// The resolved path.
    path: PathBuf,
    /// The source of a copy, or the path of a new file.
    source: PathBuf,
}

impl Guard {
    /// Returns the guard of a run whose outputs stay inside `root`.
    pub fn inside(root: &Path) -> Self {
        Self { root: Some(root.components().collect()), ..Self::default() }
    }

    /// Protects a file that the run reads, and the target if the file is a link.
    pub fn add_source(&mut self, path: &Path) {
        if path.is_symlink() {
            self.sources.extend(fs::canonicalize(path));
        }
        // A path that cannot be resolved cannot be read either.
        let file = self.real_file(path);
        self.sources.extend(file);
    }

    /// Protects an output, or a folder of outputs, that a job of the run will write. Only that job may write there.
    pub fn declare(&mut self, path: &Path) {
        let file = self.real_file(path);
        self.declared.extend(file);
    }

    /// Reserves a file that the user names.
    ///
    /// # Errors
    /// [`PublishError`] if the path is a source or an output of the run, or is not a file.
    pub fn reserve_file(&mut self, path: &Path) -> Result<OutputPath, PublishError> {
        let failed = |error| PublishError::Write { path: path.to_owned(), error };
        let file = self.real_file(path).map_err(failed)?;
        // `canonicalize` finds the existing name where the system ignores case. A link itself is replaced, not its
        // target.
        let existing = if path.is_symlink() { None } else { fs::canonicalize(path).ok() };
        let in_use = |found| Err(PublishError::InUse { path: path.to_owned(), found });
        for file in existing.iter().chain([&file]) {
            if self.sources.contains(file) {
                return in_use("a source");
            }
            let is_declared = || file.ancestors().any(|above| self.declared.contains(above));
            if self.registered.contains_key(&case_folded(file)) || is_declared() {
                return in_use("an output");
            }
        }
        check_replaceable(path)?;
        self.registered.insert(case_folded(&file), Registered { path: file.clone(), source: file });
        Ok(OutputPath::new(path))
    }

    /// Reserves the existing file `path` of an earlier run, which is a copy of `source` or the output itself. Returns
    /// whether the path was free.
    pub fn reserve_existing(&mut self, path: &Path, source: &Path) -> bool {
        let (Ok(file), Ok(source)) = (self.real_file(path), self.real_file(source)) else { return false };
        self.register(path, file, source).is_ok()
    }

    /// Returns whether `path` is an output of the run, also if the names differ only in case.
    pub fn is_registered(&mut self, path: &Path) -> bool {
        self.real_file(path).is_ok_and(|file| self.registered.contains_key(&case_folded(&file)))
    }

    /// Registers the resolved path `file` of `path` for a copy of `source` or for the output itself.
    pub(super) fn register(&mut self, path: &Path, file: PathBuf, source: PathBuf) -> Result<(), PublishError> {
        match self.registered.entry(case_folded(&file)) {
            Entry::Occupied(taken) if !is_same_file(&taken.get().source, &source) => {
                let (path, taken) = (path.to_owned(), taken.get());
                Err(if taken.path == file {
                    PublishError::SamePlace { path, other: taken.source.clone() }
                } else {
                    PublishError::SameName { path, other: taken.path.clone() }
                })
            }
            Entry::Occupied(_) => Ok(()),
            Entry::Vacant(free) => {
                free.insert(Registered { path: file, source });
                Ok(())
            }
        }
    }

    /// Returns the resolved path of the output `path` of the asset whose outputs are in `folder`. Removes abandoned
    /// temporary files from the folder of `path` once.
    pub(super) fn output(&mut self, path: &Path, folder: &Path) -> Result<PathBuf, PublishError> {
        let failed = |error| PublishError::Write { path: path.to_owned(), error };
        let root = self.root.clone().unwrap_or_else(|| folder.to_owned());
        let file = self.real_file(path).map_err(failed)?;
        if !file.starts_with(self.real_folder(&root).map_err(failed)?) {
            return Err(match link_between(&root, path) {
                Some((link, target)) => PublishError::Linked { path: path.to_owned(), link, target },
                None => PublishError::Outside { path: path.to_owned(), folder: root },
            });
        }
        if self.sources.contains(&file) {
            return Err(PublishError::OverSource { path: path.to_owned() });
        }
        check_replaceable(path)?;
        if let Some(folder) = file.parent()
            && self.swept.insert(folder.to_owned())
        {
            sweep(folder);
        }
        Ok(file)
    }

    /// Returns `path` without links and dots in its folder. A link at the end of the path stays, since writing replaces
    /// that link.
    pub(super) fn real_file(&mut self, path: &Path) -> io::Result<PathBuf> {
        let name = path.file_name().ok_or_else(|| io::Error::from(io::ErrorKind::IsADirectory))?;
        Ok(self.real_folder(path.parent().unwrap_or(Path::new("")))?.join(name))
    }

    /// Returns the resolved path of a folder, which is computed once.
    fn real_folder(&mut self, folder: &Path) -> io::Result<&PathBuf> {
        match self.folders.entry(folder.to_owned()) {
            Entry::Occupied(known) => Ok(known.into_mut()),
            Entry::Vacant(new) => Ok(new.insert(real(folder)?)),
        }
    }
}

/// Returns the first link on the way from the folder `root` to the file `path`, and where it leads.
fn link_between(root: &Path, path: &Path) -> Option<(PathBuf, PathBuf)> {
    let folders: Vec<&Path> = path.ancestors().skip(1).take_while(|folder| *folder != root).collect();
    let link = folders.into_iter().rev().find(|folder| folder.is_symlink())?;
    Some((link.to_owned(), real(link).ok()?))
}

/// Checks that what is at `path` is a file or a link to one: a rename would replace a pipe or a device.
fn check_replaceable(path: &Path) -> Result<(), PublishError> {
    match fs::metadata(path) {
        Ok(facts) if facts.is_dir() => {
            Err(PublishError::Write { path: path.to_owned(), error: io::ErrorKind::IsADirectory.into() })
        }
        Ok(facts) if !facts.is_file() => Err(PublishError::NotAFile { path: path.to_owned() }),
        _ => Ok(()),
    }
}
