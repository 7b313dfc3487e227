//! What commands have in common on the terminal: streams, progress, summaries and exit codes.

pub mod outcome;
pub mod progress;
pub mod streams;
pub mod summary;
