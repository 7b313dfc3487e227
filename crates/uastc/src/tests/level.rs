//! Tests of whole images: padding, sizes, threads and instruction sets.

use super::*;
use crate::{Lobe, SizeError};
use texel_simd::instruction_sets;

fn picture(width: usize, height: usize) -> Vec<u8> {
    let mut random = Random(9);
    (0..width * height).flat_map(|_| random.next().to_le_bytes()[..4].to_vec()).collect()
}

#[test]
fn odd_sizes_repeat_the_last_column_and_row() {
    for (width, height) in [(1, 1), (1, 7), (5, 1), (3, 2), (4, 4), (6, 9), (13, 4)] {
        let texels = picture(width, height);
        for (metric, effort) in METRICS.into_iter().flat_map(|m| EFFORTS.map(|e| (m, e))) {
            let blocks = encode(&texels, (width, height), metric, effort);
            let (columns, rows) = (width.div_ceil(4), height.div_ceil(4));
            assert_eq!(blocks.len(), columns * rows);
            for (k, block) in blocks.into_iter().enumerate() {
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
fn rejects_texels_of_another_size() {
    let texels = [0; 64];
    for (width, height) in [(0, 0), (0, 4), (4, 0), (4, 5), (3, 4), (u32::MAX, u32::MAX)] {
        let found = Image::new(&texels, width, height).err();
        assert_eq!(found, Some(SizeError::Texels { width, height, bytes: 64 }));
    }
    assert!(Image::new(&texels[..63], 4, 4).is_err() && Image::new(&[], 0, 0).is_err());
}

#[test]
fn rows_and_the_whole_image_encode_to_the_same_blocks() {
    let texels = picture(13, 7);
    let lines: Vec<_> = texels.as_chunks::<4>().0.chunks(13).collect();
    let encoder = Encoder::new(Metric::Rgb, Effort::Fast);
    let mut blocks = vec![[0; BLOCK_BYTES]; 8];
    for (row, blocks) in blocks.chunks_mut(4).enumerate() {
        encoder.encode_rows(std::array::from_fn(|y| lines[(4 * row + y).min(6)]), blocks).unwrap();
    }
    assert_eq!(blocks, encoder.encode(&image(&texels, (13, 7))));
}

#[test]
fn rejects_rows_and_blocks_of_other_lengths() {
    let (encoder, row, mut blocks) = (Encoder::new(Metric::Rgb, Effort::Fast), [[0; 4]; 9], [[0; BLOCK_BYTES]; 4]);
    let mut refused = |rows, count: usize| encoder.encode_rows(rows, &mut blocks[..count]).unwrap_err();
    assert_eq!(refused([&row; 4], 2), SizeError::Blocks { expected: 3, found: 2 });
    assert_eq!(refused([&row; 4], 4), SizeError::Blocks { expected: 3, found: 4 });
    assert_eq!(refused([&row, &row, &row, &row[..8]], 3), SizeError::Rows { widths: [9, 9, 9, 8] });
    assert_eq!(refused([&[]; 4], 0), SizeError::Rows { widths: [0; 4] });
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let texels = picture(67, 45);
    for effort in EFFORTS {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| METRICS.map(|metric| encode(&texels, (67, 45), metric, effort)))
        };
        assert_eq!(with(1), with(4));
    }
}

/// Returns lobes of several widths and shapes, one for each texel.
fn lobes(count: usize) -> Vec<Lobe> {
    let mut random = Random(23);
    (0..count)
        .map(|_| {
            let [uu, vv] = [(); 2].map(|()| (0.3 * random.unit()).powi(2) as f32);
            Lobe { uu, uv: (random.unit() - 0.5) as f32 * uu.min(vv), vv }
        })
        .collect()
}

#[test]
fn bytes_with_lobes_do_not_depend_on_threads() {
    let (texels, lobes) = (picture(67, 45), lobes(67 * 45));
    let image = image(&texels, (67, 45)).with_lobes(&lobes).unwrap();
    for effort in EFFORTS {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Encoder::new(Metric::Direction, effort).encode(&image))
        };
        assert_eq!(with(1), with(4));
    }
}

#[test]
fn bytes_with_lobes_do_not_depend_on_the_instruction_set() {
    let (texels, width) = wide_row();
    let lobes = lobes(4 * width);
    let image = image(&texels, (width, 4)).with_lobes(&lobes).unwrap();
    for effort in EFFORTS {
        let encoder = Encoder::new(Metric::Direction, effort);
        let expected = encoder.encode(&image);
        for instructions in instruction_sets() {
            let mut limited = encoder;
            limited.instructions = instructions;
            assert_eq!(limited.encode(&image), expected, "{effort:?}");
        }
    }
}

#[test]
fn rows_and_the_whole_image_with_lobes_encode_to_the_same_blocks() {
    let (texels, lobes) = (picture(13, 7), lobes(13 * 7));
    let (lines, lobe_lines): (Vec<_>, Vec<_>) =
        (texels.as_chunks::<4>().0.chunks(13).collect(), lobes.chunks(13).collect());
    let encoder = Encoder::new(Metric::Direction, Effort::Fast);
    let mut blocks = vec![[0; BLOCK_BYTES]; 8];
    for (row, blocks) in blocks.chunks_mut(4).enumerate() {
        let at = |y: usize| (4 * row + y).min(6);
        let rows = std::array::from_fn(|y| lines[at(y)]);
        encoder.encode_rows_with_lobes(rows, std::array::from_fn(|y| lobe_lines[at(y)]), blocks).unwrap();
    }
    assert_eq!(blocks, encoder.encode(&image(&texels, (13, 7)).with_lobes(&lobes).unwrap()));
}

/// Returns a row of blocks of all kinds, and its width in texels.
fn wide_row() -> (Vec<u8>, usize) {
    let kinds = all_kinds();
    let lines = (0..4).flat_map(|y| kinds.iter().flat_map(move |texels| &texels[4 * y..4 * y + 4]));
    (lines.flatten().copied().collect(), 4 * kinds.len())
}

#[test]
fn blocks_do_not_depend_on_their_neighbours() {
    let (texels, width) = wide_row();
    for (metric, effort) in METRICS.into_iter().flat_map(|m| EFFORTS.map(|e| (m, e))) {
        let row = encode(&texels, (width, 4), metric, effort);
        for (block, texels) in row.into_iter().zip(all_kinds()) {
            assert_eq!(block, encode_block(&texels, metric, effort), "{metric:?}, {effort:?}: {texels:?}");
        }
    }
}

#[test]
fn bytes_do_not_depend_on_the_instruction_set() {
    let (texels, width) = wide_row();
    let image = image(&texels, (width, 4));
    for (metric, effort) in METRICS.into_iter().flat_map(|m| EFFORTS.map(|e| (m, e))) {
        let encoder = Encoder::new(metric, effort);
        let expected = encoder.encode(&image);
        for instructions in instruction_sets() {
            let mut limited = encoder;
            limited.instructions = instructions;
            assert_eq!(limited.encode(&image), expected, "{metric:?}, {effort:?}");
        }
    }
}

#[test]
fn bytes_are_pinned() {
    // If these hashes change, every texture that users encode changes. Record such a change in the change log.
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
    let lobes = lobes(16);
    for effort in EFFORTS {
        let block = |texels: &Texels| {
            let image = image(texels.as_flattened(), (4, 4)).with_lobes(&lobes).unwrap();
            Encoder::new(Metric::Direction, effort).encode(&image)[0]
        };
        found.push(hash(&all_kinds().iter().flat_map(block).collect::<Vec<u8>>()));
    }
    assert_eq!(found, PINNED, "{found:#x?}");
}

/// The hashes of all metrics with each effort, then of lobes with each effort.
const PINNED: [u64; 10] = [
    0x76bf_93c3_48e2_8199,
    0xc08a_e682_bc41_eb48,
    0xb41c_734c_4384_323d,
    0x03e4_961d_f67b_f0e2,
    0x75ac_9061_2cf2_219c,
    0x2e04_5304_a8d3_b2d3,
    0x4478_6bc1_7979_a054,
    0xe5fe_d923_d7e4_372d,
    0x604f_0ac2_face_a00a,
    0xb7f0_8d0c_3935_5e68,
];
