//! The provenance of a baked texture, as JSON in its key/value data.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::digest::Digest;
use crate::ktx2::read::Ktx2;
use crate::ktx2::write::Key;

/// The key of the provenance. A texture with this key was baked.
pub const PROVENANCE_KEY: &str = "roughcast";

/// The value of the key. A bake writes typed settings. They are read as a [`Value`], since another version of the tool
/// may have recorded other settings, which `check` compares and `inspect` prints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance<S = Value> {
    /// Version of the tool.
    pub version: String,
    /// What the texels are: `normal`, `roughness`, `anisotropy`, `offset`, `factor` or `lambda1`.
    pub content: String,
    /// All settings that change the bytes.
    pub settings: S,
    /// Mean lobe error of the material for each level of its bump map, from the finest level that can be sampled. Empty
    /// if errors were not measured.
    #[serde(default, rename = "lobeErrors", skip_serializing_if = "Vec::is_empty")]
    pub lobe_errors: Vec<f32>,
    /// The images from which the texture was made.
    pub sources: Vec<SourceDigest>,
}

/// The digest of a source image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourceDigest {
    /// Its URI in the source document, or `bufferViews[n]`.
    pub uri: String,
    /// The digest of its bytes.
    pub blake3: Digest,
}

impl<S: Serialize> Provenance<S> {
    /// Returns the keys to write: the writer's name, which KTX asks for, and the provenance.
    pub fn keys(&self) -> Vec<Key> {
        // JSON refuses maps whose keys are no strings, and values that refuse to be serialised; there are neither here.
        let value = serde_json::to_string(self).expect("strings, numbers and settings");
        vec![
            Key { key: "KTXwriter".to_owned(), value: format!("roughcast {}", self.version) },
            Key { key: PROVENANCE_KEY.to_owned(), value },
        ]
    }
}

/// Returns the provenance of a KTX2 file, or `None` if it has none that can be read.
pub fn provenance(file: &Ktx2<'_>) -> Option<Provenance> {
    let (_, value) = file.key_values().find(|(key, _)| *key == PROVENANCE_KEY)?;
    serde_json::from_slice(value.strip_suffix(b"\0").unwrap_or(value)).ok()
}
