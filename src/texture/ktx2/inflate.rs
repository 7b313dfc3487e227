//! Undoing Zstandard and zlib, never past the length that is expected.

use std::io::{self, Read};

/// The payload in a Zstandard frame, or one byte more than `expected` of a longer one.
pub(super) fn zstd(stored: &[u8], expected: u64) -> io::Result<Vec<u8>> {
    read_up_to(::zstd::Decoder::with_buffer(stored)?, stored.len(), expected)
}

/// The payload in a zlib stream, or one byte more than `expected` of a longer one.
pub(super) fn zlib(stored: &[u8], expected: u64) -> io::Result<Vec<u8>> {
    read_up_to(flate2::bufread::ZlibDecoder::new(stored), stored.len(), expected)
}

/// What is allocated is bounded by what is really there: a header that claims a large image and has
/// little data gets little. Most levels fit into the first buffer, so it is not copied while it grows.
fn read_up_to(reader: impl Read, stored: usize, expected: u64) -> io::Result<Vec<u8>> {
    let first = stored.saturating_mul(64).min(usize::try_from(expected).unwrap_or(usize::MAX));
    let mut payload = Vec::with_capacity(first);
    reader.take(expected.saturating_add(1)).read_to_end(&mut payload)?;
    Ok(payload)
}
