//! The files that a document names, of which a check reads only the parts that it needs.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use serde_json::Value;

use super::partial_file::PartialFile;
use crate::bake::{Source, SourceError};
use crate::gltf::document::{Document, DocumentError};
use crate::gltf::texture::ImageLocation;
use crate::gltf::uri::Uri;

/// The files that a document names, by their paths relative to the document. Every function that reads whole files
/// implements this trait.
pub trait Files: Sync {
    /// Returns the number of bytes of a file.
    ///
    /// # Errors
    /// Those of the file system.
    fn length(&self, path: &Path) -> io::Result<u64>;

    /// Reads the bytes of `range` of a file.
    ///
    /// # Errors
    /// Those of the file system; [`io::ErrorKind::UnexpectedEof`] if the file ends before the range does.
    fn read(&self, path: &Path, range: Range<u64>) -> io::Result<Vec<u8>>;
}

impl<F: Fn(&Path) -> io::Result<Vec<u8>> + Sync> Files for F {
    fn length(&self, path: &Path) -> io::Result<u64> {
        Ok(self(path)?.len() as u64)
    }

    fn read(&self, path: &Path, range: Range<u64>) -> io::Result<Vec<u8>> {
        let bytes = self(path)?;
        let part = usize::try_from(range.start).ok().zip(usize::try_from(range.end).ok());
        let part = part.and_then(|(start, end)| bytes.get(start..end));
        part.map(<[u8]>::to_vec).ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
    }
}

/// The images and buffers of a document: in files, in data URIs and in its BIN chunk.
pub struct ReferencedFiles<'a> {
    document: &'a Document,
    root: &'a Value,
    files: &'a dyn Files,
    is_deep: bool,
    /// Buffers from data URIs, so that each is decoded once, however many images it contains.
    decoded: RefCell<BTreeMap<usize, Rc<Vec<u8>>>>,
}

impl<'a> ReferencedFiles<'a> {
    /// Takes the images and buffers of `document`, whose JSON is `root`. Images are read whole only if `is_deep`.
    pub fn new(document: &'a Document, root: &'a Value, files: &'a dyn Files, is_deep: bool) -> Self {
        Self { document, root, files, is_deep, decoded: RefCell::default() }
    }

    /// Reads an image.
    pub fn image(&self, location: &ImageLocation) -> Result<PartialFile, SourceError> {
        match location {
            ImageLocation::Uri(uri) => match Uri::parse(uri)? {
                Uri::Data(_) => Ok(PartialFile::whole(self.data(uri)?)),
                Uri::Path(path) => {
                    let length = self.length(&path)?;
                    self.partial_file(path, 0..length)
                }
            },
            ImageLocation::BufferView(view) => self.view(*view),
        }
    }

    /// Returns the number of bytes of the file or the data that the URI of a buffer names.
    pub fn buffer_length(&self, uri: &str) -> Result<u64, SourceError> {
        match Uri::parse(uri)? {
            Uri::Data(_) => Ok(self.data(uri)?.len() as u64),
            Uri::Path(path) => self.length(&path),
        }
    }

    fn length(&self, path: &Path) -> Result<u64, SourceError> {
        self.files.length(path).map_err(|error| SourceError::Read { path: path.to_owned(), error })
    }

    /// Reads the image in `range` of a file.
    fn partial_file(&self, path: PathBuf, range: Range<u64>) -> Result<PartialFile, SourceError> {
        let part = |part: Range<u64>| self.files.read(&path, range.start + part.start..range.start + part.end);
        let partial = PartialFile::read(range.end - range.start, self.is_deep, part);
        partial.map_err(|error| SourceError::Read { path: path.clone(), error })
    }

    /// Decodes a data URI.
    fn data(&self, uri: &str) -> Result<Vec<u8>, SourceError> {
        let files = |_: &Path| Err(io::ErrorKind::NotFound.into());
        Source::new("", self.document, &files).uri(uri)
    }

    /// Reads the image in buffer view `index`.
    fn view(&self, index: usize) -> Result<PartialFile, SourceError> {
        let to_usize = |n: u64| usize::try_from(n).unwrap_or(usize::MAX);
        let object = |array: &str, index: usize| {
            let pointer = format!("/{array}/{index}");
            self.root.pointer(&pointer).ok_or(DocumentError::Missing { pointer })
        };
        let number = |object: &Value, key: &str| object.get(key).and_then(Value::as_u64);
        let view = object("bufferViews", index)?;
        let buffer = number(view, "buffer").map_or(usize::MAX, to_usize);
        let (start, length) = (number(view, "byteOffset").unwrap_or(0), number(view, "byteLength").unwrap_or(0));
        let declared = object("buffers", buffer)?;
        let buffer_length = number(declared, "byteLength").unwrap_or(0);
        let end = start.checked_add(length).filter(|end| *end <= buffer_length);
        let outside = DocumentError::ViewOutside {
            view: index,
            offset: to_usize(start),
            length: to_usize(length),
            buffer,
            buffer_length: to_usize(buffer_length),
        };
        let range = start..end.ok_or(outside)?;
        let short = |found| SourceError::ShortBuffer { buffer, expected: to_usize(range.end), found };
        let part = |bytes: &[u8]| {
            let part = bytes.get(to_usize(range.start)..to_usize(range.end));
            part.map(|part| PartialFile::whole(part.to_vec())).ok_or_else(|| short(bytes.len()))
        };
        match declared.get("uri").and_then(Value::as_str) {
            None => part(self.document.bin().filter(|_| buffer == 0).ok_or(SourceError::NoBuffer { buffer })?),
            Some(uri) => match Uri::parse(uri)? {
                Uri::Data(_) => part(&self.decoded(buffer, uri)?),
                Uri::Path(path) => {
                    let length = self.length(&path)?;
                    if length < range.end { Err(short(to_usize(length))) } else { self.partial_file(path, range) }
                }
            },
        }
    }

    /// Decodes the data URI of a buffer once.
    fn decoded(&self, buffer: usize, uri: &str) -> Result<Rc<Vec<u8>>, SourceError> {
        if let Some(bytes) = self.decoded.borrow().get(&buffer) {
            return Ok(Rc::clone(bytes));
        }
        let bytes = Rc::new(self.data(uri)?);
        self.decoded.borrow_mut().insert(buffer, Rc::clone(&bytes));
        Ok(bytes)
    }
}
