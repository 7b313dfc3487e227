//! Writing what was baked: beside its place, synced, then renamed, so that nothing half-written is ever visible.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::digest::Digest;
use crate::input_file::{check_file, open_file};

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
    /// Two outputs whose names differ in case only.
    #[error(
        "expected names that differ in more than case, found {} and {}, which are one file on Windows and macOS; rename one of \
         them, or bake them into different folders",
        path.display(), other.display()
    )]
    SameName {
        /// The later output.
        path: PathBuf,
        /// The earlier one.
        other: PathBuf,
    },
    /// An output would take the place of an input.
    #[error("expected an output folder apart from the sources, found that {} is a source; choose another with -o", path.display())]
    OverSource {
        /// The file.
        path: PathBuf,
    },
}

/// Where the outputs of a run are.
#[derive(Debug, Default)]
pub struct Places {
    /// Each output by its path in lower case.
    taken: HashMap<PathBuf, Taken>,
    /// Folders without links and dots.
    folders: HashMap<PathBuf, PathBuf>,
}

/// An output of a run.
#[derive(Debug)]
struct Taken {
    /// Where it is.
    path: PathBuf,
    /// The source that it is a copy of, or itself.
    source: PathBuf,
}

/// Returns `path` in lower case, by which file systems that ignore case know it. Names that are not UTF-8 stay as they are,
/// and letters that Unicode writes in two ways (NFC and NFD) stay two.
pub fn case_folded(path: &Path) -> PathBuf {
    let folded =
        |name: &std::ffi::OsStr| name.to_str().map_or_else(|| name.to_owned(), |name| name.to_lowercase().into());
    path.components().map(|part| -> OsString { folded(part.as_os_str()) }).collect()
}

impl Places {
    /// Returns whether an output of this run is at `path`, or would be on a file system that ignores case.
    pub fn is_taken(&self, path: &Path) -> bool {
        self.taken.contains_key(&case_folded(path))
    }

    /// Keeps `path` for a copy of `source`, or for the output itself, which is there from an earlier run; whether it is free.
    pub fn hold(&mut self, path: &Path, source: &Path) -> bool {
        self.take(path, source.to_owned()).is_ok()
    }

    /// Takes a place for a copy of `source`, or for the output itself.
    fn take(&mut self, path: &Path, source: PathBuf) -> Result<(), PublishError> {
        match self.taken.entry(case_folded(path)) {
            Entry::Occupied(taken) if !is_same_file(&taken.get().source, &source) => {
                let (path, taken) = (path.to_owned(), taken.get());
                Err(if taken.path == path {
                    PublishError::SamePlace { path, other: taken.source.clone() }
                } else {
                    PublishError::SameName { path, other: taken.path.clone() }
                })
            }
            Entry::Occupied(_) => Ok(()),
            Entry::Vacant(free) => {
                free.insert(Taken { path: path.to_owned(), source });
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

/// Writes a file whole or not at all, making its folder.
///
/// # Errors
/// [`PublishError::Write`].
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), PublishError> {
    let written = put(path, true, |file| file.write_all(bytes).map(|()| true));
    written.map_err(|error| PublishError::Write { path: path.to_owned(), error })
}

/// Copies `from` to `to`, whole or not at all, if the BLAKE3 of its bytes in hex is `blake3`; returns whether it is. The file
/// is read once, and hashed on the way.
///
/// # Errors
/// [`PublishError::Copy`] and [`PublishError::Write`].
pub fn copy_file(from: &Path, to: &Path, blake3: Digest) -> Result<bool, PublishError> {
    let unreadable = |error| PublishError::Copy { path: from.to_owned(), error };
    let (mut source, _) = open_file(from).map_err(unreadable)?;
    let mut is_expected = Ok(false);
    let written = put(to, true, |file| {
        let (mut hasher, mut block) = (blake3::Hasher::new(), vec![0; COPIED_AT_ONCE]);
        is_expected = loop {
            match source.read(&mut block) {
                Ok(0) => break Ok(Digest::from(hasher.finalize()) == blake3),
                Ok(length) => {
                    hasher.update(&block[..length]);
                    file.write_all(&block[..length])?;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => break Err(error),
            }
        };
        Ok(matches!(is_expected, Ok(true)))
    });
    written.map_err(|error| PublishError::Write { path: to.to_owned(), error })?;
    is_expected.map_err(unreadable)
}

/// Bytes of a copy that are in memory at a time.
const COPIED_AT_ONCE: usize = 256 << 10;

/// The same for what is verified when it is read: it need not survive the machine.
///
/// # Errors
/// The system's.
pub fn write_unsynced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    put(path, false, |file| file.write_all(bytes).map(|()| true))
}

/// Lets `fill` write a file beside `path`, and renames it into place if `fill` says so.
fn put(path: &Path, is_synced: bool, fill: impl FnOnce(&mut File) -> io::Result<bool>) -> io::Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let mut file = tempfile::Builder::new().prefix(UNFINISHED).tempfile_in(folder)?;
    if !fill(file.as_file_mut())? {
        return Ok(());
    }
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
pub fn sweep(folder: &Path) {
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
