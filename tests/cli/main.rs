//! The command as its users run it: a process, folders, exit codes, bytes. One binary, since each costs a link.

mod bad_input;
mod build;
mod bytes;
mod cache;
mod compare;
mod config;
mod farm;
mod fixtures;
mod merge;
mod notes;
mod plan;
mod process;
#[path = "../common/random.rs"]
mod random;
mod rdo;
mod render;
mod survival;
mod transcripts;
mod trust;
mod validator;
mod watch;
