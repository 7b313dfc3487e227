//! Watching files: when to look, what is other than it was, whether it is still being written, and which outputs are ours.
//!
//! Events of the system only say when to look. What changed is what the files say, so events that are lost, late or of
//! another name cost time at most.

mod ledger;
mod look;
mod scope;
mod settling;
mod wakes;

pub use ledger::{Ledger, Removed};
pub use look::{Look, Seen};
pub use scope::{Scope, real};
pub use settling::Settling;
pub use wakes::{Wake, Wakes, WatchError};
