//! Why an asset or a standalone map cannot be baked.

use crate::bake::group::GroupError;
use crate::bake::image_error::ImageError;
use crate::bake::source::SourceError;
use crate::codec::EncodeError;
use crate::gltf::document::DocumentError;
use crate::gltf::json::JsonError;
use crate::gltf::material::MaterialError;
use crate::gltf::uri::UriError;
use crate::material::GridError;

/// Why an asset or a standalone map cannot be baked. Messages name the material and the texture; the caller adds the
/// file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The document, or its GLB container.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The document's JSON.
    #[error(transparent)]
    Json(#[from] JsonError),
    /// A material.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A reference of a material.
    #[error(transparent)]
    Group(#[from] GroupError),
    /// An image of a material.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// Maps whose common grid is too large.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// A texture cannot be encoded.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// A file beside the document.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The requested container.
    #[error(transparent)]
    Container(#[from] ContainerError),
    /// A number of the vendor extension that JSON cannot hold.
    #[error(
        "{pointer}: expected finite numbers, found infinity or NaN in what the bumps and meshes make of them; \
         bake with `--frame unit`"
    )]
    NotFinite {
        /// JSON pointer of the extension.
        pointer: String,
    },
}

/// Why the document cannot be put into its container.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)]
#[non_exhaustive]
pub enum ContainerError {
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error(transparent)]
    Json(#[from] JsonError),
    #[error(transparent)]
    Source(#[from] SourceError),
    /// A URI of an image or a buffer.
    #[error("{pointer}: {error}")]
    Uri {
        /// JSON pointer of the image or buffer.
        pointer: String,
        /// What is wrong with the URI.
        error: UriError,
    },
    /// Buffers that cannot be joined.
    #[error(
        "expected buffer views without extensions to join {count} buffers in one .glb, found some that refer to buffers \
         in ways of their own; bake to .gltf, by `-o` with a .gltf name or by --glb=false"
    )]
    Buffers {
        /// How many buffers there are.
        count: usize,
    },
}
