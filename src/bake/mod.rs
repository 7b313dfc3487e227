//! From a document to baked textures and a rewritten document. The core does no I/O.

mod asset;
mod bare;
mod base;
mod bumps;
mod chain;
mod compact;
mod container;
mod extension;
mod fold;
mod geometry;
mod job;
mod lobes;
mod names;
mod normals;
pub(crate) mod notes;
mod plan;
mod png;
mod provenance;
mod publish;
mod pyramids;
mod reader;
mod relief;
pub mod report;
mod sampled;
mod settings;
mod source;
mod survey;
mod trial;
mod view;

pub use crate::input_file::{check_file, hash_file, read_file};
pub use asset::{BakeError, Baked, NewFile, bake};
pub use bare::{BareBake, BareError, BareTexture, OwnRoughness, bake_map};
pub use chain::{Chain, GridError, kept_bytes};
pub use container::ContainerError;
pub use extension::EXTENSION;
pub use job::JobError;
pub use names::portable_stem;
pub use png::encode_png;
pub use provenance::DocumentProvenance;
pub use publish::{
    Places, PublishError, UNFINISHED, case_folded, claim, copy_file, sweep, write_file, write_unsynced,
};
pub use pyramids::Range;
pub use relief::Relief;
pub use settings::{Form, Model, Profile, Settings};
pub use source::{Files, Source, SourceError};
pub use survey::{Survey, survey};
pub use view::{Finest, View};
