//! Reading what a document refers to.

use std::io;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::gltf::document::{Document, DocumentError};
use crate::gltf::texture::ImageLocation;
use crate::gltf::uri::{Uri, UriError};

/// The files beside a document, by their paths relative to it. A function that reads them is enough.
pub trait Files: Sync {
    /// Reads a file.
    ///
    /// # Errors
    /// Those of the file system.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// The same for a caller who hashes what is read beside other work, and then tells [`Self::hashed`]: nothing is hashed twice.
    ///
    /// # Errors
    /// Those of the file system.
    fn read_to_hash(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.read(path)
    }

    /// Takes note of the BLAKE3, in hexadecimal, of what [`Self::read_to_hash`] read.
    fn hashed(&self, _path: &Path, _blake3: &str) {}
}

impl<F: Fn(&Path) -> io::Result<Vec<u8>> + Sync> Files for F {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self(path)
    }
}

/// A document and the files beside it.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// File name without extension; output files are named after it.
    pub stem: &'a str,
    /// The document.
    pub document: &'a Document,
    /// The files.
    pub files: &'a dyn Files,
}

/// Why bytes cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// The URI is not one that is read.
    #[error(transparent)]
    Uri(#[from] UriError),
    /// The file system refused.
    #[error("expected a readable file at {}, found: {error}; put it there or fix the URI", path.display())]
    Read {
        /// Relative to the document.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// A buffer view leads nowhere.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// A buffer is shorter than it says.
    #[error(
        "expected buffer {buffer} to hold the {expected} bytes that it declares, found {found}; export the asset again"
    )]
    ShortBuffer {
        /// Index into `buffers`.
        buffer: usize,
        /// Bytes needed.
        expected: usize,
        /// Bytes there are.
        found: usize,
    },
    /// A buffer that is neither in the file nor named.
    #[error("expected buffer {buffer} in a BIN chunk or at a URI, found neither; export the asset again")]
    NoBuffer {
        /// Index into `buffers`.
        buffer: usize,
    },
}

/// Largest data URI that is decoded: more than any texture of the largest size allowed.
const MAX_DATA_URI: usize = 2 << 30;

impl Source<'_> {
    /// The bytes that `uri` names.
    pub fn uri(&self, uri: &str) -> Result<Vec<u8>, SourceError> {
        self.uri_by(uri, |path| self.files.read(path))
    }

    fn uri_by(&self, uri: &str, read: impl Fn(&Path) -> io::Result<Vec<u8>>) -> Result<Vec<u8>, SourceError> {
        match Uri::parse(uri)? {
            Uri::Data(data) => Ok(data.decode(MAX_DATA_URI)?),
            Uri::Path(path) => read(&path).map_err(|error| SourceError::Read { path, error }),
        }
    }

    /// The bytes of an image file, for a caller who tells [`Self::hashed`] of them.
    pub fn image_to_hash(&self, location: &ImageLocation) -> Result<Vec<u8>, SourceError> {
        match location {
            ImageLocation::Uri(uri) => self.uri_by(uri, |path| self.files.read_to_hash(path)),
            ImageLocation::BufferView(_) => self.image(location),
        }
    }

    /// Takes note of the BLAKE3, in hexadecimal, of what [`Self::image_to_hash`] read.
    pub fn hashed(&self, location: &ImageLocation, blake3: &str) {
        if let ImageLocation::Uri(uri) = location
            && let Ok(Uri::Path(path)) = Uri::parse(uri)
        {
            self.files.hashed(&path, blake3);
        }
    }

    /// The bytes of an image file.
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

    /// The bytes of a buffer.
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

    /// Checks that every buffer that is there holds the bytes that it declares. A buffer without data is legal: it may be
    /// the fallback of compressed ones.
    pub fn check_buffers(&self) -> Result<(), SourceError> {
        #[derive(Deserialize)]
        #[serde(rename_all = "camelCase")]
        struct Buffer {
            uri: Option<String>,
            byte_length: usize,
        }
        let buffers: Vec<Buffer> =
            self.document.json().read("/buffers").map_err(DocumentError::from)?.unwrap_or_default();
        for (index, Buffer { uri, byte_length: expected }) in buffers.iter().enumerate() {
            let has_bytes = uri.is_some() || (index == 0 && self.document.bin().is_some());
            let found = if has_bytes { self.buffer(index)?.len() } else { *expected };
            if found < *expected {
                return Err(SourceError::ShortBuffer { buffer: index, expected: *expected, found });
            }
        }
        Ok(())
    }
}
