//! The materials of pictures and charts. An input becomes a glTF document, the caller bakes the document, and materials
//! are read from the baked files as an engine reads them.

mod error;
mod file_name;
mod input;
mod material;

pub use error::ReadBackError;
pub use file_name::file_name;
pub use input::{Input, MapKind};
pub use material::read_back;
