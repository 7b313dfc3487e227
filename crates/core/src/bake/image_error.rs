//! Why an image of a material cannot be baked.

use std::io;

use crate::bake::source::SourceError;
use crate::decode::DecodeError;
use crate::image::MapError;

/// Why an image of a material cannot be baked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The bytes of the image cannot be read.
    #[error("material {material}, texture {texture}: {error}")]
    Source {
        /// Name of the first material that uses the image.
        material: String,
        /// The image's URI or number.
        texture: String,
        /// Why.
        error: SourceError,
    },
    /// The image cannot be decoded.
    #[error("material {material}, texture {texture}: {error}")]
    Decode {
        /// Name of the first material that uses the image.
        material: String,
        /// The image's URI or number.
        texture: String,
        /// Why.
        error: DecodeError,
    },
    /// The image does not have the channels or the values that its texture needs.
    #[error("material {material}, texture {texture}: {error}")]
    Map {
        /// Name of the first material that uses the image.
        material: String,
        /// The image's URI or number.
        texture: String,
        /// Why.
        error: MapError,
    },
    /// Roughcast wrote the texture itself.
    #[error(
        "material {material}, texture {texture}: expected a source texture, found one that Roughcast has baked; \
         bake from the original asset, since a second bake would count the bumps twice"
    )]
    AlreadyBaked {
        /// Name of the first material that uses the image.
        material: String,
        /// The image's URI or number.
        texture: String,
    },
}

impl ImageError {
    /// Returns whether memory was short, so that another try may succeed.
    pub fn is_out_of_memory(&self) -> bool {
        match self {
            Self::Source { error: SourceError::Read { error, .. }, .. } => error.kind() == io::ErrorKind::OutOfMemory,
            Self::Decode { error, .. } => error.is_out_of_memory(),
            _ => false,
        }
    }
}
