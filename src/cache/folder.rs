//! The folder of a cache: `jobs/<id>` and `blobs/<digest>`, in folders by their first two digits.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use walkdir::WalkDir;

use super::entry::{Entry, Fits, MAX_ENTRY_BYTES, Stored, Unusable};
use super::error::CacheError;
use crate::digest::{Digest, digest};
use crate::input_file::{check_file, open_file, read_file};
use crate::output::{OutputPath, is_abandoned};

/// A cache in a folder.
#[derive(Clone, Debug)]
pub struct Folder {
    root: PathBuf,
}

impl Folder {
    /// The cache in `root`, which is made when something is stored.
    pub fn new(root: &Path) -> Self {
        Self { root: root.to_owned() }
    }

    /// Returns the outputs of the job `id`, if it was run. `fits` says whether an entry is of the job.
    ///
    /// # Errors
    /// [`CacheError`] where the entry is there but of no use; then it is dropped.
    pub fn entry(&self, id: Digest, fits: Fits<'_>) -> Result<Option<Entry>, CacheError> {
        self.read("jobs", id, MAX_ENTRY_BYTES, |bytes| Entry::read(&bytes, id, fits))
    }

    /// Returns the bytes of a blob, if it is there.
    ///
    /// # Errors
    /// [`CacheError`] where they are not what was `stored`; then the blob is dropped.
    pub fn blob(&self, stored: &Stored) -> Result<Option<Vec<u8>>, CacheError> {
        self.read("blobs", stored.blake3, stored.bytes, |bytes| {
            if digest(&bytes) == stored.blake3 { Ok(Some(bytes)) } else { Err(Unusable::Damaged) }
        })
    }

    /// Returns what `parse` makes of a file of at most `limit` bytes, and removes a file that is of no use. (What is removed
    /// lies where `name` says. Of a link the link itself is removed, and not what it leads to.)
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

    /// Stores `entry`; its blobs come first.
    ///
    /// # Errors
    /// [`CacheError::Io`].
    pub fn put_entry(&self, entry: &Entry) -> Result<(), CacheError> {
        let path = self.path("jobs", entry.job);
        let text = entry.to_bytes().map_err(|e| failed(&path)(e.into()))?;
        self.write(&path, &text)
    }

    /// Stores the bytes of `stored`, also over a blob that is there: it may be damaged.
    ///
    /// # Errors
    /// [`CacheError::Io`].
    pub fn put_blob(&self, stored: &Stored, bytes: &[u8]) -> Result<(), CacheError> {
        let path = self.path("blobs", stored.blake3);
        self.write(&path, bytes)
    }

    /// Marks `entry` and its blobs as used, unless that was done within the hour: a run that has nothing to do would write
    /// more than it reads.
    pub fn touch(&self, entry: &Entry) {
        let now = SystemTime::now();
        let own = self.path("jobs", entry.job);
        let marked = fs::metadata(&own).and_then(|facts| facts.modified());
        if marked.is_ok_and(|marked| now.duration_since(marked).is_ok_and(|age| age < MARK_AGE)) {
            return;
        }
        let blobs = entry.stored().map(|stored| self.path("blobs", stored.blake3));
        // A pipe would be waited for.
        for path in blobs.chain([own]).filter(|path| check_file(path).is_ok()) {
            // Only the order of eviction depends on it.
            let _ = open_file(&path).and_then(|(file, _)| file.set_modified(now));
        }
    }

    /// Removes what killed runs left half written, and what was not used for longest until at most `limit` bytes are left. Files
    /// that no cache writes stay, and do not count.
    ///
    /// # Errors
    /// [`CacheError::Io`] where the folder cannot be listed.
    pub fn trim(&self, limit: u64) -> Result<(), CacheError> {
        let mut files = Vec::new();
        for kind in ["jobs", "blobs"].map(|kind| self.root.join(kind)).iter().filter(|kind| kind.exists()) {
            // A link would lead to files that are none of the cache.
            for entry in WalkDir::new(kind).follow_root_links(false).min_depth(1).max_depth(2) {
                // Other processes remove files too.
                let Ok(entry) = entry else { continue };
                let Ok(facts) = entry.metadata() else { continue };
                if is_abandoned(entry.file_name(), &facts) {
                    let _ = fs::remove_file(entry.path());
                } else if facts.is_file() && is_of_cache(entry.path()) {
                    let used = facts.modified().map_err(failed(entry.path()))?;
                    files.push((used, entry.into_path(), facts.len()));
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
        OutputPath::below(&self.root, path).and_then(|place| place.write_unsynced(bytes)).map_err(failed(path))
    }

    fn path(&self, kind: &str, digest: Digest) -> PathBuf {
        self.root.join(kind).join(format!("{digest:.2}")).join(digest.to_string())
    }
}

/// Whether the name of a file, and of its folder, are those that a digest gives them, or the file was not finished.
fn is_of_cache(path: &Path) -> bool {
    let name = |path: &Path| path.file_name().and_then(|name| name.to_str()).map(str::to_owned);
    let (Some(file), Some(folder)) = (name(path), path.parent().and_then(name)) else { return false };
    file.parse::<Digest>().is_ok_and(|digest| format!("{digest:.2}") == folder)
}

/// How exactly the order of eviction is known.
const MARK_AGE: Duration = Duration::from_secs(3600);

fn failed(path: &Path) -> impl Fn(io::Error) -> CacheError {
    let path = path.to_owned();
    move |error| CacheError::Io { path: path.clone(), error }
}

#[cfg(test)]
mod tests;
