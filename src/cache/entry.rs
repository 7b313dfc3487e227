//! What is known of a job that was run.

use std::path::{Component, PathBuf};

use serde::{Deserialize, Serialize};

use crate::bake::report::AssetReport;

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
