//! Writing files: which paths a run may write, and how a file is written whole or not at all.
//!
//! Only [`Guard`] decides whether a path may be written. It returns an [`OutputPath`] for each such path, and only an
//! [`OutputPath`] can be written to.

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
pub use path::{OutputPath, folder_of};
pub use real::{is_same_file, real};
pub use reserve::{Outputs, Reserved};
pub use sweep::is_abandoned;
pub use write::Staged;
