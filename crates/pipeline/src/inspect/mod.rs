//! The content of a KTX2 or glTF file: as facts, as text for people, and as pictures. Only `file.rs` does I/O.

mod document;
mod extract;
mod file;
mod render;
mod texture;

pub use document::{DocumentFacts, ImageFacts, MaterialFacts, PictureFacts, SlotFacts, inspect_document};
pub use extract::{ExtractError, Picture, encode_exr, extract};
pub use file::{Facts, INSPECT_FORMAT, InspectError, InspectReport, inspect_file};
pub use render::{document_text, texture_text};
pub use texture::{DescriptorFacts, KeyFacts, LevelFacts, SampleFacts, TextureFacts, inspect_texture};
