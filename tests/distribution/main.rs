//! Tests of the ways to users that need no registry and no host: packages of crates, archives, the action, hooks and
//! workflows. `python/check` tests the wheel.

mod action;
mod archive;
mod packages;
mod pre_commit;
mod release;
mod shell;
#[path = "../common/skip.rs"]
mod skip;
mod workflows;
