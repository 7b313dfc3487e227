//! A store that machines share, in the layout of a folder: `jobs/<id>` and `blobs/<digest>`, by their first two digits.
//!
//! Objects are created and never written again, so machines need not agree on anything; what is damaged is deleted. A store that
//! does not answer costs one warning, and is asked again after a rest.

mod health;
mod open;

use std::fmt;

use futures::{StreamExt, TryStreamExt, stream};
use object_store::path::Path as ObjectPath;
use object_store::{Error, ObjectStore, ObjectStoreExt, PutMode, Result as StoreResult};
use tokio::runtime::{Builder, Runtime};

use self::health::Health;
use super::entry::{Entry, Fits, MAX_ENTRY_BYTES, Stored, Unusable};
use super::error::CacheError;
use crate::digest::{Digest, digest};

/// Blobs of a job that are on their way at the same time.
const AT_ONCE: usize = 8;

/// A cache in a store.
pub struct Shared {
    /// What was said on the command line; it has no secrets.
    url: String,
    store: Box<dyn ObjectStore>,
    prefix: ObjectPath,
    runtime: Runtime,
    health: Health,
}

/// Without the store, which knows credentials.
impl fmt::Debug for Shared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Shared").field("url", &self.url).finish_non_exhaustive()
    }
}

impl Shared {
    /// The store at `url`, with credentials and endpoints from the environment. Asks it nothing.
    ///
    /// # Errors
    /// [`CacheError::NoStore`].
    pub fn open(url: &str) -> Result<Self, CacheError> {
        let (store, prefix) = open::open(url)?;
        let failed = |error: std::io::Error| CacheError::NoStore { url: url.to_owned(), found: error.to_string() };
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_all().build().map_err(failed)?;
        Ok(Self { url: url.to_owned(), store, prefix, runtime, health: Health::default() })
    }

    /// Returns the outputs of the job `id`, if it was run. `fits` says whether an entry is of the job.
    ///
    /// # Errors
    /// [`CacheError`] where the entry is there but of no use, or the store does not answer for the first time.
    pub fn entry(&self, id: Digest, fits: Fits<'_>) -> Result<Option<Entry>, CacheError> {
        let read = self.read(self.path("jobs", id), MAX_ENTRY_BYTES, |bytes| Entry::read(&bytes, id, fits));
        self.runtime.block_on(read)
    }

    /// The bytes of each of `wanted`, as [`Self::entry`].
    pub fn blobs(&self, wanted: &[&Stored]) -> Vec<Result<Option<Vec<u8>>, CacheError>> {
        let blob = |stored: &Stored| {
            let name = stored.blake3;
            self.read(self.path("blobs", name), stored.bytes, move |bytes| {
                if digest(&bytes) == name { Ok(Some(bytes)) } else { Err(Unusable::Damaged) }
            })
        };
        let blobs: Vec<_> = wanted.iter().map(|stored| blob(stored)).collect();
        self.runtime.block_on(stream::iter(blobs).buffered(AT_ONCE).collect())
    }

    /// Stores the bytes of the files of `entry`, in the order of [`Entry::stored`], and then `entry` itself.
    ///
    /// # Errors
    /// [`CacheError`] where the store does not answer, or takes nothing, for the first time.
    pub fn put(&self, entry: &Entry, blobs: &[&[u8]]) -> Result<(), CacheError> {
        if !self.health.is_writable() {
            return Ok(());
        }
        let put = async {
            let json = entry.to_bytes().map_err(|e| Error::Generic { store: "entry", source: e.into() })?;
            let blobs: Vec<_> =
                entry.stored().zip(blobs).map(|(stored, bytes)| self.create("blobs", stored.blake3, bytes)).collect();
            stream::iter(blobs).buffer_unordered(AT_ONCE).try_collect::<()>().await?;
            self.create("jobs", entry.job, &json).await
        };
        self.runtime.block_on(put).or_else(|error| self.health.put_failed(&self.url, &error))
    }

    /// Returns what `parse` makes of an object of at most `limit` bytes, and deletes one that is of no use.
    async fn read<T>(
        &self,
        path: ObjectPath,
        limit: u64,
        parse: impl Fn(Vec<u8>) -> Result<Option<T>, Unusable>,
    ) -> Result<Option<T>, CacheError> {
        if !self.health.is_awake() {
            return Ok(None);
        }
        match self.bytes(&path, limit).await {
            Ok(None) => Ok(None),
            Ok(Some(bytes)) => {
                let parsed = parse(bytes);
                if !matches!(parsed, Ok(Some(_))) {
                    // An object that is there is not written again. Where another machine has replaced it meanwhile, its
                    // job is baked once more.
                    let _ = self.store.delete(&path).await;
                }
                let place = || format!("{} ({path})", self.url);
                parsed.map_err(|unusable| match unusable {
                    Unusable::Damaged => CacheError::DamagedObject { url: place() },
                    found => CacheError::Foreign { place: place(), found },
                })
            }
            Err(error) => self.health.get_failed(&self.url, &error).map(|()| None),
        }
    }

    /// An object; of a larger one, hardly more than `limit` bytes, which cannot be right.
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
            // By another machine, with the same bytes; if not, whoever reads it will see.
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
