//! Decompression of Zstandard and zlib, never past the expected length.

use std::io::{self, Read};

use ::zstd::zstd_safe::{find_frame_compressed_size, get_frame_content_size};

use crate::memory;

/// Most bytes that one byte of zlib decompresses to (RFC 1951: a match of 258 bytes takes two bits).
const MAX_ZLIB_RATIO: u64 = 1032;

/// Returns the payload of Zstandard frames, or one byte more than `expected` of a longer payload.
pub(super) fn zstd(stored: &[u8], expected: u64) -> io::Result<Vec<u8>> {
    read_up_to(::zstd::Decoder::with_buffer(stored)?, stored.len(), expected)
}

/// Returns the total length that Zstandard frames declare (RFC 8878, 3.1.1.1.4), or `None` if a frame does not declare
/// one.
pub(super) fn declared_length(mut stored: &[u8]) -> Option<u64> {
    let mut total = 0u64;
    while !stored.is_empty() {
        total = total.checked_add(get_frame_content_size(stored).ok()??)?;
        stored = stored.get(find_frame_compressed_size(stored).ok()?.max(1)..)?;
    }
    Some(total)
}

/// Returns the payload of a zlib stream, or one byte more than `expected` of a longer payload.
pub(super) fn zlib(stored: &[u8], expected: u64) -> io::Result<Vec<u8>> {
    let most = (stored.len() as u64).saturating_mul(MAX_ZLIB_RATIO);
    if expected > most {
        return Err(io::Error::other(format!("{} bytes of zlib make {most} at most", stored.len())));
    }
    read_up_to(flate2::bufread::ZlibDecoder::new(stored), stored.len(), expected)
}

/// Reads at most `expected` bytes and one more. The allocation is bounded by the `stored` bytes: a file that claims a
/// large image and holds little data gets little memory. Most levels fit into the first buffer, which then need not
/// grow.
fn read_up_to(reader: impl Read, stored: usize, expected: u64) -> io::Result<Vec<u8>> {
    let first = (stored as u64).saturating_mul(64).min(expected);
    let mut payload = memory::with_capacity(usize::try_from(first).map_err(io::Error::other)?)?;
    reader.take(expected.saturating_add(1)).read_to_end(&mut payload)?;
    Ok(payload)
}
