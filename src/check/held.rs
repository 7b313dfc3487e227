//! An image file as far as a check has read it.

use std::io;
use std::ops::Range;

/// Bytes that are read of any image: header, level index, descriptor and provenance of a KTX2 that we bake lie within.
const START: u64 = 4096;

/// An image file, or as much of it as a check that decodes nothing looks at: of a KTX2 all that stands before its levels,
/// of any other file the beginning.
pub struct Held {
    /// Of a KTX2 as long as the file is: zeros stand for levels that were not read, so that lengths and offsets are right.
    bytes: Vec<u8>,
    /// How many bytes are the file's.
    known: usize,
}

impl Held {
    /// Holds a file of which every byte is there.
    pub fn whole(bytes: Vec<u8>) -> Self {
        Self { known: bytes.len(), bytes }
    }

    /// Reads a file of `length` bytes: all of it if `is_deep`. `part` reads a range of it.
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
        // For the zeros no memory is touched.
        let mut bytes = vec![0; usize::try_from(length).map_err(io::Error::other)?];
        let known = start.len();
        bytes[..known].copy_from_slice(&start);
        Ok(Self { bytes, known })
    }

    /// Returns the bytes that were read, from the beginning of the file. Never fewer than 4096 of a file that has as many.
    pub fn start(&self) -> &[u8] {
        &self.bytes[..self.known]
    }

    /// Whether the file is a KTX2.
    pub fn is_ktx2(&self) -> bool {
        self.start().starts_with(&ktx2::MAGIC)
    }

    /// Returns the file for readers of KTX2. Zeros stand for the levels unless the file was read whole, so only what stands
    /// before them may be looked at then.
    pub fn as_ktx2(&self) -> &[u8] {
        &self.bytes
    }
}

/// Returns where descriptor and key/value data of a KTX2 end (KTX 2.0, "Index").
fn sections_end(start: &[u8]) -> u64 {
    let word = |at: usize| {
        let word = start.get(at..at + 4).and_then(|word| word.try_into().ok());
        word.map_or(0, |word| u64::from(u32::from_le_bytes(word)))
    };
    (word(48) + word(52)).max(word(56) + word(60))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Header fields 48 to 63 say where the sections are; everything else is 7.
    fn ktx2(descriptor: [u32; 2], keys: [u32; 2], length: usize) -> Vec<u8> {
        let mut bytes = vec![7; length];
        bytes[..12].copy_from_slice(&ktx2::MAGIC);
        for (word, value) in bytes[48..64].chunks_exact_mut(4).zip([descriptor, keys].concat()) {
            word.copy_from_slice(&value.to_le_bytes());
        }
        bytes
    }

    fn held(file: &[u8], is_deep: bool) -> Held {
        let part = |range: Range<u64>| Ok(file[range.start as usize..range.end as usize].to_vec());
        Held::read(file.len() as u64, is_deep, part).unwrap()
    }

    #[test]
    fn zeros_stand_for_the_levels_of_a_ktx2_and_are_not_called_read() {
        for (descriptor, keys, end) in
            [([200, 44], [244, 300], 4096), ([200, 44], [5000, 1000], 6000), ([6000, 500], [244, 300], 6500)]
        {
            let file = ktx2(descriptor, keys, 9000);
            let found = held(&file, false);
            assert_eq!(found.start(), &file[..end]);
            assert_eq!(found.as_ktx2().len(), file.len());
            assert!(found.as_ktx2()[end..].iter().all(|b| *b == 0), "{end}");
            assert_eq!(held(&file, true).start(), file);
        }
    }

    #[test]
    fn sections_past_the_end_and_short_files_are_read_as_far_as_they_go() {
        for file in [ktx2([u32::MAX; 2], [0; 2], 5000), ktx2([0; 2], [0; 2], 80), b"short".to_vec(), Vec::new()] {
            assert_eq!(held(&file, false).start(), file);
        }
        assert_eq!(held(&[7; 9000], false).start(), [7; 4096]);
    }
}
