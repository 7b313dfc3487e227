//! The bake: from a document to baked textures and a new document, or from a standalone map to its textures. Bytes in,
//! bytes out: this module knows neither paths on disk nor the caller's threads.
//!
//! | step | file | from | to |
//! |---|---|---|---|
//! | 1 | `source`, `reader` | bytes of a document and its files | JSON, materials, buffers |
//! | 2 | `group` | materials | layers, grouped by bump map |
//! | 3 | `decode` | a group | images |
//! | 4 | `offsets` | an image | a bump map: offsets on a grid |
//! | 5 | `lobes` | offsets and a base lobe | lobes of every level |
//! | 6 | `choose` | lobes | the model of the roughness data |
//! | 7 | `products`, `pyramid` | lobes, offsets, the model | textures as rows of values |
//! | 8 | `products`, `pyramid`, `encode` | rows of values | encoded levels, KTX2 files |
//! | 9 | `assemble` | textures | the document, its files, a report |
//!
//! Textures that the bake does not change take steps 3 and 7 to 9 in `plain_textures`; `diffuse_light` darkens base
//! colours among them for suns.
//!
//! [`bake_asset`] runs all steps. [`bake_map`] runs steps 4 to 8 of a material of one map; both go through
//! `bake_bump_map`, which bakes the layers of one bump map by `bake_layer`.

mod assemble;
mod asset;
mod bake_bump_map;
mod bake_group;
mod bake_layer;
mod baked_asset;
mod choose;
mod compact;
mod decode;
mod diffuse_light;
mod error;
mod fill_extension;
mod frame;
mod geometry;
mod group;
mod group_output;
mod image_error;
mod ktx2_files;
mod lobes;
mod names;
mod new_file;
mod offsets;
mod output_document;
mod output_sizes;
mod plain_textures;
mod planned_files;
mod products;
mod provenance;
mod pyramid;
mod reader;
mod reflectance;
mod source;
mod standalone;

pub use asset::bake_asset;
pub use baked_asset::BakedAsset;
pub use error::{BakeError, ContainerError};
pub use fill_extension::EXTENSION;
pub use group::GroupError;
pub use image_error::ImageError;
pub use names::{fit_name, output_stem, output_stem_of, portable_stem};
pub use new_file::NewFile;
pub use planned_files::{PlannedFiles, planned_files};
pub use products::EncodedTexture;
pub use provenance::DocumentProvenance;
pub use source::{Files, Source, SourceError};
pub use standalone::{BaseRoughness, EncodedMap, bake_map};
