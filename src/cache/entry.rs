//! What is known of a job that was run.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::relative::{NotRelative, RelativePath};
use crate::bake::Baked;
use crate::digest::{Digest, digest};
use crate::report::AssetReport;

/// Hexadecimal digits of the digest that an entry begins with.
const DIGEST_LENGTH: usize = 64;

/// An entry lists a few files and notes.
pub(super) const MAX_ENTRY_BYTES: u64 = 64 << 20;

/// The format of entries. What an earlier build wrote is not found.
const FORMAT: u32 = 2;

/// The outputs of a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Entry {
    format: u32,
    /// The id of the job.
    pub job: Digest,
    /// The document, by its name in the output folder.
    pub document: Stored,
    /// New files, relative to the document.
    pub files: Vec<Stored>,
    /// Inputs that the document still refers to, relative to it: not stored, since the job has them.
    pub copies: Vec<RelativePath>,
    /// What was baked.
    pub report: AssetReport,
}

/// Why an entry cannot be used for a job.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unusable {
    /// Other bytes than were written, or paths and digests that are none.
    #[error("other bytes than were stored")]
    Damaged,
    /// The entry of another job.
    #[error("the one of job {0:.12}")]
    OtherJob(Digest),
    /// Another document than the job writes.
    #[error("one with the document {:?}, which the job does not write", .0.as_path())]
    Document(RelativePath),
    /// A file that the job does not write.
    #[error("one with the file {:?}, which the job does not write", .0.as_path())]
    File(RelativePath),
    /// A copy of a file that the job does not read.
    #[error("one with a copy of {:?}, which the job does not read", .0.as_path())]
    Copy(RelativePath),
    /// A declared output of the job is not in the entry.
    #[error("one without {0:?}, which the job writes")]
    Missing(PathBuf),
}

/// Says whether an entry has what its job writes, and nothing else.
pub type Fits<'f> = &'f (dyn Fn(&Entry) -> Result<(), Unusable> + Sync);

impl Entry {
    /// Returns the entry of `job`, which baked `document`.
    ///
    /// # Errors
    /// [`NotRelative`] for a file that is not below the folder of `document`.
    pub fn new(job: Digest, document: &Path, baked: &Baked) -> Result<Self, NotRelative> {
        let name = Path::new(document.file_name().unwrap_or_default());
        let stored = |path: &Path, bytes: &[u8]| -> Result<Stored, NotRelative> {
            Ok(Stored { path: path.try_into()?, blake3: digest(bytes), bytes: bytes.len() as u64 })
        };
        let files: Result<_, _> = baked.files.iter().map(|file| stored(&file.path, &file.bytes)).collect();
        let copies: Result<_, _> = baked.copies.iter().map(|copy| copy.as_path().try_into()).collect();
        Ok(Self {
            format: FORMAT,
            job,
            document: stored(name, &baked.document)?,
            files: files?,
            copies: copies?,
            report: baked.report.clone(),
        })
    }

    /// All stored files, the document last: whoever sees it sees everything that it names.
    pub fn stored(&self) -> impl Iterator<Item = &Stored> {
        self.files.iter().chain([&self.document])
    }

    /// Returns the entry as it is kept: a digest, then JSON.
    ///
    /// # Errors
    /// Those of the report, if it cannot be written as JSON.
    pub fn to_bytes(&self) -> serde_json::Result<Vec<u8>> {
        let json = serde_json::to_vec(self)?;
        Ok([digest(&json).to_string().as_bytes(), &json].concat())
    }

    /// Returns the entry of `job` that `bytes` keep, or `None` if they are of another format.
    ///
    /// # Errors
    /// [`Unusable`] for anything but an entry of `job` that `fits`.
    pub fn read(bytes: &[u8], job: Digest, fits: Fits<'_>) -> Result<Option<Self>, Unusable> {
        #[derive(Deserialize)]
        struct Head {
            #[serde(default)]
            format: u32,
        }
        let (named, json) = bytes.split_at_checked(DIGEST_LENGTH).ok_or(Unusable::Damaged)?;
        if digest(json).to_string().as_bytes() != named {
            return Err(Unusable::Damaged);
        }
        let head: Head = serde_json::from_slice(json).map_err(|_| Unusable::Damaged)?;
        if head.format != FORMAT {
            return Ok(None);
        }
        let entry: Self = serde_json::from_slice(json).map_err(|_| Unusable::Damaged)?;
        if entry.job != job {
            return Err(Unusable::OtherJob(entry.job));
        }
        fits(&entry).map(|()| Some(entry))
    }
}

/// A file that a blob holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Stored {
    /// Where it belongs.
    pub path: RelativePath,
    /// The digest of its bytes, which names the blob.
    pub blake3: Digest,
    /// Its length.
    pub bytes: u64,
}
