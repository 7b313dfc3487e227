//! Blocks side by side.
//!
//! A block is small and its search full of sums and choices, which vectors of its own texels would do badly. So a
//! vector holds one number of each of [`LANES`] blocks, and every block gets the bits that it would get alone.
//!
//! All code on vectors must end up inside of the function that is compiled for the processor's instructions: functions
//! and closures are `inline(always)`, and the standard library's `map`, `fold` and `from_fn`, which are not, see single
//! numbers only. With them the encoder was no faster than one block at a time.

use fearless_simd::{Select, Simd, SimdBase, SimdCvtFloat, prelude::*, u32x16};

use texel_simd::{LANES, Real, Wide};

/// 1.5 * 2^23: adding and subtracting it rounds a number of less than 2^22 to the nearest integer,
/// and the low bits of the sum are that integer. (`round` takes a call on baseline x86-64.)
pub(crate) const ROUND: f32 = 12_582_912.0;

/// A number for each texel of a block, row 0 first, of blocks side by side.
pub(crate) type Grid<S> = [Wide<S>; 16];

/// A number for each texel of one block, row 0 first.
pub(crate) type Lane = [f32; 16];

/// Texels of one block.
pub(crate) type Texels = [[u8; 4]; 16];

/// The first `N` channels of blocks side by side.
#[inline(always)]
pub(crate) fn channels<S: Simd, const N: usize>(simd: S, blocks: [&Texels; LANES]) -> [Grid<S>; N] {
    let mut grids = [[Wide::splat(simd, 0.0); 16]; N];
    for i in 0..16 {
        let words: [u32; LANES] = std::array::from_fn(|j| u32::from_le_bytes(blocks[j][i]));
        let words = u32x16::simd_from(simd, words);
        for (c, grid) in grids.iter_mut().enumerate() {
            grid[i] = Wide::float_from((words >> (8 * c as u32)) & 255);
        }
    }
    grids
}

/// Sum over the texels, of one block or of several side by side.
#[inline(always)]
pub(crate) fn sum<F: Real>(v: impl Fn(usize) -> F) -> F {
    // Four sums at once, so that none waits for the one before.
    let mut parts = [v(0), v(1), v(2), v(3)];
    for k in 1..4 {
        for (j, part) in parts.iter_mut().enumerate() {
            *part = *part + v(4 * k + j);
        }
    }
    (parts[0] + parts[2]) + (parts[1] + parts[3])
}

/// True in all lanes.
#[inline(always)]
pub(crate) fn every<S: Simd>(simd: S) -> <Wide<S> as Real>::Mask {
    Wide::splat(simd, 0.0).simd_eq(0.0)
}

/// Sets `own` to `other` where `mask` holds.
#[inline(always)]
pub(crate) fn take<S: Simd>(own: &mut Wide<S>, other: Wide<S>, mask: <Wide<S> as Real>::Mask) {
    *own = mask.select(other, *own);
}

/// `table` at whole numbers from 0 to 255.
#[inline(always)]
pub(crate) fn look_up<S: Simd>(simd: S, table: &[u8; 256], at: Wide<S>) -> Wide<S> {
    let at: [f32; LANES] = (at + ROUND).into();
    Wide::simd_from(simd, at.map(|v| f32::from(table[(v.to_bits() & 255) as usize])))
}
