//! What is known of a job that was run.

use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::bake::Baked;
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
    /// What was baked as `document`.
    pub fn new(document: &Path, baked: &Baked) -> Self {
        let name = document.file_name().map(PathBuf::from).unwrap_or_default();
        let stored = |path: &Path, bytes: &[u8]| Stored {
            path: path.to_owned(),
            blake3: digest(bytes),
            bytes: bytes.len() as u64,
        };
        Self {
            document: stored(&name, &baked.document),
            files: baked.files.iter().map(|file| stored(&file.path, &file.bytes)).collect(),
            copies: baked.copies.clone(),
            report: baked.report.clone(),
        }
    }

    /// All stored files, the document last: whoever sees it sees everything that it names.
    pub fn stored(&self) -> impl Iterator<Item = &Stored> {
        self.files.iter().chain([&self.document])
    }

    /// As it is kept: a digest, then JSON.
    ///
    /// # Errors
    /// Where a path is not UTF-8.
    pub fn to_bytes(&self) -> serde_json::Result<Vec<u8>> {
        let json = serde_json::to_vec(self)?;
        Ok([digest(&json).as_bytes(), &json].concat())
    }

    /// The entry that `bytes` keep; `None` if they are not what was written.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        let (_, json) =
            bytes.split_at_checked(DIGEST_LENGTH).filter(|(named, rest)| digest(rest).as_bytes() == *named)?;
        serde_json::from_slice::<Self>(json).ok().filter(Self::is_contained)
    }

    /// Whether all stored files belong below the output folder: nobody's cache writes elsewhere.
    fn is_contained(&self) -> bool {
        let mut parts = self.stored().flat_map(|stored| stored.path.components());
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
