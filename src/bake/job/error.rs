//! Why a job fails.

use crate::bake::source::SourceError;
use crate::codec::EncodeError;
use crate::decode::DecodeError;
use crate::image::MapError;
use crate::material::GridError;

/// Why a job fails.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// An image cannot be had.
    #[error("material {material}, texture {texture}: {error}")]
    Source {
        /// Name of the first material that uses it.
        material: String,
        /// The image's URI or number.
        texture: String,
        /// Why.
        error: SourceError,
    },
    /// An image cannot be decoded.
    #[error("material {material}, texture {texture}: {error}")]
    Decode {
        /// Name of the first material that uses it.
        material: String,
        /// The image's URI or number.
        texture: String,
        /// Why.
        error: DecodeError,
    },
    /// An image cannot serve as the map that it is meant to be.
    #[error("material {material}, texture {texture}: {error}")]
    Map {
        /// Name of the first material that uses it.
        material: String,
        /// The image's URI or number.
        texture: String,
        /// Why.
        error: MapError,
    },
    /// A texture that Roughcast wrote itself.
    #[error(
        "material {material}, texture {texture}: expected a source texture, found one that Roughcast has baked; \
         bake from the original asset, since folding twice counts the bumps twice"
    )]
    AlreadyBaked {
        /// Name of the first material that uses it.
        material: String,
        /// The image's URI or number.
        texture: String,
    },
    /// Maps whose common grid is too large.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// A texture cannot be encoded.
    #[error(transparent)]
    Encode(#[from] EncodeError),
}
