//! From a document to baked textures and a rewritten document. The core does no I/O.

mod asset;
mod bare;
mod compact;
mod container;
mod error;
mod extension;
mod file;
mod geometry;
mod job;
mod names;
mod plan;
mod provenance;
mod reader;
mod source;
mod survey;

pub use crate::input_file::{check_file, hash_file, read_file};
pub use asset::{Baked, bake};
pub use bare::{BakeMapError, BakedMap, BaseRoughness, MapTexture, bake_map};
pub use error::{BakeError, ContainerError};
pub use file::NewFile;

pub use extension::EXTENSION;
pub use job::JobError;
pub use names::{fit_name, output_stem, portable_stem};

pub use provenance::DocumentProvenance;

pub use source::{Files, Source, SourceError};
pub use survey::{Survey, survey};
