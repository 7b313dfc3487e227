//! What names content: in plans, caches and provenance.

/// BLAKE3 of `bytes`, in 64 lower-case hexadecimal digits.
pub fn digest(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}
