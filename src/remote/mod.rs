//! Jobs on a server of the Remote Execution API v2 (NativeLink, Buildbarn, BuildBuddy, BuildGrid, buildbox-casd).
//!
//! An action is a few jobs: its inputs are the tool, a plan of these jobs and the files that they list; its output is the
//! folder of a cache, from which the caller's cache is filled. Publishing is then what it is for any cached job, so a server
//! can name no path. Nothing that it sends is believed: blobs are verified by SHA-256, outputs by BLAKE3 too, and an action
//! that ends well without the outputs of its jobs has failed.

mod options;
mod outcome;

#[cfg(not(feature = "remote"))]
mod absent;

#[cfg(feature = "remote")]
mod action;
#[cfg(feature = "remote")]
mod ahead;
#[cfg(feature = "remote")]
mod api;
#[cfg(feature = "remote")]
mod attempt;
#[cfg(feature = "remote")]
mod client;
#[cfg(feature = "remote")]
mod digest;
#[cfg(feature = "remote")]
mod download;
#[cfg(feature = "remote")]
mod error;
#[cfg(feature = "remote")]
mod execute;
#[cfg(feature = "remote")]
mod group;
#[cfg(feature = "remote")]
mod results;
#[cfg(feature = "remote")]
mod retry;
#[cfg(feature = "remote")]
mod server;
#[cfg(feature = "remote")]
mod tally;
#[cfg(feature = "remote")]
mod tree;
#[cfg(feature = "remote")]
mod upload;

pub use options::{Header, Options, Tls};
pub use outcome::{Counts, Errand, JobFailure, Origin, Outcome, Wait};

#[cfg(not(feature = "remote"))]
pub use absent::{Remote, RemoteError};
#[cfg(feature = "remote")]
pub use error::RemoteError;
#[cfg(feature = "remote")]
pub use server::Remote;
