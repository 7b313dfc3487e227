//! Why an asset cannot be baked.

use crate::bake::job::JobError;
use crate::bake::plan::PlanError;
use crate::bake::source::SourceError;
use crate::gltf::document::DocumentError;
use crate::gltf::json::JsonError;
use crate::gltf::material::MaterialError;
use crate::gltf::uri::UriError;

/// Why an asset cannot be baked. Messages name material and texture; the caller adds the file.
#[derive(Debug, thiserror::Error)]
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
    /// A reference between objects of the document.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// An image.
    #[error(transparent)]
    Job(#[from] JobError),
    /// A file beside the document.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The container asked for.
    #[error(transparent)]
    Container(#[from] ContainerError),
    /// A number of the vendor extension that JSON does not have.
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
pub enum ContainerError {
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error(transparent)]
    Json(#[from] JsonError),
    #[error(transparent)]
    Source(#[from] SourceError),
    /// A reference of an image or a buffer.
    #[error("{pointer}: {error}")]
    Uri {
        /// JSON pointer of the reference.
        pointer: String,
        /// What is wrong with it.
        error: UriError,
    },
    /// Buffers that cannot be joined.
    #[error(
        "expected buffer views without extensions to join {count} buffers in one .glb, found some that refer to buffers \
         in ways of their own; bake to .gltf, without --glb"
    )]
    Buffers {
        /// How many buffers there are.
        count: usize,
    },
}
