//! Blocks during a search, one in each lane, and conversion from and to single blocks.

use fearless_simd::{Simd, SimdBase, SimdCvtFloat, SimdCvtTruncate, prelude::*};

use crate::lanes::{Grid, set_where};
use crate::pack::Block;
use crate::tables::{MODE_0, Mode};
use texel_simd::{LANES, Real, Wide, WideU32};

/// A [`Block`] in each lane. All numbers are whole floats.
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
    /// Creates blocks of one mode whose numbers are all 0.
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

    /// Creates blocks with infinite errors, which any other block replaces.
    #[inline(always)]
    pub fn none(simd: S) -> Self {
        Self { error: Wide::splat(simd, f32::INFINITY), ..Self::empty(simd, &MODE_0) }
    }

    /// Replaces the blocks by those of `other` in the `allowed` lanes in which `other` has the smaller error. All
    /// blocks of `other` have one mode.
    #[inline(always)]
    pub fn keep_better(&mut self, other: &Self, allowed: <Wide<S> as Real>::Mask) {
        let is_better = other.error.simd_lt(self.error) & allowed;
        if is_better.any_true() {
            self.set_where(other, is_better);
        }
    }

    /// Replaces the blocks by those of `other` where `mask` is set. All blocks of `other` have one mode.
    #[inline(always)]
    pub fn set_where(&mut self, other: &Self, mask: <Wide<S> as Real>::Mask) {
        let mode = other.modes[0];
        for (j, own) in self.modes.iter_mut().enumerate() {
            if mask.to_bitmask() >> j & 1 == 1 {
                *own = mode;
            }
        }
        set_where(&mut self.pattern, other.pattern, mask);
        set_where(&mut self.selector, other.selector, mask);
        set_where(&mut self.error, other.error, mask);
        for (own, other) in self.endpoints.iter_mut().zip(&other.endpoints).take(mode.subsets) {
            for (own, other) in own.as_flattened_mut().iter_mut().zip(other.as_flattened()).take(2 * mode.channels) {
                set_where(own, *other, mask);
            }
        }
        for (own, other) in self.weights.iter_mut().zip(&other.weights).take(mode.planes) {
            for (own, other) in own.iter_mut().zip(other) {
                set_where(own, *other, mask);
            }
        }
    }

    /// Returns the endpoint level nearest to `level` in the mode of each block.
    #[inline(always)]
    pub fn nearest(&self, simd: S, level: Wide<S>) -> Wide<S> {
        let mut levels: [f32; LANES] = level.into();
        for (level, mode) in levels.iter_mut().zip(self.modes) {
            *level = f32::from(mode.range.level[*level as usize & 255]);
        }
        Wide::simd_from(simd, levels)
    }

    /// Loads one block into each lane.
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

    /// Stores the blocks to memory, from which [`Stored::block`] reads single blocks.
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
    /// The bytes of [`Block::endpoints`] of each block, in words of four.
    endpoints: [[u32; LANES]; 6],
    /// The bytes of [`Block::weights`] of each block, in words of four.
    weights: [[u32; LANES]; 8],
}

impl Stored {
    /// Returns the block in a lane.
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
    let words = WideU32::simd_from(simd, bytes.map(u32::from_le_bytes));
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
    let [a, b, c, d] = [
        WideU32::truncate_from(*a),
        WideU32::truncate_from(*b),
        WideU32::truncate_from(*c),
        WideU32::truncate_from(*d),
    ];
    (a | b << 8 | c << 16 | d << 24).into()
}
