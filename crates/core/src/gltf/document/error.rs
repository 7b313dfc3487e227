//! Errors of glTF files and of edits to them.

use crate::foreign::Foreign;
use crate::gltf::json::JsonError;
use crate::image::FileFormat;

/// Why a file is not a glTF asset, or cannot be edited or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// The JSON is malformed, a value in it has a wrong type, or an edit of it failed.
    #[error("JSON: {0}")]
    Json(#[from] JsonError),
    /// The file cannot be a document at all.
    #[error("expected a glTF document, found {found}")]
    Foreign {
        /// What the file is.
        found: Foreign,
    },
    /// The file is an image.
    #[error(
        "expected a glTF document, found an image ({format}); name the .gltf or .glb that uses it, or bake it by \
         itself with `roughcast map`"
    )]
    Image {
        /// Format of the image.
        format: FileFormat,
    },
    /// The file is neither a GLB nor a JSON object.
    #[error("expected a GLB or a JSON object, found {found}; export the scene as glTF 2.0 (.glb or .gltf)")]
    NotGltf {
        /// What the file is.
        found: String,
    },
    /// The JSON does not declare a version of glTF.
    #[error(
        "expected \"asset\" with \"version\": \"2.0\" as every glTF document has it, found {found}; \
         export the scene as glTF 2.0 (.glb or .gltf)"
    )]
    NoVersion {
        /// What the JSON has instead.
        found: String,
    },
    /// A document of another version of glTF.
    #[error("expected glTF 2.0, found {found} as asset.{member}; export the scene as glTF 2.0 (.glb or .gltf)")]
    OtherVersion {
        /// `version` or `minVersion`.
        member: &'static str,
        /// Its value as JSON, cut to 32 characters.
        found: String,
    },
    /// The file ends before the length that its GLB header declares.
    #[error("expected {needed} bytes of GLB, found {found}; the file is cut short")]
    Truncated {
        /// Bytes the header asks for.
        needed: usize,
        /// Bytes there are.
        found: usize,
    },
    /// Data follows the length that the GLB header declares. Zeros are allowed, since some writers pad files.
    #[error("expected {declared} bytes as the GLB header declares, found {found}; export the file again")]
    Length {
        /// Length in the header.
        declared: usize,
        /// Length of the file.
        found: usize,
    },
    /// A GLB of another version.
    #[error("expected GLB version 2, found {found}; export the asset as glTF 2.0")]
    Version {
        /// Version in the header.
        found: u32,
    },
    /// A chunk ends after the end of the file.
    #[error("expected {needed} bytes for the GLB chunk at byte {at}, found {found}; the file is damaged")]
    Chunk {
        /// Offset of the chunk's header.
        at: usize,
        /// Bytes of its header and data.
        needed: usize,
        /// Bytes left in the file.
        found: usize,
    },
    /// A chunk whose length is not a multiple of 4.
    #[error(
        "expected a multiple of 4 as the length of the GLB chunk at byte {at}, found {length}; export the file again"
    )]
    ChunkAlignment {
        /// Offset of the chunk's header.
        at: usize,
        /// Length in that header.
        length: u32,
    },
    /// The first chunk is not the JSON.
    #[error("expected a JSON chunk first in the GLB, found {found}; the file is damaged")]
    NoJsonChunk {
        /// Type of the first chunk.
        found: String,
    },
    /// A length does not fit into the 32 bits of a GLB.
    #[error("a GLB holds at most 4 GiB, this one would be larger; write .gltf with external files")]
    TooLarge,
    /// Only a GLB has a BIN chunk.
    #[error("a .gltf file has no BIN chunk to add data to; write an external file")]
    NotGlb,
    /// Buffer 0 is not the BIN chunk, or is longer than the chunk.
    #[error("buffer 0 is not the BIN chunk, so nothing can be added to it; write an external file")]
    NoBinBuffer,
    /// An index names something that does not exist.
    #[error("nothing at \"{pointer}\": the index is past the end of its array")]
    Missing {
        /// The place in the JSON.
        pointer: String,
    },
    /// A buffer view ends after the end of its buffer.
    #[error(
        "buffer view {view}: expected its {length} bytes from byte {offset} on within \
         the {buffer_length} bytes of buffer {buffer}, found an end beyond them"
    )]
    ViewOutside {
        /// Index of the buffer view.
        view: usize,
        /// Its `byteOffset`.
        offset: usize,
        /// Its `byteLength`.
        length: usize,
        /// Its buffer.
        buffer: usize,
        /// That buffer's `byteLength`.
        buffer_length: usize,
    },
}
