//! The client of a build farm, in builds with the feature `remote`.
//!
//! `ahead` takes groups of jobs through `attempt`: an `action` of each group, its `upload`, what comes of it (`execute`), and its
//! `results` as entries of the cache. All that they say to the server goes through the one `client`.

mod action;
mod ahead;
mod api;
mod attempt;
mod client;
mod digest;
mod download;
mod error;
mod execute;
mod group;
mod results;
mod retry;
mod server;
mod tree;
mod upload;

pub use error::RemoteError;
pub use server::Remote;
