//! What is known of a job that was run.

use std::path::{Component, PathBuf};

use serde::{Deserialize, Serialize};

use crate::bake::report::AssetReport;
use crate::digest::digest;

/// Hexadecimal digits of a BLAKE3 digest.
const DIGEST_LENGTH: usize = 64;

/// The outputs of a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Entry {
    /// The document, by its name in the output folder.
    pub document: Stored,
    /// New files, relative to the document.
    pub files: Vec<Stored>,
    /// Inputs that the document still refers to, relative to it: not stored, since the job has them.
    pub copies: Vec<PathBuf>,
    /// What was baked.
    pub report: AssetReport,
}

impl Entry {
    /// Reads what [`Self::to_bytes`] wrote; `None` for anything else, and where a file belongs elsewhere.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        let (named, json) = bytes.split_at_checked(DIGEST_LENGTH)?;
        let is_whole = digest(json).as_bytes() == named;
        let entry = is_whole.then(|| serde_json::from_slice::<Self>(json).ok())?;
        entry.filter(Self::is_contained)
    }

    /// The file that holds it: a BLAKE3 of the rest in hex, and JSON.
    ///
    /// # Errors
    /// None in practice: names that are not UTF-8.
    pub fn to_bytes(&self) -> Result<Vec<u8>, serde_json::Error> {
        let json = serde_json::to_vec(self)?;
        Ok([digest(&json).as_bytes(), &json].concat())
    }

    /// Whether all stored files belong below the output folder: nobody's cache writes elsewhere.
    pub fn is_contained(&self) -> bool {
        let mut parts = self.files.iter().chain([&self.document]).flat_map(|stored| stored.path.components());
        parts.all(|part| matches!(part, Component::Normal(_)))
    }
}

/// A file that a blob holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Stored {
    /// Where it belongs.
    pub path: PathBuf,
    /// BLAKE3 of its bytes in hex.
    pub blake3: String,
    /// Its length.
    pub bytes: u64,
}
