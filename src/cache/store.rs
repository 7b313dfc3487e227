//! A folder, a store that machines share, or the one in front of the other.

use std::path::Path;
use std::sync::Arc;

use super::entry::{Entry, Fits, Stored};
use super::error::CacheError;
use super::folder::Folder;
use super::shared::Shared;
use crate::bake::Baked;
use crate::digest::Digest;

/// A cache. What is found in the store is kept in the folder, and what is baked is put into both.
#[derive(Clone, Debug, Default)]
pub struct Cache {
    folder: Option<Folder>,
    shared: Option<Arc<Shared>>,
    /// Largest size of the folder.
    limit: u64,
}

/// Who is told what is wrong.
pub type Warn<'w> = &'w mut dyn FnMut(CacheError);

impl Cache {
    /// The cache in `folder` with at most `limit` bytes, the store at `url`, or both. Neither is asked anything yet.
    ///
    /// # Errors
    /// [`CacheError`] where `url` names no store, or its settings in the environment are wrong.
    pub fn new(folder: Option<&Path>, url: Option<&str>, limit: u64) -> Result<Self, CacheError> {
        Ok(Self { folder: folder.map(Folder::new), shared: url.map(Shared::open).transpose()?.map(Arc::new), limit })
    }

    /// The folder, if there is one.
    pub fn folder(&self) -> Option<&Folder> {
        self.folder.as_ref()
    }

    /// The same with `folder` in front of the store.
    pub fn with_folder(self, folder: &Path) -> Self {
        Self { folder: Some(Folder::new(folder)), ..self }
    }

    /// Returns the outputs of the job `id`, if it was run. `fits` says whether an entry is of the job; what is not is dropped.
    pub fn entry(&self, id: Digest, fits: Fits<'_>, warn: Warn<'_>) -> Option<Entry> {
        if let Some(folder) = &self.folder
            && let Some(entry) = or_warn(folder.entry(id, fits), warn)
        {
            return Some(entry);
        }
        let entry = or_warn(self.shared.as_ref()?.entry(id, fits), warn)?;
        if let Some(folder) = &self.folder {
            warned(folder.put_entry(&entry), warn);
        }
        Some(entry)
    }

    /// The bytes of each of `wanted`, if all are there.
    pub fn blobs(&self, wanted: &[&Stored], warn: Warn<'_>) -> Option<Vec<Vec<u8>>> {
        let mut blobs = vec![None; wanted.len()];
        if let Some(folder) = &self.folder {
            for (blob, stored) in blobs.iter_mut().zip(wanted) {
                *blob = or_warn(folder.blob(stored), warn);
                if blob.is_none() && self.shared.is_none() {
                    return None;
                }
            }
        }
        if let Some(shared) = &self.shared {
            let missing: Vec<&Stored> =
                wanted.iter().zip(&blobs).filter(|(_, b)| b.is_none()).map(|(s, _)| *s).collect();
            let mut found = shared.blobs(&missing).into_iter();
            for (blob, stored) in blobs.iter_mut().zip(wanted).filter(|(blob, _)| blob.is_none()) {
                *blob = found.next().and_then(|found| or_warn(found, warn));
                if let (Some(folder), Some(bytes)) = (&self.folder, &blob) {
                    warned(folder.put_blob(stored, bytes), warn);
                }
            }
        }
        blobs.into_iter().collect()
    }

    /// Stores `entry` of what its job `baked`: blobs first, so that an entry's blobs are there.
    pub fn put(&self, entry: &Entry, baked: &Baked, warn: Warn<'_>) {
        let blobs: Vec<&[u8]> =
            baked.files.iter().map(|file| file.bytes.as_slice()).chain([baked.document.as_slice()]).collect();
        if let Some(folder) = &self.folder {
            let put = entry.stored().zip(&blobs).try_for_each(|(stored, bytes)| folder.put_blob(stored, bytes));
            warned(put.and_then(|()| folder.put_entry(entry)), warn);
        }
        if let Some(shared) = &self.shared {
            warned(shared.put(entry, &blobs), warn);
        }
    }

    /// Puts what the folder has of the job of `entry` into the store, too.
    pub fn share(&self, entry: &Entry, warn: Warn<'_>) {
        let (Some(folder), Some(shared)) = (&self.folder, &self.shared) else { return };
        let blobs: Option<Vec<Vec<u8>>> = entry.stored().map(|stored| or_warn(folder.blob(stored), warn)).collect();
        if let Some(blobs) = blobs {
            warned(shared.put(entry, &blobs.iter().map(Vec::as_slice).collect::<Vec<_>>()), warn);
        }
    }

    /// Marks `entry` and its blobs as used.
    pub fn touch(&self, entry: &Entry) {
        if let Some(folder) = &self.folder {
            folder.touch(entry);
        }
    }

    /// Removes from the folder what was not used for longest until it has its size. What the store keeps is its own matter.
    pub fn trim(&self, warn: Warn<'_>) {
        if let Some(folder) = &self.folder {
            warned(folder.trim(self.limit), warn);
        }
    }
}

/// What was found; `warn` is told why nothing was.
fn or_warn<T>(found: Result<Option<T>, CacheError>, warn: Warn<'_>) -> Option<T> {
    found.unwrap_or_else(|error| {
        warn(error);
        None
    })
}

fn warned(result: Result<(), CacheError>, warn: Warn<'_>) {
    if let Err(error) = result {
        warn(error);
    }
}
