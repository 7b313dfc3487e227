//! What names content: in plans, caches and provenance.

use std::io::{self, Read};

/// BLAKE3 of `bytes`, in 64 lower-case hexadecimal digits.
pub fn digest(bytes: &[u8]) -> String {
    // Below 128 KiB threads cost more than they gain (documentation of `update_rayon`).
    if bytes.len() < 128 << 10 {
        return blake3::hash(bytes).to_hex().to_string();
    }
    blake3::Hasher::new().update_rayon(bytes).finalize().to_hex().to_string()
}

/// The same of all that `source` holds, without holding it, and its length.
///
/// # Errors
/// Those of `source`.
pub fn digest_of(source: impl Read) -> io::Result<(String, u64)> {
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(source)?;
    Ok((hasher.finalize().to_hex().to_string(), hasher.count()))
}
