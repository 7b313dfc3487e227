//! Why the viewer cannot start.

use std::io;
use std::path::PathBuf;

use super::variant::Variant;
use crate::gltf::document::DocumentError;
use crate::gltf::uri::UriError;

/// Why the viewer cannot start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewerError {
    /// A file that cannot be read.
    #[error("{}: expected a .gltf or .glb file or a folder, found: {reason}; check the path", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        reason: io::Error,
    },
    /// An original that cannot be read.
    #[error("--original {}: expected a .gltf or .glb file, found: {reason}; check the path", path.display())]
    Original {
        /// The file.
        path: PathBuf,
        /// The system's error.
        reason: io::Error,
    },
    /// A folder that cannot be searched.
    #[error("{}: expected a folder that can be read, found: {reason}; check its permissions", path.display())]
    Walk {
        /// The folder.
        path: PathBuf,
        /// The system's error.
        reason: walkdir::Error,
    },
    /// A folder without assets.
    #[error("{}: expected .gltf or .glb files below this folder, found none; check the path", path.display())]
    EmptyFolder {
        /// The folder.
        path: PathBuf,
    },
    /// A file that is no glTF document.
    #[error("{}: cannot be shown: {reason}", path.display())]
    Document {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: Box<DocumentError>,
    },
    /// Two documents of one kind.
    #[error(
        "expected one file of each kind, found {} and {}, both \u{201c}{}\u{201d}; name one of them",
        first.display(), second.display(), variant.title()
    )]
    Twice {
        /// The kind.
        variant: Variant,
        /// One of the files.
        first: PathBuf,
        /// The other file.
        second: PathBuf,
    },
    /// A document whose name cannot be part of a URL.
    #[error("{}: expected a file name that a URL can hold, found: {reason}; rename the file", path.display())]
    Name {
        /// The document.
        path: PathBuf,
        /// What is wrong.
        reason: UriError,
    },
    /// A document whose name is not valid Unicode.
    #[error("{}: expected a file name in UTF-8, found other bytes; rename the file", path.display())]
    NotUtf8 {
        /// The document.
        path: PathBuf,
    },
    /// No port to listen on.
    #[error("127.0.0.1: expected a free port for the page, found: {0}; close other programs and run it again")]
    Listen(io::Error),
}
