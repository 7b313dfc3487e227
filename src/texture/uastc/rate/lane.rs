//! The texels of one block.

use super::super::lanes::ROUND;
use super::super::tables::Range;

/// One number per texel, row 0 first.
pub(in super::super) type Lane = [f32; 16];

/// Nearest level of `range` to a value, which may lie outside of 0..=255.
#[inline(always)]
pub(super) fn quantise(range: &Range, value: f32) -> u8 {
    range.level[((value.clamp(0.0, 255.0) + ROUND).to_bits() & 255) as usize]
}
