//! Errors of drawing.

use std::io;
use std::path::PathBuf;

use crate::bake::{BakeError, SourceError};
use crate::decode::DecodeError;
use crate::gltf::document::DocumentError;
use crate::gltf::json::JsonError;
use crate::gltf::material::MaterialError;
use crate::gltf::texture::TextureError;
use crate::ktx2::ReadError;
use crate::output::PublishError;

/// Why nothing is drawn.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    #[error("expected a readable file, found: {0}; check the path")]
    Read(io::Error),
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error(transparent)]
    Json(#[from] JsonError),
    #[error(transparent)]
    Bake(#[from] BakeError),
    #[error(transparent)]
    Material(#[from] MaterialError),
    #[error("material {material}: {error}")]
    Reference { material: String, error: TextureError },
    #[error("material {material}, texture {texture}: {error}")]
    Source { material: String, texture: String, error: SourceError },
    #[error("material {material}, texture {texture}: {error}")]
    Decode { material: String, texture: String, error: DecodeError },
    #[error("material {material}, texture {texture}: {error}")]
    Ktx2 { material: String, texture: String, error: ReadError },
    #[error("material {material}: {reason}")]
    Extension { material: String, reason: String },
    #[error("expected a material with a normal or height map, found none; name another file")]
    NoBumps,
    #[error(transparent)]
    Publish(#[from] PublishError),
    #[error("expected to write compare.csv, found: {0}")]
    Table(io::Error),
    #[error("expected to encode {}, found: {reason}; choose a smaller --width", path.display())]
    Encode { path: PathBuf, reason: String },
}
