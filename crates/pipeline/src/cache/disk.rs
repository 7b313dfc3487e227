//! The disk cache: files `jobs/<id>` and `blobs/<digest>`, in subfolders named by their first two digits.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use walkdir::WalkDir;

use super::entry::{Entry, Fits, MAX_ENTRY_BYTES, Stored, Unusable, absent};
use super::error::CacheError;
use crate::digest::{Digest, digest};
use crate::input_file::{check_file, open_file, read_file};
use crate::output::{OutputPath, is_abandoned};

/// A cache in a folder of the disk.
#[derive(Clone, Debug)]
pub struct DiskCache {
    root: PathBuf,
}

impl DiskCache {
    /// Returns the cache in `root`. The folder is created when something is stored.
    pub fn new(root: &Path) -> Self {
        Self { root: root.to_owned() }
    }

    /// Returns the outputs of the job `id`, if the job was run. `fits` checks that the entry has the outputs of the
    /// job.
    ///
    /// # Errors
    /// [`CacheError`] if the entry is unusable. The entry is then removed.
    pub fn entry(&self, id: Digest, fits: Fits<'_>) -> Result<Option<Entry>, CacheError> {
        self.read("jobs", id, MAX_ENTRY_BYTES, |bytes| Entry::read(&bytes, id, fits).map(Some).or_else(absent))
    }

    /// Returns the bytes of a blob, if the cache has it.
    ///
    /// # Errors
    /// [`CacheError`] if the bytes are not those of `stored`. The blob is then removed.
    pub fn blob(&self, stored: &Stored) -> Result<Option<Vec<u8>>, CacheError> {
        self.read("blobs", stored.blake3, stored.bytes, |bytes| {
            if digest(&bytes) == stored.blake3 { Ok(Some(bytes)) } else { Err(Unusable::Damaged) }
        })
    }

    /// Reads a file of at most `limit` bytes with `parse`, and removes the file if it is unusable. Only files whose
    /// path a digest names are removed. If such a path is a link, the link itself is removed, not its target.
    fn read<T>(
        &self,
        kind: &str,
        name: Digest,
        limit: u64,
        parse: impl Fn(Vec<u8>) -> Result<Option<T>, Unusable>,
    ) -> Result<Option<T>, CacheError> {
        let path = self.path(kind, name);
        let bytes = match check_file(&path) {
            Ok(length) if length > limit => Err(Unusable::Damaged),
            Ok(_) => Ok(read_file(&path).map_err(failed(&path))?),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(failed(&path)(error)),
        };
        bytes.and_then(parse).map_err(|unusable| {
            let _ = fs::remove_file(&path);
            match unusable {
                Unusable::Damaged => CacheError::Damaged { path },
                found => CacheError::Foreign { place: path.display().to_string(), found },
            }
        })
    }

    /// Stores `entry`, whose blobs must be stored before.
    ///
    /// # Errors
    /// [`CacheError::Io`].
    pub fn put_entry(&self, entry: &Entry) -> Result<(), CacheError> {
        let path = self.path("jobs", entry.job);
        let text = entry.to_bytes().map_err(|e| failed(&path)(e.into()))?;
        self.write(&path, &text)
    }

    /// Stores the bytes of `stored`. A blob that exists is replaced, since it may be damaged.
    ///
    /// # Errors
    /// [`CacheError::Io`].
    pub fn put_blob(&self, stored: &Stored, bytes: &[u8]) -> Result<(), CacheError> {
        let path = self.path("blobs", stored.blake3);
        self.write(&path, bytes)
    }

    /// Marks `entry` and its blobs as used, unless they were marked within the hour. Without this limit, a run that has
    /// nothing to bake would write more than it reads.
    pub fn touch(&self, entry: &Entry) {
        let now = SystemTime::now();
        let entry_path = self.path("jobs", entry.job);
        let marked = fs::metadata(&entry_path).and_then(|metadata| metadata.modified());
        if marked.is_ok_and(|marked| now.duration_since(marked).is_ok_and(|age| age < MARK_AGE)) {
            return;
        }
        let blobs = entry.stored().map(|stored| self.path("blobs", stored.blake3));
        // Opening a pipe would wait, so only ordinary files are opened.
        for path in blobs.chain([entry_path]).filter(|path| check_file(path).is_ok()) {
            // An error is ignored, because it affects only the order of eviction.
            let _ = open_file(&path).and_then(|(file, _)| file.set_modified(now));
        }
    }

    /// Removes unfinished files of killed runs. Then removes the least recently used files until at most `limit` bytes
    /// are left. Files that no cache writes stay, and do not count.
    ///
    /// # Errors
    /// [`CacheError::Io`] if the folder cannot be listed.
    pub fn trim(&self, limit: u64) -> Result<(), CacheError> {
        let mut files = Vec::new();
        for kind in ["jobs", "blobs"].map(|kind| self.root.join(kind)).iter().filter(|kind| kind.exists()) {
            // The target of a link is not part of the cache.
            for entry in WalkDir::new(kind).follow_root_links(false).min_depth(1).max_depth(2) {
                // Other processes remove files too.
                let Ok(entry) = entry else { continue };
                let Ok(metadata) = entry.metadata() else { continue };
                if is_abandoned(entry.file_name(), &metadata) {
                    let _ = fs::remove_file(entry.path());
                } else if metadata.is_file() && is_cache_file(entry.path()) {
                    let used = metadata.modified().map_err(failed(entry.path()))?;
                    files.push((used, entry.into_path(), metadata.len()));
                }
            }
        }
        files.sort();
        let mut total: u64 = files.iter().map(|(_, _, length)| length).sum();
        for (_, path, length) in files {
            if total <= limit {
                break;
            }
            let _ = fs::remove_file(path);
            total -= length;
        }
        Ok(())
    }

    fn write(&self, path: &Path, bytes: &[u8]) -> Result<(), CacheError> {
        OutputPath::below(&self.root, path).and_then(|output| output.write_unsynced(bytes)).map_err(failed(path))
    }

    fn path(&self, kind: &str, digest: Digest) -> PathBuf {
        self.root.join(kind).join(format!("{digest:.2}")).join(digest.to_string())
    }
}

/// Returns whether the file's name is a digest and its folder's name is the beginning of this digest.
fn is_cache_file(path: &Path) -> bool {
    let name = |path: &Path| path.file_name().and_then(|name| name.to_str()).map(str::to_owned);
    let (Some(file), Some(folder)) = (name(path), path.parent().and_then(name)) else { return false };
    file.parse::<Digest>().is_ok_and(|digest| format!("{digest:.2}") == folder)
}

/// Age after which a file is marked as used again: the precision of the order of eviction.
const MARK_AGE: Duration = Duration::from_secs(3600);

fn failed(path: &Path) -> impl Fn(io::Error) -> CacheError {
    let path = path.to_owned();
    move |error| CacheError::Io { path: path.clone(), error }
}

#[cfg(test)]
mod tests;
