//! The texels of one block.

use super::super::lanes::ROUND;
use super::super::tables::Range;

/// One number per texel, row 0 first.
pub(in super::super) type Lane = [f32; 16];

/// Sum over the texels, in four parts that vectorise.
#[inline(always)]
pub(super) fn sum(v: impl Fn(usize) -> f32) -> f32 {
    let mut parts = [0.0; 4];
    for k in 0..4 {
        for (j, part) in parts.iter_mut().enumerate() {
            *part += v(4 * k + j);
        }
    }
    (parts[0] + parts[2]) + (parts[1] + parts[3])
}

/// Nearest level of `range` to a value, which may lie outside of 0..=255.
#[inline(always)]
pub(super) fn quantise(range: &Range, value: f32) -> u8 {
    range.level[((value.clamp(0.0, 255.0) + ROUND).to_bits() & 255) as usize]
}
