//! The folder of a cache: `jobs/<id>` and `blobs/<digest>`, in folders by their first two digits.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use walkdir::WalkDir;

use super::entry::{Entry, Stored};
use super::error::CacheError;
use crate::bake::write_unsynced;
use crate::digest::digest;
use crate::input_file::{open_file, read_file};

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

    /// The outputs of the job `id`, if it was run.
    ///
    /// # Errors
    /// [`CacheError`] where the entry is there but of no use.
    pub fn entry(&self, id: &str) -> Result<Option<Entry>, CacheError> {
        let path = self.path("jobs", id);
        let Some(bytes) = read(&path)? else { return Ok(None) };
        Entry::parse(&bytes).map(Some).ok_or_else(|| dropped(path))
    }

    /// The bytes of a blob, if it is there.
    ///
    /// # Errors
    /// [`CacheError`] where they are not what they were.
    pub fn blob(&self, name: &str) -> Result<Option<Vec<u8>>, CacheError> {
        let path = self.path("blobs", name);
        match read(&path)? {
            Some(bytes) if digest(&bytes) == name => Ok(Some(bytes)),
            Some(_) => Err(dropped(path)),
            None => Ok(None),
        }
    }

    /// Stores `entry` of the job `id`; its blobs come first.
    ///
    /// # Errors
    /// [`CacheError::Io`].
    pub fn put_entry(&self, id: &str, entry: &Entry) -> Result<(), CacheError> {
        let path = self.path("jobs", id);
        let text = entry.to_bytes().map_err(|e| failed(&path)(e.into()))?;
        write_unsynced(&path, &text).map_err(failed(&path))
    }

    /// Stores the bytes of `stored`, also over a blob that is there: it may be damaged.
    ///
    /// # Errors
    /// [`CacheError::Io`].
    pub fn put_blob(&self, stored: &Stored, bytes: &[u8]) -> Result<(), CacheError> {
        let path = self.path("blobs", &stored.blake3);
        write_unsynced(&path, bytes).map_err(failed(&path))
    }

    /// Marks the entry of the job `id` and its blobs as used, unless that was done within the hour: a run that has nothing
    /// to do would write more than it reads.
    pub fn touch(&self, id: &str, entry: &Entry) {
        let now = SystemTime::now();
        let marked = fs::metadata(self.path("jobs", id)).and_then(|facts| facts.modified());
        if marked.is_ok_and(|marked| now.duration_since(marked).is_ok_and(|age| age < MARK_AGE)) {
            return;
        }
        let blobs = entry.stored().map(|stored| self.path("blobs", &stored.blake3));
        for path in blobs.chain([self.path("jobs", id)]) {
            // Only the order of eviction depends on it.
            let _ = open_file(&path).and_then(|(file, _)| file.set_modified(now));
        }
    }

    /// Removes what was not used for longest until at most `limit` bytes are left.
    ///
    /// # Errors
    /// [`CacheError::Io`] where the folder cannot be listed.
    pub fn trim(&self, limit: u64) -> Result<(), CacheError> {
        let mut files = Vec::new();
        for kind in ["jobs", "blobs"].map(|kind| self.root.join(kind)).iter().filter(|kind| kind.exists()) {
            for entry in WalkDir::new(kind) {
                // Other processes remove files too.
                let Ok(entry) = entry else { continue };
                let Ok(facts) = entry.metadata() else { continue };
                if facts.is_file() {
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

    fn path(&self, kind: &str, digest: &str) -> PathBuf {
        self.root.join(kind).join(digest.get(..2).unwrap_or("")).join(digest)
    }
}

/// How exactly the order of eviction is known.
const MARK_AGE: Duration = Duration::from_secs(3600);

fn read(path: &Path) -> Result<Option<Vec<u8>>, CacheError> {
    match read_file(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(failed(path)(error)),
    }
}

fn dropped(path: PathBuf) -> CacheError {
    let _ = fs::remove_file(&path);
    CacheError::Damaged { path }
}

fn failed(path: &Path) -> impl Fn(io::Error) -> CacheError {
    let path = path.to_owned();
    move |error| CacheError::Io { path: path.clone(), error }
}

#[cfg(test)]
mod tests;
