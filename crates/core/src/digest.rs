//! Content digests. They name jobs, blobs of caches, and sources in provenance.

use std::fmt;
use std::io::{self, Read};
use std::str::FromStr;

use serde::{Deserialize, Serialize, Serializer};

/// A BLAKE3 digest, written as 64 lower-case hexadecimal digits.
///
/// No other text can be read as a digest, so a digest from an untrusted file is safe as the name of a file.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize)]
#[serde(try_from = "String")]
pub struct Digest([u8; 32]);

/// A text that is not a digest.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected a digest of 64 lower-case hexadecimal digits, found {found:?}")]
pub struct NoDigest {
    /// The beginning of the text.
    pub found: String,
}

impl Digest {
    /// Returns the bytes. They sort in the same order as the digits.
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

impl From<blake3::Hash> for Digest {
    fn from(hash: blake3::Hash) -> Self {
        Self(*hash.as_bytes())
    }
}

impl FromStr for Digest {
    type Err = NoDigest;

    fn from_str(text: &str) -> Result<Self, NoDigest> {
        from_hex(text).map(Self).ok_or_else(|| NoDigest { found: text.chars().take(80).collect() })
    }
}

impl TryFrom<String> for Digest {
    type Error = NoDigest;

    fn try_from(text: String) -> Result<Self, NoDigest> {
        text.parse()
    }
}

/// Writes all 64 digits, or only the first digits if there is a precision: `{:.12}`.
impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&to_hex(self.0))
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Serialize for Digest {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Returns the 32 bytes of 64 lower-case hexadecimal digits, and `None` for any other text.
pub fn from_hex(text: &str) -> Option<[u8; 32]> {
    // `from_hex` of `blake3` also accepts upper-case digits, with which one digest would have several names.
    let is_lower = text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
    let parsed = if is_lower { blake3::Hash::from_hex(text).ok() } else { None };
    parsed.map(|hash| *hash.as_bytes())
}

/// Returns the 64 lower-case hexadecimal digits of 32 bytes.
pub fn to_hex(bytes: [u8; 32]) -> String {
    blake3::Hash::from_bytes(bytes).to_hex().to_string()
}

/// Returns the BLAKE3 digest of `bytes`.
pub fn digest(bytes: &[u8]) -> Digest {
    // Below 128 KiB threads cost more than they gain (documentation of `update_rayon`).
    if bytes.len() < 128 << 10 {
        return Digest(blake3::hash(bytes).into());
    }
    Digest(blake3::Hasher::new().update_rayon(bytes).finalize().into())
}

/// Returns the BLAKE3 digest and the length of the content of `source`, without keeping the content in memory.
///
/// # Errors
/// Those of `source`.
pub fn digest_of(source: impl Read) -> io::Result<(Digest, u64)> {
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(source)?;
    Ok((Digest(hasher.finalize().into()), hasher.count()))
}

#[cfg(test)]
mod tests;
