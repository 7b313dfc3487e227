//! Files as far as a check that decodes nothing looks at them.

use std::io::{self, Read};
use std::ops::Range;
use std::path::Path;

use crate::input_file::open_file;
use crate::memory;

/// Bytes that are read of any file: header, level index, descriptor and provenance of a KTX2 that we bake lie within.
const START: usize = 4096;

/// Reads the beginning of a file, of a KTX2 all that stands before its levels. Zeros stand for the rest, for which no
/// memory is touched either, so that lengths and offsets are those of the file.
///
/// # Errors
/// As [`crate::bake::read_file`].
pub fn read_head(path: &Path) -> io::Result<Vec<u8>> {
    let (mut file, length) = open_file(path)?;
    let length = usize::try_from(length).map_err(io::Error::other)?;
    let mut bytes = memory::filled(length, 0)?;
    let start = length.min(START);
    file.read_exact(&mut bytes[..start])?;
    let end = if bytes.starts_with(&ktx2::MAGIC) { sections_end(&bytes).clamp(start, length) } else { start };
    file.read_exact(&mut bytes[start..end])?;
    Ok(bytes)
}

/// Where descriptor and key/value data of a KTX2 end (KTX 2.0, "Index").
fn sections_end(bytes: &[u8]) -> usize {
    let word = |at: Range<usize>| {
        let word = bytes.get(at).and_then(|word| word.try_into().ok());
        word.map_or(0, |word| u32::from_le_bytes(word) as usize)
    };
    let ends = [word(48..52).saturating_add(word(52..56)), word(56..60).saturating_add(word(60..64))];
    ends.into_iter().max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use std::fs;

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

    fn head(bytes: &[u8]) -> Vec<u8> {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), bytes).unwrap();
        read_head(file.path()).unwrap()
    }

    #[test]
    fn levels_are_zeros_and_the_rest_is_there() {
        for (descriptor, keys, end) in
            [([200, 44], [244, 300], START), ([200, 44], [5000, 1000], 6000), ([6000, 500], [244, 300], 6500)]
        {
            let bytes = ktx2(descriptor, keys, 9000);
            let found = head(&bytes);
            assert_eq!(found.len(), bytes.len());
            assert_eq!(found[..end], bytes[..end]);
            assert!(found[end..].iter().all(|b| *b == 0), "{end}");
        }
    }

    #[test]
    fn sections_past_the_end_and_short_files_are_read_as_far_as_they_go() {
        for bytes in [ktx2([u32::MAX; 2], [0; 2], 5000), ktx2([0; 2], [0; 2], 80), b"short".to_vec(), Vec::new()] {
            assert_eq!(head(&bytes), bytes);
        }
        let other = vec![7; 9000];
        assert_eq!(head(&other)[..START], other[..START]);
        assert!(head(&other)[START..].iter().all(|b| *b == 0));
    }

    #[test]
    fn only_ordinary_files_are_read() {
        assert!(read_head(Path::new(".")).is_err());
        assert!(read_head(Path::new("no such file")).is_err());
    }
}
