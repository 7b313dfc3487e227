//! Running of jobs on a server of the Remote Execution API v2 (NativeLink, Buildbarn, BuildBuddy, BuildGrid,
//! buildbox-casd).
//!
//! An action is a few jobs. Its inputs are the tool, a plan of the jobs, and the files that the jobs list. Its output
//! is the folder of a disk cache, from which the caller's disk cache is filled. Outputs are then published as those of
//! any cached job, so a server cannot choose paths. Nothing that the server sends is trusted: blobs are verified by
//! SHA-256, outputs also by BLAKE3, and an action that succeeds without the outputs of its jobs has failed.

#[cfg(feature = "remote")]
mod farm;
#[cfg(not(feature = "remote"))]
#[path = "no_farm.rs"]
mod farm;
mod options;
mod request;
mod schedule;

pub use farm::{Remote, RemoteError};
pub use options::{Header, Options, Tls};
pub use request::{Counts, JobFailure, JobRequest, Origin, Outcome, Wait};
pub use schedule::{ScheduleError, schedule};
