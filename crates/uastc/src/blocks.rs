//! Blocks side by side that are being searched, and their way from and to single ones.

use fearless_simd::{Simd, SimdBase, SimdCvtFloat, SimdCvtTruncate, prelude::*, u32x16};

use crate::lanes::{Grid, take};
use crate::pack::Block;
use crate::tables::{MODE_0, Mode};
use texel_simd::{LANES, Real, Wide};

/// A [`Block`] in each lane, all its numbers as whole floats.
#[derive(Clone, Copy)]
pub(crate) struct Blocks<S: Simd> {
    pub modes: [&'static Mode; LANES],
    pub pattern: Wide<S>,
    pub selector: Wide<S>,
    pub endpoints: [[[Wide<S>; 2]; 4]; 3],
    pub weights: [Grid<S>; 2],
    pub error: Wide<S>,
}

impl<S: Simd> Blocks<S> {
    /// Blocks of one mode, all zeros.
    #[inline(always)]
    pub fn empty(simd: S, mode: &'static Mode) -> Self {
        let zero = Wide::splat(simd, 0.0);
        Self {
            modes: [mode; LANES],
            pattern: zero,
            selector: zero,
            endpoints: [[[zero; 2]; 4]; 3],
            weights: [[zero; 16]; 2],
            error: zero,
        }
    }

    /// Blocks that any other is better than.
    #[inline(always)]
    pub fn none(simd: S) -> Self {
        Self { error: Wide::splat(simd, f32::INFINITY), ..Self::empty(simd, &MODE_0) }
    }

    /// Becomes `other`, whose blocks are of one mode, where that is `allowed` and has the lesser error.
    #[inline(always)]
    pub fn offer(&mut self, other: &Self, allowed: <Wide<S> as Real>::Mask) {
        let is_better = other.error.simd_lt(self.error) & allowed;
        if is_better.any_true() {
            self.take(other, is_better);
        }
    }

    /// Becomes `other`, whose blocks are of one mode, where `mask` holds.
    #[inline(always)]
    pub fn take(&mut self, other: &Self, mask: <Wide<S> as Real>::Mask) {
        let mode = other.modes[0];
        for (j, own) in self.modes.iter_mut().enumerate() {
            if mask.to_bitmask() >> j & 1 == 1 {
                *own = mode;
            }
        }
        take(&mut self.pattern, other.pattern, mask);
        take(&mut self.selector, other.selector, mask);
        take(&mut self.error, other.error, mask);
        for (own, other) in self.endpoints.iter_mut().zip(&other.endpoints).take(mode.subsets) {
            for (own, other) in own.as_flattened_mut().iter_mut().zip(other.as_flattened()).take(2 * mode.channels) {
                take(own, *other, mask);
            }
        }
        for (own, other) in self.weights.iter_mut().zip(&other.weights).take(mode.planes) {
            for (own, other) in own.iter_mut().zip(other) {
                take(own, *other, mask);
            }
        }
    }

    /// The nearest level to a whole `level` that endpoints of the blocks' modes may have.
    #[inline(always)]
    pub fn nearest(&self, simd: S, level: Wide<S>) -> Wide<S> {
        let mut levels: [f32; LANES] = level.into();
        for (level, mode) in levels.iter_mut().zip(self.modes) {
            *level = f32::from(mode.range.level[*level as usize & 255]);
        }
        Wide::simd_from(simd, levels)
    }

    /// From single blocks.
    #[inline(always)]
    pub fn load(simd: S, blocks: [&Block; LANES]) -> Self {
        let mut all = Self::empty(simd, blocks[0].mode);
        all.modes = blocks.map(|block| block.mode);
        all.pattern = Wide::simd_from(simd, blocks.map(|block| block.pattern as f32));
        all.selector = Wide::simd_from(simd, blocks.map(|block| block.selector as f32));
        all.error = Wide::simd_from(simd, blocks.map(|block| block.error));
        for (k, four) in all.endpoints.as_flattened_mut().as_flattened_mut().as_chunks_mut().0.iter_mut().enumerate() {
            *four = unpacked(simd, blocks.map(|block| block.endpoints.as_flattened().as_flattened().as_chunks().0[k]));
        }
        for (k, four) in all.weights.as_flattened_mut().as_chunks_mut().0.iter_mut().enumerate() {
            *four = unpacked(simd, blocks.map(|block| block.weights.as_flattened().as_chunks().0[k]));
        }
        all
    }

    /// To single blocks.
    #[inline(always)]
    pub fn store(&self) -> Stored {
        let mut stored = Stored {
            modes: self.modes,
            patterns: self.pattern.into(),
            selectors: self.selector.into(),
            errors: self.error.into(),
            endpoints: [[0; LANES]; 6],
            weights: [[0; LANES]; 8],
        };
        for (words, four) in stored.endpoints.iter_mut().zip(self.endpoints.as_flattened().as_flattened().as_chunks().0)
        {
            *words = packed(four);
        }
        for (words, four) in stored.weights.iter_mut().zip(self.weights.as_flattened().as_chunks().0) {
            *words = packed(four);
        }
        stored
    }
}

/// [`Blocks`] in memory.
pub(crate) struct Stored {
    modes: [&'static Mode; LANES],
    patterns: [f32; LANES],
    selectors: [f32; LANES],
    pub errors: [f32; LANES],
    /// Four bytes of each block, all of them in the order of [`Block::endpoints`].
    endpoints: [[u32; LANES]; 6],
    /// Four bytes of each block, all of them in the order of [`Block::weights`].
    weights: [[u32; LANES]; 8],
}

impl Stored {
    /// The block in a lane.
    #[inline(always)]
    pub fn block(&self, lane: usize) -> Block {
        let mut block = Block {
            pattern: self.patterns[lane] as usize,
            selector: self.selectors[lane] as usize,
            error: self.errors[lane],
            ..Block::empty(self.modes[lane])
        };
        let endpoints = block.endpoints.as_flattened_mut().as_flattened_mut().as_chunks_mut().0;
        for (bytes, words) in endpoints.iter_mut().zip(&self.endpoints) {
            *bytes = words[lane].to_le_bytes();
        }
        for (bytes, words) in block.weights.as_flattened_mut().as_chunks_mut().0.iter_mut().zip(&self.weights) {
            *bytes = words[lane].to_le_bytes();
        }
        block
    }
}

/// Unpacks four bytes of each block into four vectors.
#[inline(always)]
fn unpacked<S: Simd>(simd: S, bytes: [[u8; 4]; LANES]) -> [Wide<S>; 4] {
    let words = u32x16::simd_from(simd, bytes.map(u32::from_le_bytes));
    [
        Wide::float_from(words & 255),
        Wide::float_from((words >> 8) & 255),
        Wide::float_from((words >> 16) & 255),
        Wide::float_from(words >> 24),
    ]
}

/// Packs four vectors into four bytes of each block.
#[inline(always)]
fn packed<S: Simd>([a, b, c, d]: &[Wide<S>; 4]) -> [u32; LANES] {
    let [a, b, c, d] =
        [u32x16::truncate_from(*a), u32x16::truncate_from(*b), u32x16::truncate_from(*c), u32x16::truncate_from(*d)];
    (a | b << 8 | c << 16 | d << 24).into()
}
