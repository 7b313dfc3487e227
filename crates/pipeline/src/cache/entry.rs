//! Cache entries: the outputs of a job that was run.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::relative::{NotRelative, RelativePath};
use crate::bake::BakedAsset;
use crate::digest::{Digest, digest};
use crate::report::{AssetReport, FormatError, check_format};

/// Hexadecimal digits of the digest that an entry begins with.
const DIGEST_LENGTH: usize = 64;

/// Longest entry that is read. An entry lists a few files and notes.
pub(super) const MAX_ENTRY_BYTES: u64 = 64 << 20;

/// The format version of entries.
pub const ENTRY_FORMAT: u32 = 4;

/// The outputs of a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Entry {
    /// The format version, [`ENTRY_FORMAT`].
    pub format_version: u32,
    /// The id of the job.
    pub job: Digest,
    /// The document, by its file name in the output folder.
    pub document: Stored,
    /// New files, with paths relative to the document.
    pub files: Vec<Stored>,
    /// Inputs that the document still refers to, relative to the document. They are not stored, since the job has them.
    pub copies: Vec<RelativePath>,
    /// The report of the bake.
    pub report: AssetReport,
}

/// Why an entry cannot be used for a job.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unusable {
    /// The bytes are not those that were written, or a path or digest is invalid.
    #[error("other bytes than were stored")]
    Damaged,
    /// An entry of another format, which another version of the tool wrote. A cache takes it for absent.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The entry of another job.
    #[error("the one of job {0:.12}")]
    OtherJob(Digest),
    /// The entry has another document than the job writes.
    #[error("one with the document {:?}, which the job does not write", .0.as_path())]
    Document(RelativePath),
    /// The entry has a file that the job does not write.
    #[error("one with the file {:?}, which the job does not write", .0.as_path())]
    File(RelativePath),
    /// The entry has a copy of a file that the job does not read.
    #[error("one with a copy of {:?}, which the job does not read", .0.as_path())]
    Copy(RelativePath),
    /// The entry lacks a declared output of the job.
    #[error("one without {0:?}, which the job writes")]
    Missing(PathBuf),
}

/// Checks that an entry has the outputs of its job, and nothing else.
pub type Fits<'f> = &'f (dyn Fn(&Entry) -> Result<(), Unusable> + Sync);

impl Entry {
    /// Returns the entry of `job`, whose bake wrote `document`.
    ///
    /// # Errors
    /// [`NotRelative`] for a file that is not below the folder of `document`.
    pub fn new(job: Digest, document: &Path, baked: &BakedAsset) -> Result<Self, NotRelative> {
        let name = Path::new(document.file_name().unwrap_or_default());
        let stored = |path: &Path, bytes: &[u8]| -> Result<Stored, NotRelative> {
            Ok(Stored { path: path.try_into()?, blake3: digest(bytes), bytes: bytes.len() as u64 })
        };
        let files: Result<_, _> = baked.files.iter().map(|file| stored(&file.path, &file.bytes)).collect();
        let copies: Result<_, _> = baked.copies.iter().map(|copy| copy.as_path().try_into()).collect();
        Ok(Self {
            format_version: ENTRY_FORMAT,
            job,
            document: stored(name, &baked.document)?,
            files: files?,
            copies: copies?,
            report: baked.report.clone(),
        })
    }

    /// Returns all stored files. The document is last, so that a reader who sees it also sees the files that it names.
    pub fn stored(&self) -> impl Iterator<Item = &Stored> {
        self.files.iter().chain([&self.document])
    }

    /// Returns the entry as it is stored: a digest, then JSON.
    ///
    /// # Errors
    /// The error of writing the report as JSON.
    pub fn to_bytes(&self) -> serde_json::Result<Vec<u8>> {
        let json = serde_json::to_vec(self)?;
        Ok([digest(&json).to_string().as_bytes(), &json].concat())
    }

    /// Returns the entry of `job` that `bytes` keep.
    ///
    /// # Errors
    /// [`Unusable`] for anything but an entry of `job` that `fits`.
    pub fn read(bytes: &[u8], job: Digest, fits: Fits<'_>) -> Result<Self, Unusable> {
        let (named, json) = bytes.split_at_checked(DIGEST_LENGTH).ok_or(Unusable::Damaged)?;
        if digest(json).to_string().as_bytes() != named {
            return Err(Unusable::Damaged);
        }
        check_format(json, "cache entry", ENTRY_FORMAT, "bake again")?;
        let entry: Self = serde_json::from_slice(json).map_err(|_| Unusable::Damaged)?;
        if entry.job != job {
            return Err(Unusable::OtherJob(entry.job));
        }
        fits(&entry).map(|()| entry)
    }
}

/// Returns that there is no entry if `unusable` is one of another format. The user can do nothing about such an entry,
/// and the job is baked again.
///
/// # Errors
/// Returns every other reason as it is.
pub(super) fn absent(unusable: Unusable) -> Result<Option<Entry>, Unusable> {
    if matches!(unusable, Unusable::Format(_)) { Ok(None) } else { Err(unusable) }
}

/// A file whose bytes are stored as a blob.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Stored {
    /// Path of the file.
    pub path: RelativePath,
    /// The digest of the bytes, which names the blob.
    pub blake3: Digest,
    /// Length in bytes.
    pub bytes: u64,
}
