//! Tests that digests, ids and paths of caches and plans are validated before they are used.

mod entries;
mod names;
mod plans;
