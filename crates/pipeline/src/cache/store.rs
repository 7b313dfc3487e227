//! A cache of two levels: the disk cache, the object-store cache, or the first in front of the second.

use std::path::Path;
use std::sync::Arc;

use super::disk::DiskCache;
use super::entry::{Entry, Fits, Stored};
use super::error::CacheError;
use super::object_store::ObjectStoreCache;
use crate::bake::BakedAsset;
use crate::digest::Digest;

/// A cache. Outputs found in the object store are copied to the disk cache, and baked outputs are stored in both.
#[derive(Clone, Debug, Default)]
pub struct Cache {
    disk: Option<DiskCache>,
    object_store: Option<Arc<ObjectStoreCache>>,
    /// Largest size of the disk cache, in bytes.
    limit: u64,
}

/// Receives warnings of a cache.
pub type Warn<'w> = &'w mut dyn FnMut(CacheError);

impl Cache {
    /// Opens the disk cache in `folder` with at most `limit` bytes, the object store at `url`, or both. Sends no
    /// request.
    ///
    /// # Errors
    /// [`CacheError`] if `url` does not name a store, or if the settings of the store in the environment are wrong.
    pub fn new(folder: Option<&Path>, url: Option<&str>, limit: u64) -> Result<Self, CacheError> {
        let object_store = url.map(ObjectStoreCache::open).transpose()?.map(Arc::new);
        Ok(Self { disk: folder.map(DiskCache::new), object_store, limit })
    }

    /// Returns the disk cache, if there is one.
    pub fn disk(&self) -> Option<&DiskCache> {
        self.disk.as_ref()
    }

    /// Returns this cache with a disk cache in `folder` in front of the object store.
    pub fn with_disk(self, folder: &Path) -> Self {
        Self { disk: Some(DiskCache::new(folder)), ..self }
    }

    /// Returns the outputs of the job `id`, if the job was run. `fits` checks that the entry has the outputs of the
    /// job; other entries are removed.
    pub fn entry(&self, id: Digest, fits: Fits<'_>, warn: Warn<'_>) -> Option<Entry> {
        if let Some(disk) = &self.disk
            && let Some(entry) = or_warn(disk.entry(id, fits), warn)
        {
            return Some(entry);
        }
        let entry = or_warn(self.object_store.as_ref()?.entry(id, fits), warn)?;
        if let Some(disk) = &self.disk {
            warn_of(disk.put_entry(&entry), warn);
        }
        Some(entry)
    }

    /// Returns the bytes of each of `wanted`, if the cache has all of them.
    pub fn blobs(&self, wanted: &[&Stored], warn: Warn<'_>) -> Option<Vec<Vec<u8>>> {
        let mut blobs = vec![None; wanted.len()];
        if let Some(disk) = &self.disk {
            for (blob, stored) in blobs.iter_mut().zip(wanted) {
                *blob = or_warn(disk.blob(stored), warn);
                if blob.is_none() && self.object_store.is_none() {
                    return None;
                }
            }
        }
        if let Some(object_store) = &self.object_store {
            let missing: Vec<&Stored> =
                wanted.iter().zip(&blobs).filter(|(_, b)| b.is_none()).map(|(s, _)| *s).collect();
            let mut found = object_store.blobs(&missing).into_iter();
            for (blob, stored) in blobs.iter_mut().zip(wanted).filter(|(blob, _)| blob.is_none()) {
                *blob = found.next().and_then(|found| or_warn(found, warn));
                if let (Some(disk), Some(bytes)) = (&self.disk, &blob) {
                    warn_of(disk.put_blob(stored, bytes), warn);
                }
            }
        }
        blobs.into_iter().collect()
    }

    /// Stores `entry` and the outputs of its job, which was `baked`. Blobs are stored first, so that an entry's blobs
    /// exist.
    pub fn put(&self, entry: &Entry, baked: &BakedAsset, warn: Warn<'_>) {
        let blobs: Vec<&[u8]> =
            baked.files.iter().map(|file| file.bytes.as_slice()).chain([baked.document.as_slice()]).collect();
        if let Some(disk) = &self.disk {
            let put = entry.stored().zip(&blobs).try_for_each(|(stored, bytes)| disk.put_blob(stored, bytes));
            warn_of(put.and_then(|()| disk.put_entry(entry)), warn);
        }
        if let Some(object_store) = &self.object_store {
            warn_of(object_store.put(entry, &blobs), warn);
        }
    }

    /// Copies the outputs of the job of `entry` from the disk cache to the object store.
    pub fn share(&self, entry: &Entry, warn: Warn<'_>) {
        let (Some(disk), Some(object_store)) = (&self.disk, &self.object_store) else { return };
        let blobs: Option<Vec<Vec<u8>>> = entry.stored().map(|stored| or_warn(disk.blob(stored), warn)).collect();
        if let Some(blobs) = blobs {
            warn_of(object_store.put(entry, &blobs.iter().map(Vec::as_slice).collect::<Vec<_>>()), warn);
        }
    }

    /// Marks `entry` and its blobs as used in the disk cache.
    pub fn touch(&self, entry: &Entry) {
        if let Some(disk) = &self.disk {
            disk.touch(entry);
        }
    }

    /// Removes the least recently used files of the disk cache until it has at most its largest size. Object stores
    /// have their own rules of removal.
    pub fn trim(&self, warn: Warn<'_>) {
        if let Some(disk) = &self.disk {
            warn_of(disk.trim(self.limit), warn);
        }
    }
}

/// Returns the result, or passes its error to `warn` and returns `None`.
fn or_warn<T>(found: Result<Option<T>, CacheError>, warn: Warn<'_>) -> Option<T> {
    found.unwrap_or_else(|error| {
        warn(error);
        None
    })
}

fn warn_of(result: Result<(), CacheError>, warn: Warn<'_>) {
    if let Err(error) = result {
        warn(error);
    }
}
