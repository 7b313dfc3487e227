//! What names content: in plans, caches and provenance.

/// BLAKE3 of `bytes`, in 64 lower-case hexadecimal digits.
pub fn digest(bytes: &[u8]) -> String {
    // Below 128 KiB threads cost more than they gain (documentation of `update_rayon`).
    if bytes.len() < 128 << 10 {
        return blake3::hash(bytes).to_hex().to_string();
    }
    blake3::Hasher::new().update_rayon(bytes).finalize().to_hex().to_string()
}
