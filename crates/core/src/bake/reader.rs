//! Step 1: the buffers and images of a document. Each buffer is read once for all images and meshes in it.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;
use serde_json::Value;

use super::source::{MAX_DATA_URI, Source, SourceError};
use crate::digest::{Digest, digest};
use crate::foreign::Foreign;
use crate::gltf::document::{DocumentError, view_range};
use crate::gltf::json::JsonError;
use crate::gltf::texture::ImageLocation;
use crate::gltf::uri::Uri;

/// A source whose buffers have been read and checked.
pub struct Reader<'a> {
    /// The document and its files.
    pub source: &'a Source<'a>,
    /// The document's JSON.
    pub root: &'a Value,
    buffers: Vec<Bytes<'a>>,
    /// BLAKE3 digests of the files of buffers.
    digests: BTreeMap<PathBuf, Digest>,
}

/// The bytes of a buffer.
enum Bytes<'a> {
    /// Neither a chunk nor a file holds them. That is legal: the buffer may be the fallback of compressed buffers.
    Absent,
    /// They were read, and the bake does not need them.
    Unneeded,
    /// The BIN chunk.
    Chunk(&'a [u8]),
    /// A data URI, or a file, which several buffers may share.
    Read(Arc<Vec<u8>>),
}

/// The length of a file or a data URI, and its bytes if something needs them.
#[derive(Clone)]
struct Held {
    length: usize,
    bytes: Option<Arc<Vec<u8>>>,
}

impl Held {
    fn new(bytes: Vec<u8>, is_needed: bool) -> Self {
        Self { length: bytes.len(), bytes: is_needed.then(|| Arc::new(bytes)) }
    }

    fn bytes<'a>(self) -> (usize, Bytes<'a>) {
        (self.length, self.bytes.map_or(Bytes::Unneeded, Bytes::Read))
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Buffer {
    uri: Option<String>,
    byte_length: usize,
}

impl<'a> Reader<'a> {
    /// Reads every buffer of `source`, whose JSON is `root`, and checks that it is as long as declared. Keeps the bytes
    /// of buffers with images, or of all buffers if `keeps_all`.
    ///
    /// # Errors
    /// [`SourceError`] for the first buffer that cannot be read or is too short.
    pub fn new(source: &'a Source<'a>, root: &'a Value, keeps_all: bool) -> Result<Self, SourceError> {
        let mut reader = Self { source, root, buffers: Vec::new(), digests: BTreeMap::new() };
        let has_images = buffers_of_images(root);
        let mut files = HashMap::new();
        let list = root.get("buffers").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        for (index, value) in list.iter().enumerate() {
            let wrong = |source| JsonError::Read { pointer: format!("/buffers/{index}"), source };
            let Buffer { uri, byte_length } =
                Buffer::deserialize(value).map_err(|error| DocumentError::from(wrong(error)))?;
            let is_needed = keeps_all || has_images.get(index) == Some(&true);
            let found = match uri.as_deref().map(Uri::parse).transpose()? {
                None => {
                    (index == 0).then(|| source.document.buffer_0()).flatten().map(|bin| (bin.len(), Bytes::Chunk(bin)))
                }
                Some(Uri::Data(data)) => Some(Held::new(data.decode(MAX_DATA_URI)?, is_needed).bytes()),
                Some(Uri::Path(path)) => Some(reader.file(path, byte_length, is_needed, &mut files)?.bytes()),
            };
            let (length, bytes) = found.unwrap_or((byte_length, Bytes::Absent));
            if length < byte_length {
                return Err(SourceError::ShortBuffer { buffer: index, expected: byte_length, found: length });
            }
            reader.buffers.push(bytes);
        }
        Ok(reader)
    }

    /// Returns the file at `path`, of which a buffer needs `length` bytes, from `files` or by reading it. A file that
    /// no earlier buffer needed to keep is read a second time.
    fn file(
        &mut self,
        path: PathBuf,
        length: usize,
        is_needed: bool,
        files: &mut HashMap<PathBuf, Held>,
    ) -> Result<Held, SourceError> {
        if let Some(held) = files.get(&path).filter(|held| held.bytes.is_some() || !is_needed) {
            return Ok(held.clone());
        }
        let planned = self.source.files.known_length(&path).and_then(|planned| usize::try_from(planned).ok());
        if let Some(planned) = planned.filter(|planned| !is_needed && *planned >= length) {
            let held = Held { length: planned, bytes: None };
            files.insert(path, held.clone());
            return Ok(held);
        }
        let bytes = self.read(&path)?;
        if let Some(found) = Foreign::detect(&bytes).filter(|_| bytes.len() < length) {
            return Err(SourceError::Foreign { path, found });
        }
        let held = Held::new(bytes, is_needed);
        files.insert(path, held.clone());
        Ok(held)
    }

    /// Reads and hashes a file.
    fn read(&mut self, path: &Path) -> Result<Vec<u8>, SourceError> {
        let failed = |error: io::Error| SourceError::Read { path: path.to_owned(), error };
        let bytes = self.source.files.read_to_hash(path).map_err(failed)?;
        let digest = digest(&bytes);
        self.source.files.hashed(path, digest);
        self.digests.insert(path.to_owned(), digest);
        Ok(bytes)
    }

    /// Returns the bytes of a buffer that is kept.
    ///
    /// # Errors
    /// [`SourceError::NoBuffer`].
    pub fn buffer(&self, index: usize) -> Result<&[u8], SourceError> {
        match self.buffers.get(index) {
            Some(Bytes::Chunk(bin)) => Ok(bin),
            Some(Bytes::Read(bytes)) => Ok(bytes),
            Some(Bytes::Absent | Bytes::Unneeded) | None => Err(SourceError::NoBuffer { buffer: index }),
        }
    }

    /// Reads the bytes of an image.
    ///
    /// # Errors
    /// [`SourceError`].
    pub fn image(&self, location: &ImageLocation) -> Result<Cow<'_, [u8]>, SourceError> {
        match location {
            ImageLocation::Uri(uri) => self.source.uri(uri).map(Cow::Owned),
            ImageLocation::BufferView(view) => self.view(*view).map(Cow::Borrowed),
        }
    }

    /// Reads the bytes of an image for a caller who reports their digest to [`Self::hashed`].
    ///
    /// # Errors
    /// [`SourceError`].
    pub fn image_to_hash(&self, location: &ImageLocation) -> Result<Cow<'_, [u8]>, SourceError> {
        match location {
            ImageLocation::Uri(uri) => {
                self.source.uri_by(uri, |path| self.source.files.read_to_hash(path)).map(Cow::Owned)
            }
            ImageLocation::BufferView(view) => self.view(*view).map(Cow::Borrowed),
        }
    }

    /// Records the BLAKE3 digest of an image that [`Self::image_to_hash`] read.
    pub fn hashed(&self, location: &ImageLocation, blake3: Digest) {
        if let ImageLocation::Uri(uri) = location
            && let Ok(Uri::Path(path)) = Uri::parse(uri)
        {
            self.source.files.hashed(&path, blake3);
        }
    }

    fn view(&self, view: usize) -> Result<&[u8], SourceError> {
        let (buffer, range) = view_range(self.root, view)?;
        let bytes = self.buffer(buffer)?;
        let short = SourceError::ShortBuffer { buffer, expected: range.end, found: bytes.len() };
        bytes.get(range).ok_or(short)
    }

    /// Returns the BLAKE3 digest of a file that the document names; `None` if the file cannot be read.
    pub fn digest(&self, path: &Path) -> Option<Digest> {
        self.digests.get(path).copied().or_else(|| self.source.files.digest(path).ok())
    }
}

/// Returns for each buffer whether it holds an image.
fn buffers_of_images(root: &Value) -> Vec<bool> {
    let mut has_images = Vec::new();
    let images = root.get("images").and_then(Value::as_array).into_iter().flatten();
    let views = images.filter_map(|image| usize::try_from(image.get("bufferView")?.as_u64()?).ok());
    for (buffer, _) in views.filter_map(|view| view_range(root, view).ok()) {
        has_images.resize(has_images.len().max(buffer + 1), false);
        has_images[buffer] = true;
    }
    has_images
}

#[cfg(test)]
mod tests;
