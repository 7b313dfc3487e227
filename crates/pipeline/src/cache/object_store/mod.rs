//! The object-store cache, which machines share. Its layout is that of the disk cache: `jobs/<id>` and
//! `blobs/<digest>`, in folders named by their first two digits.
//!
//! Objects are created and never overwritten, so machines need no agreement. Damaged objects are deleted. A store that
//! does not answer causes one warning, and is used again after a pause.

mod health;
mod open;

use std::fmt;

use futures::{StreamExt, TryStreamExt, stream};
use object_store::path::Path as ObjectPath;
use object_store::{Error, ObjectStore, ObjectStoreExt, PutMode, Result as StoreResult};
use tokio::runtime::{Builder, Runtime};

use self::health::Health;
use super::entry::{Entry, Fits, MAX_ENTRY_BYTES, Stored, Unusable, absent};
use super::error::CacheError;
use crate::digest::{Digest, digest};

/// Blobs of a job that are transferred at the same time.
const PARALLEL_BLOBS: usize = 8;

/// A cache in an object store.
pub struct ObjectStoreCache {
    /// The URL of the command line, which has no secrets.
    url: String,
    store: Box<dyn ObjectStore>,
    prefix: ObjectPath,
    runtime: Runtime,
    health: Health,
}

/// Leaves out the store, which holds credentials.
impl fmt::Debug for ObjectStoreCache {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ObjectStoreCache").field("url", &self.url).finish_non_exhaustive()
    }
}

impl ObjectStoreCache {
    /// Opens the store at `url`, with credentials and endpoints from the environment. Sends no request.
    ///
    /// # Errors
    /// [`CacheError::NoStore`].
    pub fn open(url: &str) -> Result<Self, CacheError> {
        let (store, prefix) = open::open(url)?;
        let failed = |error: std::io::Error| CacheError::NoStore { url: url.to_owned(), found: error.to_string() };
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_all().build().map_err(failed)?;
        Ok(Self { url: url.to_owned(), store, prefix, runtime, health: Health::default() })
    }

    /// Returns the outputs of the job `id`, if the job was run. `fits` checks that the entry has the outputs of the
    /// job.
    ///
    /// # Errors
    /// [`CacheError`] if the entry is unusable, or if the store does not answer for the first time.
    pub fn entry(&self, id: Digest, fits: Fits<'_>) -> Result<Option<Entry>, CacheError> {
        let read = self.read(self.path("jobs", id), MAX_ENTRY_BYTES, |bytes| {
            Entry::read(&bytes, id, fits).map(Some).or_else(absent)
        });
        self.runtime.block_on(read)
    }

    /// Returns the bytes of each of `wanted`, with the errors of [`Self::entry`].
    pub fn blobs(&self, wanted: &[&Stored]) -> Vec<Result<Option<Vec<u8>>, CacheError>> {
        let blob = |stored: &Stored| {
            let name = stored.blake3;
            self.read(self.path("blobs", name), stored.bytes, move |bytes| {
                if digest(&bytes) == name { Ok(Some(bytes)) } else { Err(Unusable::Damaged) }
            })
        };
        let blobs: Vec<_> = wanted.iter().map(|stored| blob(stored)).collect();
        self.runtime.block_on(stream::iter(blobs).buffered(PARALLEL_BLOBS).collect())
    }

    /// Stores the bytes of the files of `entry`, in the order of [`Entry::stored`], and then `entry` itself.
    ///
    /// # Errors
    /// [`CacheError`] if the store does not answer, or refuses objects, for the first time.
    pub fn put(&self, entry: &Entry, blobs: &[&[u8]]) -> Result<(), CacheError> {
        if !self.health.is_writable() {
            return Ok(());
        }
        let put = async {
            let json = entry.to_bytes().map_err(|e| Error::Generic { store: "entry", source: e.into() })?;
            let blobs: Vec<_> =
                entry.stored().zip(blobs).map(|(stored, bytes)| self.create("blobs", stored.blake3, bytes)).collect();
            stream::iter(blobs).buffer_unordered(PARALLEL_BLOBS).try_collect::<()>().await?;
            self.create("jobs", entry.job, &json).await
        };
        self.runtime.block_on(put).or_else(|error| self.health.put_failed(&self.url, &error))
    }

    /// Reads an object of at most `limit` bytes with `parse`, and deletes the object if it is unusable.
    async fn read<T>(
        &self,
        path: ObjectPath,
        limit: u64,
        parse: impl Fn(Vec<u8>) -> Result<Option<T>, Unusable>,
    ) -> Result<Option<T>, CacheError> {
        if !self.health.is_available() {
            return Ok(None);
        }
        match self.bytes(&path, limit).await {
            Ok(None) => Ok(None),
            Ok(Some(bytes)) => {
                let parsed = parse(bytes);
                if !matches!(parsed, Ok(Some(_))) {
                    // Existing objects are never overwritten, so an unusable one must go. If another machine has
                    // replaced the object meanwhile, its job is baked once more.
                    let _ = self.store.delete(&path).await;
                }
                let location = || format!("{} ({path})", self.url);
                parsed.map_err(|unusable| match unusable {
                    Unusable::Damaged => CacheError::DamagedObject { url: location() },
                    found => CacheError::Foreign { place: location(), found },
                })
            }
            Err(error) => self.health.get_failed(&self.url, &error).map(|()| None),
        }
    }

    /// Returns the bytes of an object. Reading stops soon after `limit` bytes, since a larger object cannot be valid.
    async fn bytes(&self, path: &ObjectPath, limit: u64) -> StoreResult<Option<Vec<u8>>> {
        let found = match self.store.get(path).await {
            Err(Error::NotFound { .. }) => return Ok(None),
            found => found?,
        };
        let (mut chunks, mut bytes) = (found.into_stream(), Vec::new());
        while let Some(chunk) = chunks.try_next().await? {
            bytes.extend_from_slice(&chunk);
            if bytes.len() as u64 > limit {
                break;
            }
        }
        Ok(Some(bytes))
    }

    async fn create(&self, kind: &str, name: Digest, bytes: &[u8]) -> StoreResult<()> {
        match self.store.put_opts(&self.path(kind, name), bytes.to_vec().into(), PutMode::Create.into()).await {
            // Another machine has created the object with equal bytes. If they differ, the reader detects it.
            Ok(_) | Err(Error::AlreadyExists { .. }) => Ok(()),
            Err(error) => Err(error),
        }
    }

    fn path(&self, kind: &str, name: Digest) -> ObjectPath {
        self.prefix.clone().join(kind).join(format!("{name:.2}")).join(name.to_string())
    }
}

#[cfg(test)]
mod tests;
