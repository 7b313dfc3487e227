//! Caches of the outputs of jobs: blobs named by the BLAKE3 of their bytes, and for each job an entry that lists its
//! blobs.
//!
//! A cache is on disk, in an object store, or both. Files and objects are written whole or not at all, and verified
//! when they are read. Any number of processes may therefore share a folder, and any number of machines a store,
//! without trusting each other. The disk cache removes the least recently used files first.
//!
//! Digests and paths of an entry are read into `Digest` and [`RelativePath`], which accept no other text. A cache
//! therefore reads, writes and removes only files whose path a digest names. An entry that does not fit its job counts
//! as absent.

mod disk;
mod entry;
mod error;
#[cfg(feature = "object-store")]
mod object_store;
#[cfg(not(feature = "object-store"))]
#[path = "no_object_store.rs"]
mod object_store;
mod relative;
mod store;
#[cfg(test)]
mod test_assets;

pub use disk::DiskCache;
pub use entry::{ENTRY_FORMAT, Entry, Fits, Stored, Unusable};
pub use error::CacheError;
pub use relative::{NotRelative, RelativePath};
pub use store::{Cache, Warn};
