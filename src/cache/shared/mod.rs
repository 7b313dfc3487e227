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
use super::entry::{Entry, Stored};
use super::error::CacheError;
use crate::digest::digest;

/// Blobs of a job that are on their way at the same time.
const AT_ONCE: usize = 8;

/// An entry lists a few files and notes.
const MAX_ENTRY_BYTES: u64 = 64 << 20;

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

    /// The outputs of the job `id`, if it was run.
    ///
    /// # Errors
    /// [`CacheError`] where the entry is there but of no use, or the store does not answer for the first time.
    pub fn entry(&self, id: &str) -> Result<Option<Entry>, CacheError> {
        let read = self.read(self.path("jobs", id), MAX_ENTRY_BYTES, |bytes| Entry::parse(&bytes));
        self.runtime.block_on(read)
    }

    /// The bytes of each of `wanted`, as [`Self::entry`].
    pub fn blobs(&self, wanted: &[&Stored]) -> Vec<Result<Option<Vec<u8>>, CacheError>> {
        let blob = |stored: &Stored| {
            let name = stored.blake3.clone();
            self.read(self.path("blobs", &name), stored.bytes, move |bytes| (digest(&bytes) == name).then_some(bytes))
        };
        let blobs: Vec<_> = wanted.iter().map(|stored| blob(stored)).collect();
        self.runtime.block_on(stream::iter(blobs).buffered(AT_ONCE).collect())
    }

    /// Stores `entry` of the job `id` and the bytes of its files, in the order of [`Entry::stored`], before it.
    ///
    /// # Errors
    /// [`CacheError`] where the store does not answer, or takes nothing, for the first time.
    pub fn put(&self, id: &str, entry: &Entry, blobs: &[&[u8]]) -> Result<(), CacheError> {
        if !self.health.is_writable() {
            return Ok(());
        }
        let put = async {
            let json = entry.to_bytes().map_err(|e| Error::Generic { store: "entry", source: e.into() })?;
            let blobs: Vec<_> =
                entry.stored().zip(blobs).map(|(stored, bytes)| self.create("blobs", &stored.blake3, bytes)).collect();
            stream::iter(blobs).buffer_unordered(AT_ONCE).try_collect::<()>().await?;
            self.create("jobs", id, &json).await
        };
        self.runtime.block_on(put).or_else(|error| self.health.put_failed(&self.url, &error))
    }

    /// What `parse` makes of an object of at most `limit` bytes.
    async fn read<T>(
        &self,
        path: ObjectPath,
        limit: u64,
        parse: impl Fn(Vec<u8>) -> Option<T>,
    ) -> Result<Option<T>, CacheError> {
        if !self.health.is_awake() {
            return Ok(None);
        }
        match self.bytes(&path, limit).await {
            Ok(None) => Ok(None),
            Ok(Some(bytes)) => match parse(bytes) {
                Some(parsed) => Ok(Some(parsed)),
                None => {
                    // What is created only is not replaced. Where another machine has, it is baked once more.
                    let _ = self.store.delete(&path).await;
                    Err(CacheError::DamagedObject { url: format!("{} ({path})", self.url) })
                }
            },
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

    async fn create(&self, kind: &str, name: &str, bytes: &[u8]) -> StoreResult<()> {
        match self.store.put_opts(&self.path(kind, name), bytes.to_vec().into(), PutMode::Create.into()).await {
            // By another machine, with the same bytes; if not, whoever reads it will see.
            Ok(_) | Err(Error::AlreadyExists { .. }) => Ok(()),
            Err(error) => Err(error),
        }
    }

    fn path(&self, kind: &str, name: &str) -> ObjectPath {
        self.prefix.clone().join(kind).join(name.get(..2).unwrap_or("")).join(name)
    }
}

#[cfg(test)]
mod tests;
