//! Reading what a bake needs of a document's files: each buffer once, for all images and meshes in it.

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
    /// BLAKE3, in hexadecimal, of the files that buffers are.
    digests: BTreeMap<PathBuf, Digest>,
}

/// The bytes of a buffer.
enum Bytes<'a> {
    /// No one has them. That is legal: the buffer may be the fallback of compressed ones.
    Absent,
    /// They are there, and nothing in the bake needs them.
    Unneeded,
    /// The BIN chunk.
    Chunk(&'a [u8]),
    /// A file, which several buffers may be, or a data URI.
    Read(Arc<Vec<u8>>),
}

/// What was read of a file or a data URI: its length, and its bytes where something needs them.
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
    /// Reads every buffer of `source`, whose JSON is `root`, and checks that it holds the bytes that it declares. Keeps
    /// those with images, or all of them if `keeps_all`.
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

    /// The file at `path`, of which a buffer needs `length` bytes, from `files` or read. A file that earlier buffers
    /// did not need to keep is read a second time.
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

    /// The bytes of a buffer that is kept.
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

    /// The bytes of an image file.
    ///
    /// # Errors
    /// [`SourceError`].
    pub fn image(&self, location: &ImageLocation) -> Result<Cow<'_, [u8]>, SourceError> {
        match location {
            ImageLocation::Uri(uri) => self.source.uri(uri).map(Cow::Owned),
            ImageLocation::BufferView(view) => self.view(*view).map(Cow::Borrowed),
        }
    }

    /// The bytes of an image file, for a caller who tells [`Self::hashed`] of them.
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

    /// Takes note of the BLAKE3, in hexadecimal, of what [`Self::image_to_hash`] read.
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

    /// BLAKE3, in hexadecimal, of a file that the document names; `None` where it cannot be read.
    pub fn digest(&self, path: &Path) -> Option<Digest> {
        self.digests.get(path).copied().or_else(|| self.source.files.digest(path).ok())
    }
}

/// For each buffer whether an image lies in it.
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
mod tests {
    use super::*;
    use crate::gltf::document::Document;
    use serde_json::json;
    use std::sync::Mutex;

    /// Counts reads of files of 64 bytes.
    fn with_reader(root: &Value, keeps_all: bool, then: impl FnOnce(Result<Reader<'_>, SourceError>)) -> Vec<PathBuf> {
        let reads = Mutex::new(Vec::new());
        let files = |path: &Path| {
            reads.lock().unwrap().push(path.to_owned());
            Ok(vec![7; 64])
        };
        let document = Document::parse(root.to_string().as_bytes()).unwrap();
        then(Reader::new(&Source { stem: "a", document: &document, files: &files }, root, keeps_all));
        reads.into_inner().unwrap()
    }

    #[test]
    fn a_buffer_is_read_once_for_all_images_in_it() {
        let view = |buffer: usize, offset: usize| json!({ "buffer": buffer, "byteOffset": offset, "byteLength": 8 });
        let root = json!({
            "buffers": [{ "uri": "a.bin", "byteLength": 64 }, { "uri": "a.bin", "byteLength": 32 }],
            "bufferViews": [view(0, 0), view(0, 8), view(1, 16)],
            "images": [{ "bufferView": 0 }, { "bufferView": 1 }, { "bufferView": 2 }],
        });
        let reads = with_reader(&root, false, |reader| {
            let reader = reader.unwrap();
            for view in 0..3 {
                assert_eq!(*reader.image(&ImageLocation::BufferView(view)).unwrap(), [7; 8]);
            }
            assert_eq!(reader.digest(Path::new("a.bin")), Some(digest(&[7; 64])));
        });
        assert_eq!(reads, [Path::new("a.bin")]);
    }

    /// Many buffers may be one file: it is not read for each of them.
    #[test]
    fn a_file_is_read_once_for_all_buffers_in_it() {
        let buffers = vec![json!({ "uri": "a.bin", "byteLength": 64 }); 10_000];
        let root = json!({ "buffers": buffers });
        for keeps_all in [false, true] {
            let reads = with_reader(&root, keeps_all, |reader| {
                assert_eq!(reader.unwrap().buffer(9_999).is_ok(), keeps_all);
            });
            assert_eq!(reads.len(), 1);
        }
    }

    #[test]
    fn short_buffers_are_told() {
        let root = json!({ "buffers": [{ "uri": "a.bin", "byteLength": 65 }] });
        with_reader(&root, false, |reader| {
            let error = reader.err().unwrap();
            assert!(matches!(error, SourceError::ShortBuffer { buffer: 0, expected: 65, found: 64 }), "{error}");
        });
    }
}
