//! Outputs of jobs, kept: blobs named by the BLAKE3 of their bytes, and for each job the list of its blobs.
//!
//! Everything is written beside its place and renamed, and verified when it is read, so that any number of processes may
//! share a folder and none trusts it. What was not used for longest goes first.

mod entry;
mod store;

pub use entry::{Entry, Stored};
pub use store::{Cache, CacheError};
