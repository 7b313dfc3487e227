//! Writing files: where a run may write, and how a file is written whole or not at all.
//!
//! [`Guard`] alone decides whether a path may be written. It hands out a [`Place`] for each path that may, and a place is
//! the only thing that can be written to.

mod case;
mod error;
mod guard;
pub mod lock;
mod path;
mod real;
mod reserve;
mod sweep;
mod write;

pub use case::case_folded;
pub use error::PublishError;
pub use guard::Guard;
pub use path::OutputPath;
pub use real::real;
pub use reserve::{Outputs, Reserved};
pub use sweep::is_abandoned;
pub use write::Staged;
