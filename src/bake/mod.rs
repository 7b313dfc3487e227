//! From a document to baked textures and a rewritten document. The core does no I/O.

mod asset;
mod bare;
mod base;
mod bumps;
mod chain;
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
mod publish;
mod pyramids;
mod relief;
pub mod report;
mod settings;
mod source;
mod view;

pub use asset::{BakeError, Baked, NewFile, bake};
pub use bare::{BareBake, BareError, BareTexture, OwnRoughness, bake_map};
pub use chain::{Chain, GridError};
pub use extension::EXTENSION;
pub use job::JobError;
pub use png::encode_png;
pub use publish::{Places, PublishError, publish, read_file, write_file};
pub use pyramids::Range;
pub use relief::Relief;
pub use settings::{Form, Model, Profile, Settings};
pub use source::{Source, SourceError};
pub use view::{Finest, View};
