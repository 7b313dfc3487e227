//! Outputs of jobs, kept: blobs named by the BLAKE3 of their bytes, and for each job the list of its blobs.
//!
//! Everything is written whole or not at all, and verified when it is read, so that any number of processes may share a folder,
//! and any number of machines a store, and none trusts it. In a folder, what was not used for longest goes first.

mod entry;
mod error;
mod folder;
#[cfg(feature = "object-store")]
mod shared;
#[cfg(not(feature = "object-store"))]
#[path = "no_shared.rs"]
mod shared;
mod store;

pub use entry::{Entry, Stored};
pub use error::CacheError;
pub use folder::Folder;
pub use store::{Cache, Warn};
