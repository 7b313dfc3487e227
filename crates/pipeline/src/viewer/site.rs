//! What the server has: the page, the folder of each document, and the list of the documents.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};

use serde_json::json;

use super::error::ViewerError;
use super::variant::Variant;
use crate::gltf::uri::{encode_path, relative_path};
use crate::input_file::open_file;

/// The path of the list of documents, which the page reads.
const VARIANTS: &str = "view/variants.json";

/// A file of the page.
#[derive(Clone, Copy, Debug)]
pub struct PageFile {
    /// Its path in URLs, without the first `/`.
    pub path: &'static str,
    /// Its content.
    pub bytes: &'static [u8],
}

/// What the server has.
#[derive(Debug)]
pub struct Site {
    page: &'static [PageFile],
    variants: Vec<u8>,
    /// Real paths of the folders, by the first part of their URLs.
    folders: BTreeMap<String, PathBuf>,
}

/// The content at a URL.
pub struct Content {
    /// Its MIME type.
    pub kind: &'static str,
    /// The number of bytes.
    pub length: u64,
    /// The bytes.
    pub body: Box<dyn Read>,
}

impl Site {
    /// Makes a site of the page and of the folders of `files`. Each document has a folder of its own, since two
    /// documents may have files of one name.
    ///
    /// # Errors
    /// [`ViewerError`] for documents that do not exist or whose names do not fit into a URL.
    pub fn new(page: &'static [PageFile], files: &BTreeMap<Variant, PathBuf>) -> Result<Self, ViewerError> {
        let (mut folders, mut urls) = (BTreeMap::new(), BTreeMap::new());
        for (variant, path) in files {
            let name = path.file_name().unwrap_or_default();
            let name = name.to_str().ok_or_else(|| ViewerError::NotUtf8 { path: path.clone() })?;
            let url = encode_path(name);
            relative_path(&url).map_err(|reason| ViewerError::Name { path: path.clone(), reason })?;
            let root = real_folder(path).map_err(|reason| ViewerError::Read { path: path.clone(), reason })?;
            let folder = format!("asset-{}", variant.name());
            urls.insert(variant.name(), format!("/{folder}/{url}"));
            folders.insert(folder, root);
        }
        let variants = json!({ "variants": urls, "subject": "asset" }).to_string().into_bytes();
        Ok(Self { page, variants, folders })
    }

    /// Returns the content at the target of a request. Returns `None` if there is none, and for paths and links that
    /// lead out of a folder.
    pub fn find(&self, target: &str) -> Option<Content> {
        let path = target.split(['?', '#']).next()?.strip_prefix('/')?;
        if path == VARIANTS {
            return Some(Content::of_bytes(VARIANTS, self.variants.clone()));
        }
        if let Some(file) = self.page.iter().find(|file| file.path == path) {
            return Some(Content::of_bytes(file.path, file.bytes));
        }
        let (folder, below) = path.split_once('/')?;
        let root = self.folders.get(folder)?;
        let file = fs::canonicalize(root.join(relative_path(below).ok()?)).ok()?;
        if !file.starts_with(root) {
            return None;
        }
        let (body, length) = open_file(&file).ok()?;
        Some(Content { kind: kind(&file), length, body: Box::new(body) })
    }
}

impl Content {
    fn of_bytes(path: &str, bytes: impl Into<Cow<'static, [u8]>>) -> Self {
        let bytes = bytes.into();
        Self { kind: kind(Path::new(path)), length: bytes.len() as u64, body: Box::new(Cursor::new(bytes)) }
    }
}

/// Returns the folder of a file without links and dots.
fn real_folder(file: &Path) -> io::Result<PathBuf> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    fs::canonicalize(folder.unwrap_or(Path::new(".")))
}

/// Returns the MIME type of a file by its extension.
fn kind(path: &Path) -> &'static str {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    match extension.to_str().unwrap_or_default() {
        "css" => "text/css",
        "gltf" => "model/gltf+json",
        "glb" => "model/gltf-binary",
        "html" => "text/html",
        "jpg" | "jpeg" => "image/jpeg",
        "js" | "mjs" => "text/javascript",
        "json" => "application/json",
        "ktx2" => "image/ktx2",
        "png" => "image/png",
        "svg" => "image/svg+xml",
        "wasm" => "application/wasm",
        "webp" => "image/webp",
        _ => "application/octet-stream",
    }
}
