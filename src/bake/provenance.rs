//! What an output document records of its making; its textures record theirs.

use std::ffi::OsStr;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::asset::BakeError;
use super::container;
use super::reader::Reader;
use crate::digest::{Digest, digest};
use crate::gltf::document::Document;
use crate::gltf::json::Json;
use crate::gltf::uri::encode_path;
use crate::texture::ktx2::SourceDigest;

/// What an output document was made from, besides the images of its baked textures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DocumentProvenance {
    /// Of the tool.
    pub version: String,
    /// The digest of the source document.
    pub document: Digest,
    /// Buffers and images that it names and that were taken over as they are.
    pub files: Vec<SourceDigest>,
}

impl DocumentProvenance {
    /// Where it stands: glTF keeps `extras` for applications, and engines pass over them.
    pub const PLACE: &str = "/asset/extras/roughcast";

    /// Records what is baked from the source of `reader`, without the files that `is_told` says textures tell of.
    ///
    /// # Errors
    /// [`BakeError`] where the document cannot be written. Files that cannot be read are left out.
    pub fn new(reader: &Reader<'_>, is_told: impl Fn(&Path) -> bool) -> Result<Self, BakeError> {
        let mut files = Vec::new();
        for path in container::files(reader.source.document.json())? {
            if !is_told(&path)
                && let Some(blake3) = reader.digest(&path)
            {
                let names: Vec<_> = path.iter().map(OsStr::to_string_lossy).collect();
                files.push(SourceDigest { uri: encode_path(&names.join("/")), blake3 });
            }
        }
        let document = digest(&reader.source.document.to_bytes()?);
        Ok(Self { version: env!("CARGO_PKG_VERSION").to_owned(), document, files })
    }

    /// Writes it into `json`, unless somebody else's `extras` leave no place for it.
    ///
    /// # Errors
    /// [`BakeError`] where `json` is no document.
    pub fn write(&self, json: &mut Json) -> Result<(), BakeError> {
        if json.value("/asset/extras")?.is_none_or(|extras| extras.is_object()) {
            json.set(Self::PLACE, self)?;
        }
        Ok(())
    }

    /// What `document` records; `None` where it is nothing, or nothing that can be read.
    pub fn read(document: &Document) -> Option<Self> {
        let value: Value = document.json().value(Self::PLACE).ok()??;
        serde_json::from_value(value).ok()
    }
}
