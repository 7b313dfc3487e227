//! The provenance of an output document. Each texture has a provenance of its own.

use std::ffi::OsStr;
use std::path::Path;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::error::BakeError;
use super::new_file::NewFile;
use super::output_document;
use super::reader::Reader;
use crate::digest::{Digest, digest};
use crate::gltf::document::{Container, Document};
use crate::gltf::json::Json;
use crate::gltf::uri::encode_path;
use crate::ktx2::SourceDigest;

/// What an output document was made of, besides the images of its baked textures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DocumentProvenance {
    /// Version of the tool.
    pub version: String,
    /// File name of the source document, whose extension shows the kind of document. Early versions recorded no name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// The digest of the source document.
    pub document: Digest,
    /// Buffers and images that the document names and that the bake left unchanged.
    pub files: Vec<SourceDigest>,
    /// New files beside the document.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outputs: Vec<SourceDigest>,
}

impl DocumentProvenance {
    /// JSON pointer of the provenance. glTF reserves `extras` for applications, and engines ignore it.
    pub const POINTER: &str = "/asset/extras/roughcast";

    /// Records the source of `reader` and the new files `outputs`. Source files for which `is_recorded` holds are left
    /// out, since textures record them.
    ///
    /// # Errors
    /// [`BakeError`] if the document cannot be written. Files that cannot be read are left out.
    pub fn new(
        reader: &Reader<'_>,
        outputs: &[NewFile],
        is_recorded: impl Fn(&Path) -> bool,
    ) -> Result<Self, BakeError> {
        let source = reader.source;
        let mut files = Vec::new();
        for path in output_document::files(source.document.json())? {
            if !is_recorded(&path)
                && let Some(blake3) = reader.digest(&path)
            {
                files.push(SourceDigest { uri: uri(&path), blake3 });
            }
        }
        let outputs = outputs.par_iter().map(|file| SourceDigest { uri: uri(&file.path), blake3: digest(&file.bytes) });
        Ok(Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            source: Some(Self::source_name(source.stem, source.document.container())),
            document: digest(&source.document.to_bytes()?),
            files,
            outputs: outputs.collect(),
        })
    }

    /// Returns the name by which a source document is recorded. The extension goes by the content of the document.
    pub fn source_name(stem: &str, container: Container) -> String {
        format!("{stem}.{}", if container == Container::Glb { "glb" } else { "gltf" })
    }

    /// Writes the provenance into `json`, unless `extras` of another application is no object.
    ///
    /// # Errors
    /// [`BakeError`] if `json` is no document.
    pub fn write(&self, json: &mut Json) -> Result<(), BakeError> {
        if json.value("/asset/extras")?.is_none_or(|extras| extras.is_object()) {
            json.set(Self::POINTER, self)?;
        }
        Ok(())
    }

    /// Reads the provenance of `document`; `None` if there is none, or none that can be read.
    pub fn read(document: &Document) -> Option<Self> {
        let value: Value = document.json().value(Self::POINTER).ok()??;
        serde_json::from_value(value).ok()
    }
}

/// Returns the URI of a file beside the document.
fn uri(path: &Path) -> String {
    let names: Vec<_> = path.iter().map(OsStr::to_string_lossy).collect();
    encode_path(&names.join("/"))
}
