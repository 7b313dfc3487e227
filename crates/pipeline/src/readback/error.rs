//! Errors of inputs and of materials that are read back.

use std::io;

use crate::bake::SourceError;
use crate::decode::DecodeError;
use crate::gltf::document::DocumentError;
use crate::gltf::json::JsonError;
use crate::gltf::material::MaterialError;
use crate::gltf::texture::TextureError;
use crate::input_file::Unreadable;
use crate::ktx2::ReadError;

/// Why an input, or a material of its bake, cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadBackError {
    /// The input cannot be read.
    #[error("expected a readable file, found: {}", Unreadable(.0))]
    Read(io::Error),
    /// The waves cannot be encoded.
    #[error("expected to encode the waves as OpenEXR, found: {0}; free memory and try again")]
    Waves(String),
    /// The document is damaged.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The JSON of the document is damaged.
    #[error(transparent)]
    Json(#[from] JsonError),
    /// A material is damaged.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A material names a texture that does not exist.
    #[error("material {material}: {error}")]
    Reference {
        /// The name of the material.
        material: String,
        /// What is wrong.
        error: TextureError,
    },
    /// The file of a texture cannot be read.
    #[error("material {material}, texture {texture}: {error}")]
    Source {
        /// The name of the material.
        material: String,
        /// The URI or the buffer view of the texture.
        texture: String,
        /// What is wrong.
        error: SourceError,
    },
    /// An image cannot be decoded.
    #[error("material {material}, texture {texture}: {error}")]
    Decode {
        /// The name of the material.
        material: String,
        /// The URI or the buffer view of the texture.
        texture: String,
        /// What is wrong.
        error: DecodeError,
    },
    /// A KTX2 file cannot be decoded.
    #[error("material {material}, texture {texture}: {error}")]
    Ktx2 {
        /// The name of the material.
        material: String,
        /// The URI or the buffer view of the texture.
        texture: String,
        /// What is wrong.
        error: ReadError,
    },
    /// The extension of the pyramid profile is damaged.
    #[error("material {material}: {reason}")]
    Extension {
        /// The name of the material.
        material: String,
        /// What is wrong.
        reason: String,
    },
    /// No material has bumps on its base layer.
    #[error("expected a material with a normal or height map, found none; name another file")]
    NoBumps,
}
