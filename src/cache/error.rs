//! What is wrong with a cache.

use std::io;
use std::path::PathBuf;

use super::entry::Unusable;

/// What is wrong with a cache. Once it is open, no reason for a job to fail.
#[derive(Debug, thiserror::Error)]
pub enum CacheError {
    /// Other bytes than were written. The file is gone now.
    #[error("{}: expected the bytes that were stored there, found others; dropped it, and bake again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
    },
    /// The file system refused.
    #[error("{}: expected a cache that can be read and written, found: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// The same in a shared cache, where it is gone if that is allowed.
    #[error(
        "{url}: expected the bytes that were stored there, found others; drop it if that is allowed, and bake again"
    )]
    DamagedObject {
        /// The object.
        url: String,
    },
    /// An entry that is not of the job that it is kept for. It is gone now, if that is allowed.
    #[error("{place}: expected the entry of this job, found {found}; drop it, and bake again")]
    Foreign {
        /// The file or object.
        place: String,
        /// What it is.
        found: Unusable,
    },
    /// A shared cache does not answer; told once.
    #[error("{url}: expected a store that answers, found: {reason}; go on without it")]
    Unreachable {
        /// The cache.
        url: String,
        /// What went wrong.
        reason: String,
    },
    /// A shared cache takes nothing; told once.
    #[error("{url}: expected a store that takes new objects, found: {reason}; only read from it")]
    ReadOnly {
        /// The cache.
        url: String,
        /// What went wrong.
        reason: String,
    },
    /// More than a folder and a URL.
    #[error("--cache: expected one folder and one URL at most, found {first} and {second}")]
    TwoOfAKind {
        /// The first.
        first: String,
        /// The second.
        second: String,
    },
    /// A URL that names no store.
    #[error(
        "--cache {url}: expected s3://bucket/prefix, gs://bucket/prefix, az://container/prefix or file:///folder, found \
         {found}"
    )]
    NoStore {
        /// What was said, without secrets.
        url: String,
        /// What is wrong with it.
        found: String,
    },
    /// This build has no shared caches.
    #[error(
        "--cache {url}: expected a folder, since this build has no object stores; build it with --features object-store"
    )]
    NotBuilt {
        /// What was said.
        url: String,
    },
}

impl CacheError {
    /// Whether it is about the cache as a whole rather than about what it has of a job.
    pub fn is_general(&self) -> bool {
        matches!(self, Self::Unreachable { .. } | Self::ReadOnly { .. })
    }
}
