//! Errors and warnings of caches.

use std::io;
use std::path::PathBuf;

use super::entry::Unusable;

/// What is wrong with a cache. Once a cache is open, such an error is a warning and no job fails.
#[derive(Debug, thiserror::Error)]
pub enum CacheError {
    /// The bytes are not those that were stored. The file was removed.
    #[error(
        "{}: expected the bytes that were stored there, found others; the damaged file was removed and will be replaced",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
    },
    /// The file system returned an error.
    #[error(
        "{}: expected a cache that can be read and written, found: {error}; free space, change the permissions or choose \
         another --cache",
        path.display()
    )]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// The bytes of an object are not those that were stored. The object was deleted if the store allowed it.
    #[error(
        "{url}: expected the bytes that were stored there, found others; the damaged object is deleted and \
         replaced if the store allows it"
    )]
    DamagedObject {
        /// The object.
        url: String,
    },
    /// An entry that does not belong to its job. The entry was removed if that was allowed.
    #[error(
        "{place}: expected the entry of this job, found {found}; the entry is removed and replaced if that is allowed"
    )]
    Foreign {
        /// The path of the file, or the URL of the object.
        place: String,
        /// Why the entry is unusable.
        found: Unusable,
    },
    /// An object store does not answer. Reported once.
    #[error("{url}: expected a store that answers, found: {reason}; the bake goes on without the store")]
    Unreachable {
        /// The URL of the store.
        url: String,
        /// The reason.
        reason: String,
    },
    /// An object store refuses new objects. Reported once.
    #[error("{url}: expected a store that takes new objects, found: {reason}; the store is only read from")]
    ReadOnly {
        /// The URL of the store.
        url: String,
        /// The reason.
        reason: String,
    },
    /// More than one folder, or more than one URL.
    #[error("--cache: expected one folder and one URL at most, found {first} and {second}; leave one of them out")]
    TwoOfAKind {
        /// The first.
        first: String,
        /// The second.
        second: String,
    },
    /// A URL that does not name a store.
    #[error(
        "--cache {url}: expected s3://bucket/prefix, gs://bucket/prefix, az://container/prefix or file:///folder, found \
         {found}"
    )]
    NoStore {
        /// The URL, without secrets.
        url: String,
        /// What is wrong with the URL.
        found: String,
    },
    /// This build has no object-store caches.
    #[error(
        "--cache {url}: expected a folder, since this build has no object stores; build it with --features object-store"
    )]
    NotBuilt {
        /// The URL.
        url: String,
    },
}

impl CacheError {
    /// Returns whether the error is about the cache as a whole rather than about the outputs of one job.
    pub fn is_general(&self) -> bool {
        matches!(self, Self::Unreachable { .. } | Self::ReadOnly { .. })
    }
}
