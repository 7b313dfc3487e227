use super::*;

/// Builds a file whose header bytes 48 to 63 locate the sections; all other bytes are 7.
fn ktx2(descriptor: [u32; 2], keys: [u32; 2], length: usize) -> Vec<u8> {
    let mut bytes = vec![7; length];
    bytes[..12].copy_from_slice(&ktx2::MAGIC);
    for (word, value) in bytes[48..64].chunks_exact_mut(4).zip([descriptor, keys].concat()) {
        word.copy_from_slice(&value.to_le_bytes());
    }
    bytes
}

fn partial(file: &[u8], is_deep: bool) -> PartialFile {
    let part = |range: Range<u64>| Ok(file[range.start as usize..range.end as usize].to_vec());
    PartialFile::read(file.len() as u64, is_deep, part).unwrap()
}

#[test]
fn replaces_unread_levels_of_a_ktx2_by_zeros() {
    for (descriptor, keys, end) in
        [([200, 44], [244, 300], 4096), ([200, 44], [5000, 1000], 6000), ([6000, 500], [244, 300], 6500)]
    {
        let file = ktx2(descriptor, keys, 9000);
        let found = partial(&file, false);
        assert_eq!(found.start(), &file[..end]);
        assert_eq!(found.as_ktx2().len(), file.len());
        assert!(found.as_ktx2()[end..].iter().all(|b| *b == 0), "{end}");
        assert_eq!(partial(&file, true).start(), file);
    }
}

#[test]
fn reads_short_files_and_sections_past_the_end_up_to_the_end() {
    for file in [ktx2([u32::MAX; 2], [0; 2], 5000), ktx2([0; 2], [0; 2], 80), b"short".to_vec(), Vec::new()] {
        assert_eq!(partial(&file, false).start(), file);
    }
    assert_eq!(partial(&[7; 9000], false).start(), [7; 4096]);
}
