//! Undoing Zstandard and zlib, never past the length that is expected.

use std::io::{self, Read};

use ::zstd::zstd_safe::{find_frame_compressed_size, get_frame_content_size};

use crate::memory;

/// Bytes that a byte of zlib makes at most (RFC 1951: a match of 258 bytes takes two bits).
const MOST_OF_ZLIB: u64 = 1032;

/// The payload in Zstandard frames, or one byte more than `expected` of longer ones.
pub(super) fn zstd(stored: &[u8], expected: u64) -> io::Result<Vec<u8>> {
    read_up_to(::zstd::Decoder::with_buffer(stored)?, stored.len(), expected)
}

/// What Zstandard frames declare to hold in all (RFC 8878, 3.1.1.1.4); `None` where one of them does not tell.
pub(super) fn declared(mut stored: &[u8]) -> Option<u64> {
    let mut total = 0u64;
    while !stored.is_empty() {
        total = total.checked_add(get_frame_content_size(stored).ok()??)?;
        stored = stored.get(find_frame_compressed_size(stored).ok()?.max(1)..)?;
    }
    Some(total)
}

/// The payload in a zlib stream, or one byte more than `expected` of a longer one.
pub(super) fn zlib(stored: &[u8], expected: u64) -> io::Result<Vec<u8>> {
    let most = (stored.len() as u64).saturating_mul(MOST_OF_ZLIB);
    if expected > most {
        return Err(io::Error::other(format!("{} bytes of zlib make {most} at most", stored.len())));
    }
    read_up_to(flate2::bufread::ZlibDecoder::new(stored), stored.len(), expected)
}

/// What is allocated is bounded by what is really there: a header that claims a large image and has little data gets little.
/// Most levels fit into the first buffer, so it is not copied while it grows.
fn read_up_to(reader: impl Read, stored: usize, expected: u64) -> io::Result<Vec<u8>> {
    let first = (stored as u64).saturating_mul(64).min(expected);
    let mut payload = memory::with_capacity(usize::try_from(first).map_err(io::Error::other)?)?;
    reader.take(expected.saturating_add(1)).read_to_end(&mut payload)?;
    Ok(payload)
}
