//! Blocks decode to exactly what the encoder took them for.

use super::super::blocks::{Blocks, Stored};
use super::super::candidate::{Split, one_line, split_lines, two_planes};
use super::super::hints::Hints;
use super::super::lanes::{Grid, channels};
use super::super::moments::{moments, principal_axis};
use super::super::pack::Block;
use super::super::tables::*;
use super::*;
use crate::simd::{LANES, Wide, dispatch};
use basisu::uastc::bise::{astc_get_levels, unquant_astc_endpoint_val};
use basisu::uastc::huff_modes::HUFF_MODES;
use basisu::uastc::patterns::{ASTC_BC7_PATTERNS2, ASTC_BC7_PATTERNS3};
use fearless_simd::{Level, Simd, SimdBase};

/// One block of every mode with `N` channels.
pub(super) fn every_mode<const N: usize>(texels: &Texels) -> Vec<(u8, Block)> {
    // Any lane will do.
    let blocks = dispatch!(Level::new(), simd => every_mode_with::<_, N>(simd, texels));
    let one = |(k, blocks): (usize, Stored)| blocks.block(k % LANES);
    blocks.into_iter().enumerate().map(one).map(|block| (block.mode.number, block)).collect()
}

fn every_mode_with<S: Simd, const N: usize>(simd: S, texels: &Texels) -> Vec<Stored> {
    let lanes: [Grid<S>; N] = channels(simd, [texels; LANES]);
    let all = moments(simd, &lanes, None);
    let axis = principal_axis(simd, &all.scatter);
    let splat = |number: usize| Wide::splat(simd, number as f32);
    let ones = &[1.0; N];
    let mut blocks: Vec<Blocks<S>> = Vec::new();
    for rounds in [1, 3] {
        if N == 3 {
            blocks.push(one_line::<_, N, 4>(simd, &lanes, &all, &axis, ones, &MODE_0, rounds));
            blocks.push(one_line::<_, N, 2>(simd, &lanes, &all, &axis, ones, &MODE_1, rounds));
            blocks.push(one_line::<_, N, 3>(simd, &lanes, &all, &axis, ones, &MODE_5, rounds));
            blocks.push(one_line::<_, N, 5>(simd, &lanes, &all, &axis, ones, &MODE_18, rounds));
            for selector in 0..3 {
                blocks.push(two_planes::<_, N, 2>(simd, &lanes, &all, splat(selector), ones, &MODE_6, rounds));
            }
            for pattern in 0..PATTERNS.len() {
                let split = Split::in_two(simd, &lanes, splat(pattern));
                blocks.push(split_lines::<_, N, 2, 3>(simd, &lanes, &split, ones, &MODE_2, rounds));
                blocks.push(split_lines::<_, N, 2, 2>(simd, &lanes, &split, ones, &MODE_4, rounds));
            }
            for pattern in 0..THIRDS.len() {
                let split = Split::in_three(simd, &lanes, splat(pattern));
                blocks.push(split_lines::<_, N, 3, 2>(simd, &lanes, &split, ones, &MODE_3, rounds));
            }
        } else {
            blocks.push(one_line::<_, N, 4>(simd, &lanes, &all, &axis, ones, &MODE_10, rounds));
            blocks.push(one_line::<_, N, 3>(simd, &lanes, &all, &axis, ones, &MODE_12, rounds));
            blocks.push(one_line::<_, N, 2>(simd, &lanes, &all, &axis, ones, &MODE_14, rounds));
            for selector in 0..4 {
                blocks.push(two_planes::<_, N, 2>(simd, &lanes, &all, splat(selector), ones, &MODE_11, rounds));
            }
            for pattern in 0..PATTERNS.len() {
                let split = Split::in_two(simd, &lanes, splat(pattern));
                blocks.push(split_lines::<_, N, 2, 2>(simd, &lanes, &split, ones, &MODE_9, rounds));
            }
        }
    }
    blocks.iter().map(Blocks::store).collect()
}

/// The specification's decoder, in its slowest form.
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
            // The ramps are index * 64 / top, halves away from the middle for 4 bits and more.
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

/// The index of a mode's endpoint range in the reference.
fn endpoint_range(mode: &Mode) -> u32 {
    let levels = mode.range.base << mode.range.bits;
    (0..21).find(|&r| astc_get_levels(r) == levels).unwrap()
}

#[test]
fn every_mode_decodes_as_predicted() {
    let hints = Hints { bias: 13, eac: 0x1b, ..Hints::default() };
    for texels in all_kinds() {
        let blocks = [every_mode::<3>(&texels), every_mode::<4>(&texels)];
        for (number, block) in blocks.into_iter().flatten() {
            let channels = block.mode.channels;
            let (error, predicted) = (block.error, expected(&block));
            let bytes = block.pack(&hints);
            assert_eq!(HUFF_MODES[usize::from(bytes[0] & 127)], number);
            assert_eq!(decoded(&bytes), predicted, "mode {number}, {texels:?}");
            let actual = squared_error(&predicted, &texels, channels);
            assert_eq!(error, actual as f32, "mode {number}, {texels:?}");
        }
    }
}

#[test]
fn ranges_and_patterns_are_the_format_s() {
    for mode in [&MODE_0, &MODE_2, &MODE_3, &MODE_4, &MODE_5, &MODE_6, &MODE_10, &MODE_18] {
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
    for (bits, pattern) in PATTERNS.iter().zip(ASTC_BC7_PATTERNS2) {
        for (i, subset) in pattern.into_iter().enumerate() {
            assert_eq!((bits >> i & 1) as u8, subset);
        }
    }
    for (masks, pattern) in THIRDS.iter().zip(ASTC_BC7_PATTERNS3) {
        for (i, subset) in pattern.into_iter().enumerate() {
            assert_eq!(masks.map(|mask| mask >> i & 1 == 1), [0, 1, 2].map(|s| s == subset));
        }
    }
}

#[test]
fn rgb_is_opaque_and_ignores_alpha() {
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
            let block = encode_block(&[colour; 16], Metric::Rgba, effort);
            assert_eq!(decoded(&block), [colour; 16]);
            let [r, g, b, _] = colour;
            let block = encode_block(&[colour; 16], Metric::Rgb, effort);
            assert_eq!(decoded(&block), [[r, g, b, 255]; 16]);
        }
    }
}

#[test]
fn up_to_eight_greys_in_a_row_are_exact() {
    let mut random = Random(5);
    for _ in 0..2000 {
        let (least, span) = (random.byte().min(240), 1 + random.next() % 8);
        let texels = std::array::from_fn(|_| {
            let grey = least + (random.next() % span) as u8;
            [grey, grey, grey, 255]
        });
        for (metric, effort) in [Metric::Rgb, Metric::Surface].into_iter().flat_map(|m| EFFORTS.map(|e| (m, e))) {
            assert_eq!(decoded(&encode_block(&texels, metric, effort)), texels);
        }
    }
}
