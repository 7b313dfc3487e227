//! Where a baked texture comes from, as JSON in its key/value data.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::digest::Digest;
use crate::ktx2::read::Ktx2;
use crate::ktx2::write::Key;

/// The key. Its presence marks a texture as baked.
pub const PROVENANCE_KEY: &str = "roughcast";

/// What the key holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of the tool.
    pub version: String,
    /// What the texels are: `normal`, `roughness`, `anisotropy`, `offset`, `factor` or `lambda1`.
    pub content: String,
    /// Everything that decides on the bytes but the sources.
    pub settings: Value,
    /// Mean lobe error of the material by level of its bump map, from the finest that can be sampled; empty where it was
    /// not judged.
    #[serde(default, rename = "lobeErrors", skip_serializing_if = "Vec::is_empty")]
    pub lobe_errors: Vec<f32>,
    /// The images that it was made from.
    pub sources: Vec<SourceDigest>,
}

/// The content of a source file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourceDigest {
    /// Its URI in the source document, or `bufferViews[n]`.
    pub uri: String,
    /// The digest of its bytes.
    pub blake3: Digest,
}

impl Provenance {
    /// The keys to write: the writer's name, which KTX asks for, and the provenance.
    pub fn keys(&self) -> Vec<Key> {
        let value = serde_json::to_string(self).expect("strings and JSON values serialise");
        vec![
            Key { key: "KTXwriter".to_owned(), value: format!("roughcast {}", self.version) },
            Key { key: PROVENANCE_KEY.to_owned(), value },
        ]
    }
}

/// The provenance in a KTX2 file; `None` when it has none that can be read.
pub fn provenance(file: &Ktx2<'_>) -> Option<Provenance> {
    let (_, value) = file.key_values().find(|(key, _)| *key == PROVENANCE_KEY)?;
    serde_json::from_slice(value.strip_suffix(b"\0").unwrap_or(value)).ok()
}
