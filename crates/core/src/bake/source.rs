//! Step 1: a document and the files that it refers to.

use std::io;
use std::path::{Path, PathBuf};

use crate::digest::{Digest, digest};
use crate::foreign::Foreign;
use crate::gltf::document::{Document, DocumentError};
use crate::gltf::texture::ImageLocation;
use crate::gltf::uri::{Uri, UriError};

/// The files beside a document, by their paths relative to the document. A function that reads a file implements this
/// trait.
pub trait Files: Sync {
    /// Reads a file.
    ///
    /// # Errors
    /// Those of the file system.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// Returns the digest of a file to a caller who does not need the bytes.
    ///
    /// # Errors
    /// Those of the file system.
    fn digest(&self, path: &Path) -> io::Result<Digest> {
        self.read(path).map(|bytes| digest(&bytes))
    }

    /// Returns the length of a file in bytes if it is known without reading the file.
    fn known_length(&self, _path: &Path) -> Option<u64> {
        None
    }

    /// Reads a file for a caller who hashes it beside other work and reports the digest to [`Self::hashed`], so that
    /// nothing is hashed twice.
    ///
    /// # Errors
    /// Those of the file system.
    fn read_to_hash(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.read(path)
    }

    /// Records the digest of a file that [`Self::read_to_hash`] read.
    fn hashed(&self, _path: &Path, _blake3: Digest) {}

    /// Returns whether a file is known to be missing without reading it.
    fn is_missing(&self, _path: &Path) -> bool {
        false
    }
}

impl<F: Fn(&Path) -> io::Result<Vec<u8>> + Sync> Files for F {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self(path)
    }
}

/// A document and the files beside it.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// File name without extension, which provenance records.
    pub stem: &'a str,
    /// The name of the output document without extension. New files are named after it.
    pub output_stem: &'a str,
    /// The document.
    pub document: &'a Document,
    /// The files.
    pub files: &'a dyn Files,
}

/// Why the bytes of a file, an image or a buffer cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// The URI has a form that is not read.
    #[error(transparent)]
    Uri(#[from] UriError),
    /// The file system returned an error.
    #[error("expected a readable file at {}, found: {error}; put it there or fix the URI", path.display())]
    Read {
        /// Relative to the document.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// Files are missing.
    #[error("{}", missing(paths))]
    Missing {
        /// Relative to the document, in its order.
        paths: Vec<PathBuf>,
    },
    /// A file holds something else than the bytes of a buffer.
    #[error("expected the bytes of a buffer at {}, found {found}", path.display())]
    Foreign {
        /// Relative to the document.
        path: PathBuf,
        /// What the file is.
        found: Foreign,
    },
    /// A file holds something else than an image.
    #[error("expected an image at {}, found {found}", path.display())]
    ForeignImage {
        /// Relative to the document.
        path: PathBuf,
        /// What the file is.
        found: Foreign,
    },
    /// A buffer view leads nowhere.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// A buffer is shorter than the document declares.
    #[error(
        "expected buffer {buffer} to hold the {expected} bytes that it declares, found {found}; export the asset again"
    )]
    ShortBuffer {
        /// Index into `buffers`.
        buffer: usize,
        /// Bytes that the document declares.
        expected: usize,
        /// Bytes in the file.
        found: usize,
    },
    /// A buffer has neither a BIN chunk nor a URI.
    #[error("expected buffer {buffer} in a BIN chunk or at a URI, found neither; export the asset again")]
    NoBuffer {
        /// Index into `buffers`.
        buffer: usize,
    },
}

/// Files that an error lists by name. Further files are counted.
const MAX_NAMED: usize = 10;

/// Returns the message about missing files.
fn missing(paths: &[PathBuf]) -> String {
    let names: Vec<String> = paths.iter().take(MAX_NAMED).map(|path| path.display().to_string()).collect();
    let names = names.join(", ");
    match paths.len() {
        0 | 1 => format!("expected a readable file at {names}, found none; put it there or fix the URI"),
        count => {
            let more = count.saturating_sub(MAX_NAMED);
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            format!("expected readable files at {names}{more}, found none; put them there or fix their URIs")
        }
    }
}

/// Largest data URI that is decoded, in bytes: more than a texture of the largest allowed size has.
pub(super) const MAX_DATA_URI: usize = 2 << 30;

impl<'a> Source<'a> {
    /// Returns a source whose outputs have its own name.
    pub fn new(stem: &'a str, document: &'a Document, files: &'a dyn Files) -> Self {
        Self { stem, output_stem: stem, document, files }
    }

    /// Reads the bytes that `uri` names.
    pub fn uri(&self, uri: &str) -> Result<Vec<u8>, SourceError> {
        self.uri_by(uri, |path| self.files.read(path))
    }

    pub(super) fn uri_by(
        &self,
        uri: &str,
        read: impl Fn(&Path) -> io::Result<Vec<u8>>,
    ) -> Result<Vec<u8>, SourceError> {
        match Uri::parse(uri)? {
            Uri::Data(data) => Ok(data.decode(MAX_DATA_URI)?),
            Uri::Path(path) => read(&path).map_err(|error| SourceError::Read { path, error }),
        }
    }

    /// Reads the bytes of an image.
    pub fn image(&self, location: &ImageLocation) -> Result<Vec<u8>, SourceError> {
        match location {
            ImageLocation::Uri(uri) => self.uri(uri),
            ImageLocation::BufferView(view) => {
                let (buffer, range) = self.document.buffer_view(*view)?;
                let bytes = self.buffer(buffer)?;
                let short = SourceError::ShortBuffer { buffer, expected: range.end, found: bytes.len() };
                bytes.get(range).map(<[u8]>::to_vec).ok_or(short)
            }
        }
    }

    /// Reads the bytes of a buffer.
    pub fn buffer(&self, index: usize) -> Result<Vec<u8>, SourceError> {
        let uri: Option<String> =
            self.document.json().read(&format!("/buffers/{index}/uri")).map_err(DocumentError::from)?;
        match uri {
            Some(uri) => self.uri(&uri),
            None if index == 0 => {
                self.document.bin().map(<[u8]>::to_vec).ok_or(SourceError::NoBuffer { buffer: index })
            }
            None => Err(SourceError::NoBuffer { buffer: index }),
        }
    }
}
