//! What the API names bytes by: their SHA-256 and their number.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use prost::Message;
use sha2::{Digest as _, Sha256};

use super::api;
use super::error::RemoteError;
use crate::bake::read_file;
use crate::digest::{from_hex, to_hex};

/// The digest of a blob.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Digest {
    sha256: [u8; 32],
    /// Length of the blob.
    pub bytes: u64,
}

impl Digest {
    /// Of `bytes`.
    pub fn of(bytes: &[u8]) -> Self {
        Self { sha256: Sha256::digest(bytes).into(), bytes: bytes.len() as u64 }
    }

    /// The SHA-256 in hex.
    pub fn hex(&self) -> String {
        to_hex(self.sha256)
    }

    /// The part of resource names that names the blob.
    pub fn path(&self) -> String {
        format!("{}/{}", self.hex(), self.bytes)
    }

    /// As the API has it.
    pub fn to_api(self) -> api::Digest {
        // No blob is as long as 2^63.
        api::Digest { hash: self.hex(), size_bytes: i64::try_from(self.bytes).unwrap_or(i64::MAX) }
    }

    /// Reads a digest of the API; `None` for one of another function, one that is none, or a length below zero.
    pub fn from_api(digest: &api::Digest) -> Option<Self> {
        Some(Self { sha256: from_hex(&digest.hash)?, bytes: u64::try_from(digest.size_bytes).ok()? })
    }
}

/// Where the bytes of a blob are.
#[derive(Clone, Debug)]
enum Content {
    Memory(Arc<[u8]>),
    File(PathBuf),
}

/// Something to be sent, if the server does not have it.
#[derive(Clone, Debug)]
pub struct Blob {
    /// Its digest.
    pub digest: Digest,
    content: Content,
}

impl Blob {
    /// The blob of a message.
    pub fn of_message(message: &impl Message) -> Self {
        Self::of_bytes(message.encode_to_vec())
    }

    /// The blob of `bytes`.
    pub fn of_bytes(bytes: Vec<u8>) -> Self {
        Self { digest: Digest::of(&bytes), content: Content::Memory(bytes.into()) }
    }

    /// The blob of a file, which is read again when it is sent.
    ///
    /// # Errors
    /// [`RemoteError::Read`].
    pub fn of_file(path: &Path) -> Result<Self, RemoteError> {
        let bytes = read(path)?;
        Ok(Self::known(path, Digest::of(&bytes)))
    }

    /// The blob of a file of which the digest is known.
    pub fn known(path: &Path, digest: Digest) -> Self {
        Self { digest, content: Content::File(path.to_owned()) }
    }

    /// Whether others may need the same blob: a file, and nothing that was made for one action.
    pub fn is_file(&self) -> bool {
        matches!(self.content, Content::File(_))
    }

    /// The bytes.
    ///
    /// # Errors
    /// [`RemoteError::Read`], and [`RemoteError::Changed`] for a file that has other bytes now.
    pub fn read(&self) -> Result<Arc<[u8]>, RemoteError> {
        match &self.content {
            Content::Memory(bytes) => Ok(Arc::clone(bytes)),
            Content::File(path) => {
                let bytes = read(path)?;
                if Digest::of(&bytes) != self.digest {
                    return Err(RemoteError::Changed { path: path.clone() });
                }
                Ok(bytes.into())
            }
        }
    }
}

fn read(path: &Path) -> Result<Vec<u8>, RemoteError> {
    read_file(path).map_err(|error| RemoteError::Read { path: path.to_owned(), error: error.into() })
}
