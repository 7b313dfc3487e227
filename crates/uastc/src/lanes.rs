//! Vectors with one block in each lane.
//!
//! A block is small, and its search is full of sums and choices that vectors of one block's texels would compute
//! badly. A vector therefore holds one number of each of [`LANES`] blocks. Each block gets the bits that a search of
//! this block alone would give.
//!
//! All code on vectors must be inlined into the function that is compiled for the processor's instruction set.
//! Functions and closures are therefore `inline(always)`. The standard library's `map`, `fold` and `from_fn` are not
//! inlined reliably and process single numbers only. With vectors in them, the encoder was no faster than one block at
//! a time.

use fearless_simd::{Select, Simd, SimdBase, SimdCvtFloat, prelude::*};

use texel_simd::{LANES, Real, Wide, WideU32};

/// 1.5 * 2^23. Adding and subtracting this number rounds a number below 2^22 to the nearest integer, and the low bits
/// of the sum are this integer. (The standard `round` is a function call on baseline x86-64.)
pub(crate) const ROUND: f32 = 12_582_912.0;

/// A number for each texel of the block in each lane, row 0 first.
pub(crate) type Grid<S> = [Wide<S>; 16];

/// A number for each texel of a single block, row 0 first.
pub(crate) type ScalarGrid = [f32; 16];

/// Texels of one block.
pub(crate) type Texels = [[u8; 4]; 16];

/// Loads the first `N` channels of one block into each lane.
#[inline(always)]
pub(crate) fn channels<S: Simd, const N: usize>(simd: S, blocks: [&Texels; LANES]) -> [Grid<S>; N] {
    let mut grids = [[Wide::splat(simd, 0.0); 16]; N];
    for i in 0..16 {
        let words: [u32; LANES] = std::array::from_fn(|j| u32::from_le_bytes(blocks[j][i]));
        let words = WideU32::simd_from(simd, words);
        for (c, grid) in grids.iter_mut().enumerate() {
            grid[i] = Wide::float_from((words >> (8 * c as u32)) & 255);
        }
    }
    grids
}

/// Sums `v` over the texels, for one block or for one block in each lane.
#[inline(always)]
pub(crate) fn sum<F: Real>(v: impl Fn(usize) -> F) -> F {
    // Four independent sums, so that an addition does not wait for the addition before.
    let mut parts = [v(0), v(1), v(2), v(3)];
    for k in 1..4 {
        for (j, part) in parts.iter_mut().enumerate() {
            *part = *part + v(4 * k + j);
        }
    }
    (parts[0] + parts[2]) + (parts[1] + parts[3])
}

/// Returns a mask that is set in all lanes.
#[inline(always)]
pub(crate) fn all_lanes<S: Simd>(simd: S) -> <Wide<S> as Real>::Mask {
    Wide::splat(simd, 0.0).simd_eq(0.0)
}

/// Rounds a number below 2^22 to the nearest integer.
#[inline(always)]
pub(crate) fn round<F: Real>(v: F) -> F {
    v + v.splat_like(ROUND) - v.splat_like(ROUND)
}

/// Sets `number` to `other` where `mask` is set.
#[inline(always)]
pub(crate) fn set_where<S: Simd>(number: &mut Wide<S>, other: Wide<S>, mask: <Wide<S> as Real>::Mask) {
    *number = mask.select(other, *number);
}

/// Returns the entries of `table` at whole numbers from 0 to 255.
#[inline(always)]
pub(crate) fn look_up<S: Simd>(simd: S, table: &[u8; 256], at: Wide<S>) -> Wide<S> {
    let at: [f32; LANES] = (at + ROUND).into();
    Wide::simd_from(simd, at.map(|v| f32::from(table[(v.to_bits() & 255) as usize])))
}
