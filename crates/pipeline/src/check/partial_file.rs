//! An image file of which a check has read only the part that it needs.

use std::io;
use std::ops::Range;

/// Bytes that are read of every image. They contain header, level index, descriptor and provenance of a baked KTX2.
const START: u64 = 4096;

/// An image file, or the part that a check without decoding needs: for a KTX2 everything before its levels, for any
/// other file the beginning.
pub struct PartialFile {
    /// For a KTX2 as long as the file: zeros replace levels that were not read, so that lengths and offsets are right.
    bytes: Vec<u8>,
    /// Number of bytes that were read from the file.
    known: usize,
}

impl PartialFile {
    /// Holds a file that was read whole.
    pub fn whole(bytes: Vec<u8>) -> Self {
        Self { known: bytes.len(), bytes }
    }

    /// Reads a file of `length` bytes, all of them if `is_deep`. `part` reads a range of the file.
    ///
    /// # Errors
    /// Those of `part`.
    pub fn read(length: u64, is_deep: bool, part: impl Fn(Range<u64>) -> io::Result<Vec<u8>>) -> io::Result<Self> {
        if is_deep || length <= START {
            return Ok(Self::whole(part(0..length)?));
        }
        let mut start = part(0..START)?;
        if !start.starts_with(&ktx2::MAGIC) {
            return Ok(Self::whole(start));
        }
        let end = sections_end(&start).clamp(START, length);
        start.extend(part(START..end)?);
        // The zeros touch no memory: the system maps their pages only when they are used.
        let mut bytes = vec![0; usize::try_from(length).map_err(io::Error::other)?];
        let known = start.len();
        bytes[..known].copy_from_slice(&start);
        Ok(Self { bytes, known })
    }

    /// Returns the bytes that were read, from the beginning of the file: at least 4096, or the whole file if it is
    /// shorter.
    pub fn start(&self) -> &[u8] {
        &self.bytes[..self.known]
    }

    /// Returns whether the file is a KTX2.
    pub fn is_ktx2(&self) -> bool {
        self.start().starts_with(&ktx2::MAGIC)
    }

    /// Returns the file for readers of KTX2. Unless the file was read whole, its levels are zeros and must not be read.
    pub fn as_ktx2(&self) -> &[u8] {
        &self.bytes
    }
}

/// Returns the offset at which descriptor and key/value data of a KTX2 end (KTX 2.0, "Index").
fn sections_end(start: &[u8]) -> u64 {
    let word = |at: usize| {
        let word = start.get(at..at + 4).and_then(|word| word.try_into().ok());
        word.map_or(0, |word| u64::from(u32::from_le_bytes(word)))
    };
    (word(48) + word(52)).max(word(56) + word(60))
}

#[cfg(test)]
mod tests;
