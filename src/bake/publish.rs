//! Writing what was baked: beside its place, synced, then renamed, so that nothing half-written is ever visible.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use rayon::prelude::*;

use super::asset::Baked;
use crate::input_file::{check_file, read_file};

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PublishError {
    /// The file system refused.
    #[error("expected to write {}, found: {error}; free space or choose another output folder", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// A file to be copied cannot be read.
    #[error("expected a readable file at {}, found: {error}; the document refers to it", path.display())]
    Copy {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// Two assets of one run want different files in one place.
    #[error(
        "expected a place of its own for {}, found {} there, which another asset of this run needs; bake them into \
         different folders",
        path.display(), other.display()
    )]
    SamePlace {
        /// The output.
        path: PathBuf,
        /// The file that was copied there before.
        other: PathBuf,
    },
    /// An output would take the place of an input.
    #[error("expected an output folder apart from the sources, found that {} is a source; choose another with -o", path.display())]
    OverSource {
        /// The file.
        path: PathBuf,
    },
}

impl PublishError {
    /// The system's error, if there is one.
    pub fn io(&self) -> Option<&io::Error> {
        match self {
            Self::Write { error, .. } | Self::Copy { error, .. } => Some(error),
            Self::OverSource { .. } | Self::SamePlace { .. } => None,
        }
    }
}

/// Where the outputs of a run are.
#[derive(Debug, Default)]
pub struct Places {
    /// Each output with the source that it is a copy of, or with itself.
    taken: HashMap<PathBuf, PathBuf>,
    /// Folders without links and dots.
    folders: HashMap<PathBuf, PathBuf>,
}

impl Places {
    /// Keeps `path` for a copy of `source`, or for the output itself, which is there from an earlier run; whether it is free.
    pub fn hold(&mut self, path: &Path, source: &Path) -> bool {
        self.take(path, source.to_owned()).is_ok()
    }

    /// Takes a place for a copy of `source`, or for the output itself.
    fn take(&mut self, path: &Path, source: PathBuf) -> Result<(), PublishError> {
        match self.taken.entry(path.to_owned()) {
            Entry::Occupied(taken) if !is_same_file(taken.get(), &source) => {
                Err(PublishError::SamePlace { path: path.to_owned(), other: taken.get().clone() })
            }
            Entry::Occupied(_) => Ok(()),
            Entry::Vacant(free) => {
                free.insert(source);
                Ok(())
            }
        }
    }

    /// `path` without links and dots in its folder, which is looked up once; as it is where there is no such folder.
    fn real(&mut self, path: &Path) -> PathBuf {
        let Some(name) = path.file_name() else { return path.to_owned() };
        let folder = path.parent().unwrap_or(Path::new(""));
        if let Some(real) = self.folders.get(folder) {
            return real.join(name);
        }
        let named = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        match fs::canonicalize(named) {
            Ok(real) => {
                let path = real.join(name);
                self.folders.insert(folder.to_owned(), real);
                path
            }
            Err(_) => path.to_owned(),
        }
    }
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    a == b || matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
}

/// Checks that `files` and `copies` beside `document`, and itself, may be written for the asset `source`, and takes their
/// places for it.
///
/// # Errors
/// [`PublishError`] where an output is a source, or the place of another asset of the run, which `places` remembers.
pub fn claim(
    files: &[&Path],
    copies: &[PathBuf],
    document: &Path,
    source: &Path,
    places: &mut Places,
) -> Result<(), PublishError> {
    let source_folder = source.parent().unwrap_or(Path::new(""));
    let folder = document.parent().unwrap_or(Path::new(""));
    let mut sources: BTreeSet<PathBuf> = BTreeSet::new();
    for path in copies.iter().map(|c| source_folder.join(c)).chain([source.to_owned()]) {
        // What a link names is a source, too. (An output that is a link is replaced, not what it names.)
        if path.is_symlink() {
            sources.extend(fs::canonicalize(&path));
        }
        sources.insert(places.real(&path));
    }
    let outputs = files.iter().copied().chain(copies.iter().map(PathBuf::as_path)).map(|p| folder.join(p));
    for path in outputs.chain([document.to_owned()]) {
        if sources.contains(&places.real(&path)) {
            return Err(PublishError::OverSource { path });
        }
    }
    for copy in copies {
        let path = source_folder.join(copy);
        check_file(&path).map_err(|error| PublishError::Copy { path: path.clone(), error })?;
        let source = places.real(&path);
        places.take(&folder.join(copy), source)?;
    }
    for path in files.iter().map(|f| folder.join(f)).chain([document.to_owned()]) {
        places.take(&path, path.clone())?;
    }
    Ok(())
}

/// Writes `baked` to `document`, and its files beside it. Files that it only refers to are copied from the folder of
/// `source`. The document comes last: whoever sees it sees everything that it names.
///
/// # Errors
/// [`PublishError`]; `source` is never overwritten, nor any file that is copied: see [`claim`].
pub fn publish(baked: &Baked, document: &Path, source: &Path, places: &mut Places) -> Result<(), PublishError> {
    let files: Vec<&Path> = baked.files.iter().map(|file| file.path.as_path()).collect();
    claim(&files, &baked.copies, document, source, places)?;
    let source_folder = source.parent().unwrap_or(Path::new(""));
    let folder = document.parent().unwrap_or(Path::new(""));
    let below: BTreeSet<&Path> = files.iter().filter_map(|file| file.parent()).chain([Path::new("")]).collect();
    below.iter().for_each(|below| sweep(&Path::new(".").join(folder).join(below)));
    for copy in &baked.copies {
        let path = source_folder.join(copy);
        let bytes = read_file(&path).map_err(|error| PublishError::Copy { path, error })?;
        write_file(&folder.join(copy), &bytes)?;
    }
    // Each waits for its own disk blocks. Of all failures the first file's is told.
    let written: Vec<_> =
        baked.files.par_iter().map(|file| write_file(&folder.join(&file.path), &file.bytes)).collect();
    written.into_iter().collect::<Result<(), _>>()?;
    write_file(document, &baked.document)
}

/// Writes a file whole or not at all, making its folder.
///
/// # Errors
/// [`PublishError::Write`].
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), PublishError> {
    put(path, bytes, true).map_err(|error| PublishError::Write { path: path.to_owned(), error })
}

/// The same for what is verified when it is read: it need not survive the machine.
///
/// # Errors
/// The system's.
pub fn write_unsynced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    put(path, bytes, false)
}

fn put(path: &Path, bytes: &[u8], is_synced: bool) -> io::Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let mut file = tempfile::Builder::new().prefix(UNFINISHED).tempfile_in(folder)?;
    file.write_all(bytes)?;
    if is_synced {
        file.as_file().sync_all()?;
    }
    set_ordinary_permissions(file.as_file())?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

/// How names of files begin that are being written.
pub const UNFINISHED: &str = ".roughcast-";

/// Nobody writes on a file for so long: its process was killed.
const UNFINISHED_AGE: Duration = Duration::from_secs(3600);

/// Removes what bakes left in `folder` that were killed while they wrote.
fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_unfinished = entry.file_name().as_encoded_bytes().starts_with(UNFINISHED.as_bytes());
        let modified = || entry.metadata().and_then(|facts| facts.modified()).ok();
        if is_unfinished && modified().and_then(|m| m.elapsed().ok()).is_some_and(|age| age > UNFINISHED_AGE) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Temporary files are private to their user; what is baked is for everyone whom the folder lets in.
#[cfg(unix)]
fn set_ordinary_permissions(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn set_ordinary_permissions(_: &File) -> io::Result<()> {
    Ok(())
}
