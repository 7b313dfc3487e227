//! Outputs of jobs, kept: blobs named by the BLAKE3 of their bytes, and for each job the list of its blobs.
//!
//! Everything is written whole or not at all, and verified when it is read, so that any number of processes may share a folder,
//! and any number of machines a store, and none trusts it. In a folder, what was not used for longest goes first.
//!
//! Digests and paths of an entry are read into `Digest` and [`RelativePath`], which hold nothing else. A
//! cache therefore reads, writes and removes only what lies at a path that a digest names; an entry that is not of its job
//! counts as absent.

mod entry;
mod error;
mod folder;
mod relative;
#[cfg(feature = "object-store")]
mod shared;
#[cfg(not(feature = "object-store"))]
#[path = "no_shared.rs"]
mod shared;
mod store;

pub use entry::{Entry, Fits, Stored, Unusable};
pub use error::CacheError;
pub use folder::Folder;
pub use relative::{NotRelative, RelativePath};
pub use store::{Cache, Warn};
