//! Whole levels: padding, threads, sizes.

use super::super::{encode_level, encode_level_with};
use super::*;
use crate::simd::instruction_sets;

fn picture(width: usize, height: usize) -> Vec<u8> {
    let mut random = Random(9);
    (0..width * height).flat_map(|_| random.next().to_le_bytes()[..4].to_vec()).collect()
}

#[test]
fn odd_sizes_repeat_the_last_column_and_row() {
    for (width, height) in [(1, 1), (1, 7), (5, 1), (3, 2), (4, 4), (6, 9), (13, 4)] {
        let texels = picture(width, height);
        for (metric, effort) in METRICS.into_iter().flat_map(|m| EFFORTS.map(|e| (m, e))) {
            let blocks = encode_level(&texels, width as u32, height as u32, metric, effort);
            let (columns, rows) = (width.div_ceil(4), height.div_ceil(4));
            assert_eq!(blocks.len(), columns * rows * BLOCK_BYTES);
            for (k, block) in blocks.chunks(BLOCK_BYTES).enumerate() {
                let padded = std::array::from_fn(|i| {
                    let x = (k % columns * 4 + i % 4).min(width - 1);
                    let y = (k / columns * 4 + i / 4).min(height - 1);
                    texels[(y * width + x) * 4..][..4].try_into().unwrap()
                });
                assert_eq!(block, encode_block(&padded, metric, effort));
            }
        }
    }
}

#[test]
fn wrong_lengths_give_nothing() {
    let texels = [0; 64];
    for (width, height) in [(0, 0), (0, 4), (4, 0), (4, 5), (3, 4), (u32::MAX, u32::MAX)] {
        assert!(encode_level(&texels, width, height, Metric::Rgb, Effort::Fast).is_empty());
    }
}

#[test]
fn threads_do_not_change_a_byte() {
    let texels = picture(67, 45);
    for effort in EFFORTS {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| METRICS.map(|metric| encode_level(&texels, 67, 45, metric, effort)))
        };
        assert_eq!(with(1), with(4));
    }
}

/// Blocks of all kinds beside each other, and their width.
fn wide_row() -> (Vec<u8>, u32) {
    let kinds = all_kinds();
    let lines = (0..4).flat_map(|y| kinds.iter().flat_map(move |texels| &texels[4 * y..4 * y + 4]));
    (lines.flatten().copied().collect(), 4 * kinds.len() as u32)
}

#[test]
fn blocks_do_not_depend_on_those_beside_them() {
    let (texels, width) = wide_row();
    for (metric, effort) in METRICS.into_iter().flat_map(|m| EFFORTS.map(|e| (m, e))) {
        let row = encode_level(&texels, width, 4, metric, effort);
        for (block, texels) in row.as_chunks::<BLOCK_BYTES>().0.iter().zip(all_kinds()) {
            assert_eq!(*block, encode_block(&texels, metric, effort), "{metric:?}, {effort:?}: {texels:?}");
        }
    }
}

#[test]
fn instructions_do_not_change_a_byte() {
    let (texels, width) = wide_row();
    let size = (width, 4);
    for (metric, effort) in METRICS.into_iter().flat_map(|m| EFFORTS.map(|e| (m, e))) {
        let expected = encode_level(&texels, size.0, size.1, metric, effort);
        for set in instruction_sets() {
            assert_eq!(encode_level_with(set, &texels, size, metric, effort), expected, "{metric:?}, {effort:?}");
        }
    }
}

#[test]
fn bytes_are_pinned() {
    // A change of these hashes is a change of every texture that a user has baked: it belongs in
    // the change log.
    let hash = |bytes: &[u8]| {
        bytes
            .iter()
            .fold(0xcbf2_9ce4_8422_2325u64, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
    };
    let mut found = Vec::new();
    for effort in EFFORTS {
        for metric in METRICS {
            let blocks: Vec<u8> = all_kinds().iter().flat_map(|texels| encode_block(texels, metric, effort)).collect();
            found.push(hash(&blocks));
        }
    }
    assert_eq!(found, PINNED, "{found:#x?}");
}

const PINNED: [u64; 8] = [
    0x76bf_93c3_48e2_8199,
    0xb41c_734c_4384_323d,
    0x1c38_3094_07ef_b2e7,
    0x03e4_961d_f67b_f0e2,
    0x75ac_9061_2cf2_219c,
    0x4478_6bc1_7979_a054,
    0xdf63_f747_5b0b_6e19,
    0xe5fe_d923_d7e4_372d,
];
