//! Digests, ids and paths of caches and plans are what they must be, or of no use.

mod entries;
mod names;
mod plans;
