//! The sources of a baked asset, for comparison with the recorded digests.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use crate::bake::Source;
use crate::digest::{Digest, digest};
use crate::gltf::document::Document;
use crate::gltf::texture::ImageLocation;

/// The sources of one baked asset. Each digest is computed once.
pub struct SourceDigests<'a> {
    document: Option<Document>,
    read: &'a (dyn Fn(&Path) -> io::Result<Vec<u8>> + Sync),
    digests: RefCell<BTreeMap<String, Result<Vec<Digest>, String>>>,
}

impl<'a> SourceDigests<'a> {
    /// Takes the files beside the source `document`, or beside a standalone map if `document` is `None`. `read` takes
    /// paths relative to the source.
    pub fn new(document: Option<Document>, read: &'a (dyn Fn(&Path) -> io::Result<Vec<u8>> + Sync)) -> Self {
        Self { document, read, digests: RefCell::default() }
    }

    /// Returns the BLAKE3 digests of the sources that the provenance names `uri`; several if the name is not unique.
    pub fn digests(&self, uri: &str) -> Result<Vec<Digest>, String> {
        self.digests.borrow_mut().entry(uri.to_owned()).or_insert_with(|| self.hash(uri)).clone()
    }

    /// Returns the source document and its digest.
    pub fn document(&self) -> Option<(&Document, Digest)> {
        let document = self.document.as_ref()?;
        Some((document, digest(&document.to_bytes().ok()?)))
    }

    fn hash(&self, uri: &str) -> Result<Vec<Digest>, String> {
        let locations = self.locations(uri);
        if locations.is_empty() {
            return Err("no such image in the source document".to_owned());
        }
        let hash = |location| Ok(digest(&self.bytes(location)?));
        locations.iter().map(hash).collect()
    }

    fn bytes(&self, location: &ImageLocation) -> Result<Vec<u8>, String> {
        match (&self.document, location) {
            (Some(document), _) => Source::new("", document, &self.read).image(location).map_err(|e| e.to_string()),
            // `map` records file names without folders, and no URIs. A folder in this name is not to be trusted.
            (None, ImageLocation::Uri(name)) => {
                let name = Path::new(name).file_name().ok_or("a path without a file name")?;
                (self.read)(Path::new(name)).map_err(|e| e.to_string())
            }
            (None, ImageLocation::BufferView(_)) => Err("a buffer view without a source document".to_owned()),
        }
    }

    /// Returns the images that the recorded name may mean: a bake records only the beginning of a data URI.
    fn locations(&self, uri: &str) -> Vec<ImageLocation> {
        let view = uri.strip_prefix("bufferViews[").and_then(|rest| rest.strip_suffix(']')?.parse().ok());
        if let Some(view) = view {
            return vec![ImageLocation::BufferView(view)];
        }
        let Some(start) = uri.strip_suffix("...").filter(|start| start.starts_with("data:")) else {
            return vec![ImageLocation::Uri(uri.to_owned())];
        };
        let Some(json) = self.document.as_ref().map(Document::json) else { return Vec::new() };
        let uris = (0..json.len("/images").unwrap_or(0)).filter_map(|i| json.read(&format!("/images/{i}/uri")).ok()?);
        uris.filter(|uri: &String| uri.starts_with(start)).map(ImageLocation::Uri).collect()
    }
}
