//! Watching of a folder: when to look, what changed, whether a file is still being written, and which outputs are ours.
//!
//! Events of the system only say when to look. The files themselves decide what changed, so events that are lost, late
//! or under another name cost time at most.

mod asset;
mod documents;
mod event;
mod hook;
mod journal;
mod ledger;
mod look;
mod options;
mod round;
mod scope;
mod settling;
mod wakes;
mod watcher;

pub use event::{Event, EventSink, Name, WATCH_FORMAT};
pub use hook::{Changes, Hook, HookError};
pub use ledger::{Ledger, Removed};
pub use look::{Look, Seen};
pub use options::WatchOptions;
pub use scope::{Scope, real};
pub use settling::Settling;
pub use wakes::{Wake, Wakes, WatchError};
pub use watcher::{Stop, Watcher};
