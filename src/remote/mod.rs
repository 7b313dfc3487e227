//! Jobs on a server of the Remote Execution API v2 (NativeLink, Buildbarn, BuildBuddy, BuildGrid, buildbox-casd).
//!
//! An action is a few jobs: its inputs are the tool, a plan of these jobs and the files that they list; its output is the
//! folder of a cache, from which the caller's cache is filled. Publishing is then what it is for any cached job, so a server
//! can name no path. Nothing that it sends is believed: blobs are verified by SHA-256, outputs by BLAKE3 too, and an action
//! that ends well without the outputs of its jobs has failed.

#[cfg(feature = "remote")]
mod farm;
#[cfg(not(feature = "remote"))]
#[path = "absent.rs"]
mod farm;
mod options;
mod outcome;

pub use farm::{Remote, RemoteError};
pub use options::{Header, Options, Tls};
pub use outcome::{Counts, Errand, JobFailure, Origin, Outcome, Wait};
