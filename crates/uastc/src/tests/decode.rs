//! Tests that blocks decode exactly as the encoder predicts.

use super::*;
use crate::blocks::{Blocks, Stored};
use crate::candidate::{Split, one_line, split_lines, two_planes};
use crate::decode_block;
use crate::hints::Hints;
use crate::lanes::{Grid, channels};
use crate::moments::{moments, principal_axis};
use crate::pack::Block;
use crate::tables::*;
use basisu::uastc::bise::{astc_get_levels, unquant_astc_endpoint_val};
use basisu::uastc::huff_modes::HUFF_MODES;
use basisu::uastc::patterns::{ASTC_BC7_PATTERNS2, ASTC_BC7_PATTERNS3, BC7_3_ASTC2_PATTERNS2};
use fearless_simd::{Level, Simd, SimdBase};
use texel_simd::{LANES, Wide, dispatch};

/// Returns blocks of every mode that the encoder writes, except the modes of one colour and of grey and alpha.
pub(super) fn every_mode(texels: &Texels) -> Vec<(u8, Block)> {
    // All lanes hold the same block.
    let blocks = dispatch!(Level::new(), simd => every_mode_with(simd, texels));
    let one = |(k, blocks): (usize, Stored)| blocks.block(k % LANES);
    blocks.into_iter().enumerate().map(one).map(|block| (block.mode.number, block)).collect()
}

fn every_mode_with<S: Simd>(simd: S, texels: &Texels) -> Vec<Stored> {
    let lanes: [Grid<S>; 3] = channels(simd, [texels; LANES]);
    let all = moments(simd, &lanes, None);
    let axis = principal_axis(simd, &all.scatter);
    let splat = |number: usize| Wide::splat(simd, number as f32);
    let ones = &[splat(1); 3];
    let mut blocks: Vec<Blocks<S>> = Vec::new();
    for rounds in [1, 3] {
        blocks.push(one_line(simd, &lanes, &all, &axis, ones, &MODE_0, rounds));
        blocks.push(one_line(simd, &lanes, &all, &axis, ones, &MODE_1, rounds));
        blocks.push(one_line(simd, &lanes, &all, &axis, ones, &MODE_5, rounds));
        blocks.push(one_line(simd, &lanes, &all, &axis, ones, &MODE_18, rounds));
        for selector in 0..3 {
            blocks.push(two_planes(simd, &lanes, &all, splat(selector), ones, &MODE_6, rounds));
        }
        for pattern in 0..PATTERNS_2.len() {
            let split = Split::two_subsets(simd, &lanes, splat(pattern));
            blocks.push(split_lines(simd, &lanes, &split, ones, &MODE_2, rounds));
            blocks.push(split_lines(simd, &lanes, &split, ones, &MODE_4, rounds));
        }
        for pattern in 0..PATTERNS_3.len() {
            let split = Split::three_subsets(simd, &lanes, splat(pattern));
            blocks.push(split_lines(simd, &lanes, &split, ones, &MODE_3, rounds));
        }
    }
    blocks.iter().map(Blocks::store).collect()
}

/// Decodes a block as the specification is written, without optimisation.
pub(super) fn expected(block: &Block) -> Texels {
    let mode = block.mode;
    let range = endpoint_range(mode);
    let top = (1u32 << mode.weight_bits) - 1;
    std::array::from_fn(|i| {
        let subset = match mode.subsets {
            2 => usize::from(ASTC_BC7_PATTERNS2[block.pattern][i]),
            3 => usize::from(ASTC_BC7_PATTERNS3[block.pattern][i]),
            _ => 0,
        };
        std::array::from_fn(|c| {
            if c >= mode.channels {
                return 255;
            }
            let plane = usize::from(mode.planes == 2 && block.selector == c);
            let index = u32::from(block.weights[plane][i]);
            // A weight is index * 64 / top; with 4 and 5 bits, halves are rounded away from the middle.
            let weight = match mode.weight_bits {
                4 => [0, 4, 8, 12, 17, 21, 25, 29, 35, 39, 43, 47, 52, 56, 60, 64][index as usize],
                5 => 2 * index + if index > 15 { 2 } else { 0 },
                _ => (index * 128 + top) / (2 * top),
            };
            let [low, high] = block.endpoints[subset][c]
                .map(|level| mode.range.code[usize::from(level)])
                .map(|code| unquant_astc_endpoint_val(code.into(), range) * 257);
            ((low * (64 - weight) + high * weight + 32) / 64 / 256) as u8
        })
    })
}

/// Returns the index of a mode's endpoint range in `basisu`.
fn endpoint_range(mode: &Mode) -> u32 {
    let levels = mode.range.base << mode.range.bits;
    (0..21).find(|&r| astc_get_levels(r) == levels).unwrap()
}

#[test]
fn every_mode_decodes_as_predicted() {
    let hints = Hints { bias: 13, ..Hints::default() };
    for texels in all_kinds() {
        for (number, block) in every_mode(&texels) {
            let (error, predicted) = (block.error, expected(&block));
            let bytes = block.pack(&hints);
            assert_eq!(HUFF_MODES[usize::from(bytes[0] & 127)], number);
            assert_eq!(decoded(&bytes), predicted, "mode {number}, {texels:?}");
            assert_eq!(decode_block(&bytes), Some(predicted), "mode {number}, {texels:?}");
            let actual = squared_error(&predicted, &texels);
            assert_eq!(error, actual as f32, "mode {number}, {texels:?}");
        }
    }
}

#[test]
fn random_blocks_of_all_modes_decode_as_with_basisu() {
    let mut random = Random(17);
    let mut counts = [0; 20];
    // Prefix codes of modes have 7 bits at most.
    for prefix in (0..128).flat_map(|prefix| [prefix; 400]) {
        let mut bytes: [u8; BLOCK_BYTES] = std::array::from_fn(|_| random.byte());
        bytes[0] = bytes[0] & 128 | prefix;
        let found = decode_block(&bytes);
        assert_eq!(found, unpack_uastc(&bytes, false).map(|texels| texels.map(|texel| texel.c)), "{bytes:x?}");
        counts[usize::from(HUFF_MODES[usize::from(prefix)])] += usize::from(found.is_some());
    }
    // Mode 19 is reserved. Mode 7 has the most pattern indices that do not exist.
    assert!(counts[19] == 0 && counts[..19].iter().all(|&count| count > 200), "{counts:?}");
}

#[test]
fn ranges_and_patterns_equal_those_of_basisu() {
    for mode in ALL {
        let index = endpoint_range(mode);
        let levels: Vec<u32> = (0..astc_get_levels(index)).map(|code| unquant_astc_endpoint_val(code, index)).collect();
        for target in 0..256u32 {
            let code = usize::from(mode.range.code[target as usize]);
            let level = u32::from(mode.range.level[target as usize]);
            assert_eq!(level, levels[code]);
            let nearest = levels.iter().map(|l| l.abs_diff(target)).min();
            assert_eq!(Some(level.abs_diff(target)), nearest);
        }
    }
    let halves = PATTERNS_2.iter().zip(ASTC_BC7_PATTERNS2);
    for (bits, pattern) in halves.chain(MODE_7_PATTERNS.iter().zip(BC7_3_ASTC2_PATTERNS2)) {
        for (i, subset) in pattern.into_iter().enumerate() {
            assert_eq!((bits >> i & 1) as u8, subset);
        }
    }
    for (masks, pattern) in PATTERNS_3.iter().zip(ASTC_BC7_PATTERNS3) {
        for (i, subset) in pattern.into_iter().enumerate() {
            assert_eq!(masks.map(|mask| mask >> i & 1 == 1), [0, 1, 2].map(|s| s == subset));
        }
    }
}

#[test]
fn encoder_ignores_alpha_and_writes_opaque_blocks() {
    for texels in all_kinds() {
        for effort in EFFORTS {
            let block = encode_block(&texels, Metric::Rgb, effort);
            assert!(decoded(&block).iter().all(|t| t[3] == 255));
            let without = texels.map(|[r, g, b, _]| [r, g, b, 0]);
            assert_eq!(block, encode_block(&without, Metric::Rgb, effort));
        }
    }
}

#[test]
fn solid_blocks_are_exact() {
    let mut random = Random(3);
    for _ in 0..2000 {
        let colour = std::array::from_fn(|_| random.byte());
        for effort in EFFORTS {
            let [r, g, b, _]: [u8; 4] = colour;
            let block = encode_block(&[colour; 16], Metric::Rgb, effort);
            assert_eq!(decoded(&block), [[r, g, b, 255]; 16]);
        }
    }
}

#[test]
fn up_to_eight_consecutive_greys_are_exact() {
    let mut random = Random(5);
    for _ in 0..2000 {
        let (least, span) = (random.byte().min(240), 1 + random.next() % 8);
        let texels = std::array::from_fn(|_| {
            let grey = least + (random.next() % span) as u8;
            [grey, grey, grey, 255]
        });
        for (metric, effort) in [Metric::Rgb, SURFACE].into_iter().flat_map(|m| EFFORTS.map(|e| (m, e))) {
            assert_eq!(decoded(&encode_block(&texels, metric, effort)), texels);
        }
    }
}
