//! Digests of the API: the SHA-256 and the length of a blob.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use prost::Message;
use sha2::{Digest as _, Sha256};

use super::api;
use super::error::RemoteError;
use crate::digest::{from_hex, to_hex};
use crate::input_file::read_file;

/// The digest of a blob.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Digest {
    sha256: [u8; 32],
    /// Length of the blob.
    pub bytes: u64,
}

impl Digest {
    /// Returns the digest of `bytes`.
    pub fn of(bytes: &[u8]) -> Self {
        Self { sha256: Sha256::digest(bytes).into(), bytes: bytes.len() as u64 }
    }

    /// Returns the SHA-256 in hexadecimal digits.
    pub fn hex(&self) -> String {
        to_hex(self.sha256)
    }

    /// Returns the part of resource names that identifies the blob.
    pub fn path(&self) -> String {
        format!("{}/{}", self.hex(), self.bytes)
    }

    /// Returns the digest as a message of the API.
    pub fn to_api(self) -> api::Digest {
        // No blob reaches 2^63 bytes.
        api::Digest { hash: self.hex(), size_bytes: i64::try_from(self.bytes).unwrap_or(i64::MAX) }
    }

    /// Reads a digest of the API. Returns `None` if the digest is not a SHA-256, or if its length is negative.
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

/// Bytes that are sent if the server does not have them.
#[derive(Clone, Debug)]
pub struct Blob {
    /// The digest of the bytes.
    pub digest: Digest,
    content: Content,
}

impl Blob {
    /// Returns the blob of a message.
    pub fn of_message(message: &impl Message) -> Self {
        Self::of_bytes(message.encode_to_vec())
    }

    /// Returns the blob of `bytes`.
    pub fn of_bytes(bytes: Vec<u8>) -> Self {
        Self { digest: Digest::of(&bytes), content: Content::Memory(bytes.into()) }
    }

    /// Returns the blob of a file. The file is read again when it is sent.
    ///
    /// # Errors
    /// [`RemoteError::Read`].
    pub fn of_file(path: &Path) -> Result<Self, RemoteError> {
        let bytes = read(path)?;
        Ok(Self::with_digest(path, Digest::of(&bytes)))
    }

    /// Returns the blob of a file whose digest is known.
    pub fn with_digest(path: &Path, digest: Digest) -> Self {
        Self { digest, content: Content::File(path.to_owned()) }
    }

    /// Returns whether the blob is a file, which other actions may need too. Other blobs are made for one action.
    pub fn is_file(&self) -> bool {
        matches!(self.content, Content::File(_))
    }

    /// Returns the bytes.
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
