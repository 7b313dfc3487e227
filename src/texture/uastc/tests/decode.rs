//! Blocks decode to exactly what the encoder took them for.

use super::super::candidate::{Split, one_line, split_lines, two_planes};
use super::super::hints::Hints;
use super::super::moments::{ALL, Lane, moments, principal_axis};
use super::super::pack::Block;
use super::super::tables::*;
use super::*;
use crate::simd::dispatch;
use basisu::uastc::bise::{astc_get_levels, unquant_astc_endpoint_val};
use basisu::uastc::huff_modes::HUFF_MODES;
use basisu::uastc::patterns::{ASTC_BC7_PATTERNS2, ASTC_BC7_PATTERNS3};
use fearless_simd::{Level, Simd};

pub(super) fn lanes<const N: usize>(texels: &Texels) -> [Lane; N] {
    std::array::from_fn(|c| texels.map(|t| f32::from(t[c])))
}

/// One block of every mode with `N` channels.
pub(super) fn every_mode<const N: usize>(texels: &Texels) -> Vec<(u8, Block)> {
    dispatch!(Level::new(), simd => every_mode_with::<_, N>(simd, texels))
}

fn every_mode_with<S: Simd, const N: usize>(simd: S, texels: &Texels) -> Vec<(u8, Block)> {
    let lanes = lanes::<N>(texels);
    let all = moments(&lanes, &ALL);
    let axis = principal_axis(&all.scatter);
    let mut blocks = Vec::new();
    for rounds in [1, 3] {
        if N == 3 {
            blocks.push((0, one_line::<_, N, 4>(simd, &lanes, &all, &axis, &[1.0; N], &MODE_0, rounds)));
            blocks.push((1, one_line::<_, N, 2>(simd, &lanes, &all, &axis, &[1.0; N], &MODE_1, rounds)));
            blocks.push((5, one_line::<_, N, 3>(simd, &lanes, &all, &axis, &[1.0; N], &MODE_5, rounds)));
            blocks.push((18, one_line::<_, N, 5>(simd, &lanes, &all, &axis, &[1.0; N], &MODE_18, rounds)));
            for selector in 0..3 {
                let block = two_planes::<_, N, 2>(simd, &lanes, &all, selector, &[1.0; N], &MODE_6, rounds);
                blocks.push((6, block));
            }
            for pattern in 0..PATTERNS.len() {
                let split = Split::in_two(&lanes, pattern);
                blocks.push((2, split_lines::<_, N, 2, 3>(simd, &lanes, &split, &[1.0; N], &MODE_2, rounds)));
                blocks.push((4, split_lines::<_, N, 2, 2>(simd, &lanes, &split, &[1.0; N], &MODE_4, rounds)));
            }
            for split in Split::in_three(&lanes) {
                blocks.push((3, split_lines::<_, N, 3, 2>(simd, &lanes, &split, &[1.0; N], &MODE_3, rounds)));
            }
        } else {
            blocks.push((10, one_line::<_, N, 4>(simd, &lanes, &all, &axis, &[1.0; N], &MODE_10, rounds)));
            blocks.push((12, one_line::<_, N, 3>(simd, &lanes, &all, &axis, &[1.0; N], &MODE_12, rounds)));
            blocks.push((14, one_line::<_, N, 2>(simd, &lanes, &all, &axis, &[1.0; N], &MODE_14, rounds)));
            for selector in 0..4 {
                let block = two_planes::<_, N, 2>(simd, &lanes, &all, selector, &[1.0; N], &MODE_11, rounds);
                blocks.push((11, block));
            }
            for pattern in 0..PATTERNS.len() {
                blocks.push((
                    9,
                    split_lines::<_, N, 2, 2>(
                        simd,
                        &lanes,
                        &Split::in_two(&lanes, pattern),
                        &[1.0; N],
                        &MODE_9,
                        rounds,
                    ),
                ));
            }
        }
    }
    blocks
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
