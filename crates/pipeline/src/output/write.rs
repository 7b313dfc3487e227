//! Writes of a file whole or not at all: under a temporary name in its folder, synced, then renamed.

use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, TempPath};

use super::error::PublishError;
use super::sweep::UNFINISHED;
use crate::digest::Digest;
use crate::input_file::open_file;

/// A file that is written but not published. Dropping this value removes the file.
#[derive(Debug)]
pub struct Staged {
    path: PathBuf,
    temporary: TempPath,
    is_new: bool,
}

impl Staged {
    /// Writes `bytes` under a temporary name into the folder of `path`, synced to the disk, and makes that folder.
    pub(super) fn new(path: &Path, bytes: &[u8]) -> io::Result<Self> {
        make_folder(folder_of(path))?;
        let temporary = write_beside(path, bytes, true)?;
        Ok(Self { path: path.to_owned(), temporary, is_new: fs::symlink_metadata(path).is_err() })
    }

    /// Copies `from` under a temporary name into the folder of `path`, synced to the disk, if its digest is `blake3`.
    pub(super) fn copy(path: &Path, from: &Path, blake3: Digest) -> Result<Option<Self>, PublishError> {
        let unreadable = |error| PublishError::Copy { path: from.to_owned(), error };
        let unwritable = |error| PublishError::Write { path: path.to_owned(), error };
        let (mut source, _) = open_file(from).map_err(unreadable)?;
        make_folder(folder_of(path)).map_err(unwritable)?;
        let mut file = temporary().tempfile_in(folder_of(path)).map_err(unwritable)?;
        let (mut hasher, mut block) = (blake3::Hasher::new(), vec![0; COPIED_AT_ONCE]);
        loop {
            match source.read(&mut block) {
                Ok(0) => break,
                Ok(length) => {
                    hasher.update(&block[..length]);
                    file.write_all(&block[..length]).map_err(unwritable)?;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(unreadable(error)),
            }
        }
        if Digest::from(hasher.finalize()) != blake3 {
            return Ok(None);
        }
        file.as_file().sync_all().map_err(unwritable)?;
        let is_new = fs::symlink_metadata(path).is_err();
        Ok(Some(Self { path: path.to_owned(), temporary: file.into_temp_path(), is_new }))
    }

    /// Renames the file to its path. Returns the path if no file existed there.
    fn publish(self) -> Result<Option<PathBuf>, PublishError> {
        let Self { path, temporary, is_new } = self;
        match temporary.persist(&path) {
            Ok(()) => Ok(is_new.then_some(path)),
            Err(error) => Err(PublishError::Write { path, error: error.error }),
        }
    }
}

/// Bytes of a copy that are in memory at the same time.
const COPIED_AT_ONCE: usize = 256 << 10;

/// Publishes staged files, and `last` after all others are on the disk.
///
/// # Errors
/// [`PublishError::Write`]. New files are removed again.
pub(super) fn publish(files: Vec<Staged>, last: Option<Staged>) -> Result<(), PublishError> {
    let mut made = Vec::new();
    let published = publish_in_order(files, last, &mut made);
    if published.is_err() {
        made.iter().for_each(|path| drop(fs::remove_file(path)));
    }
    published
}

fn publish_in_order(files: Vec<Staged>, last: Option<Staged>, made: &mut Vec<PathBuf>) -> Result<(), PublishError> {
    let mut folders: Vec<PathBuf> = files.iter().map(|file| folder_of(&file.path).to_owned()).collect();
    folders.sort();
    folders.dedup();
    for file in files {
        made.extend(file.publish()?);
    }
    let synced = |folder: PathBuf| sync_folder(&folder).map_err(|error| PublishError::Write { path: folder, error });
    folders.into_iter().try_for_each(synced)?;
    let Some(last) = last else { return Ok(()) };
    let folder = folder_of(&last.path).to_owned();
    made.extend(last.publish()?);
    synced(folder)
}

/// Writes a file whole or not at all, without syncing: readers verify the file, so a power failure may lose it.
pub(super) fn write_unsynced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(folder_of(path))?;
    Ok(write_beside(path, bytes, false)?.persist(path)?)
}

/// Writes a new file whole or not at all, into an existing folder.
pub(super) fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_beside(path, bytes, true)?.persist_noclobber(path)?;
    sync_folder(folder_of(path))
}

fn write_beside(path: &Path, bytes: &[u8], is_synced: bool) -> io::Result<TempPath> {
    let mut file = temporary().tempfile_in(folder_of(path))?;
    file.write_all(bytes)?;
    if is_synced {
        file.as_file().sync_all()?;
    }
    Ok(file.into_temp_path())
}

/// Returns a builder of temporary files with the permissions of outputs: crate `tempfile` makes files that only their
/// user may read, but the umask decides who may read an output.
fn temporary() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(UNFINISHED);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
}

/// Makes `folder` and the folders above it, and syncs their names to the disk.
fn make_folder(folder: &Path) -> io::Result<()> {
    let missing: Vec<&Path> = folder.ancestors().take_while(|folder| is_named(folder) && !folder.exists()).collect();
    fs::create_dir_all(folder)?;
    missing.iter().rev().try_for_each(|made| sync_folder(folder_of(made)))
}

/// Returns the folder of `path`.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| is_named(folder)).unwrap_or(Path::new("."))
}

fn is_named(folder: &Path) -> bool {
    !folder.as_os_str().is_empty()
}

/// Syncs the names in `folder` to the disk: otherwise a power failure may lose a renamed file.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    use io::ErrorKind as Kind;
    match fs::File::open(folder).and_then(|folder| folder.sync_all()) {
        // Some network file systems cannot sync folders, and a folder without read permission cannot be opened.
        Err(error) if matches!(error.kind(), Kind::InvalidInput | Kind::Unsupported | Kind::PermissionDenied) => Ok(()),
        result => result,
    }
}

/// Does nothing, since Windows syncs names by itself and does not open folders.
#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}
