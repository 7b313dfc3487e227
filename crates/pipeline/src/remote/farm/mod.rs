//! The client of build farms, in builds with the feature `remote`.
//!
//! `jobs` runs groups of jobs through `attempt`. Each group becomes an `action`, whose blobs `upload` sends and which
//! `execute` runs. `results` stores its results as entries of the disk cache. All calls to the server go through one
//! `client`.

mod action;
mod api;
mod attempt;
mod client;
mod digest;
mod download;
mod error;
mod execute;
mod group;
mod jobs;
mod results;
mod retry;
mod server;
mod tree;
mod upload;

pub use error::RemoteError;
pub use server::Remote;
