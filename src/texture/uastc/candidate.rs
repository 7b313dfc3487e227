//! A block of one given mode, fitted to its texels.

use fearless_simd::Simd;

use super::line::{Line, fit};
use super::moments::{ALL, Lane, Moments, moments, part, principal_axis, scatter_along};
use super::pack::Block;
use super::tables::{Mode, PATTERNS, THIRDS};

/// Members of either subset of every pattern, as 0 and 1 per texel.
pub(super) static SUBSETS: [[Lane; 2]; PATTERNS.len()] = subsets();

const fn subsets() -> [[Lane; 2]; PATTERNS.len()] {
    let mut all = [[[0.0; 16]; 2]; PATTERNS.len()];
    let mut pattern = 0;
    while pattern < PATTERNS.len() {
        let mut i = 0;
        while i < 16 {
            all[pattern][(PATTERNS[pattern] >> i & 1) as usize][i] = 1.0;
            i += 1;
        }
        pattern += 1;
    }
    all
}

/// The same of the three-subset patterns.
static THREE_SUBSETS: [[Lane; 3]; THIRDS.len()] = three_subsets();

const fn three_subsets() -> [[Lane; 3]; THIRDS.len()] {
    let mut all = [[[0.0; 16]; 3]; THIRDS.len()];
    let mut at = 0;
    while at < 16 * 3 * THIRDS.len() {
        let (i, subset, pattern) = (at % 16, at / 16 % 3, at / 48);
        all[pattern][subset][i] = (THIRDS[pattern][subset] >> i & 1) as f32;
        at += 1;
    }
    all
}

/// The channels of an RGB block but one.
pub(super) fn rest(alone: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][alone]
}

fn empty(mode: &'static Mode) -> Block {
    Block { mode, pattern: 0, selector: 0, endpoints: [[[0; 2]; 4]; 3], weights: [[0; 16]; 2], error: 0.0 }
}

impl Block {
    /// Takes over a line whose channel `k` is channel `channels[k]` of the block.
    #[inline(always)]
    pub(super) fn place<const N: usize>(
        &mut self,
        line: &Line<N>,
        channels: [usize; N],
        subset: usize,
        plane: usize,
        members: u16,
    ) {
        for (k, &c) in channels.iter().enumerate() {
            self.endpoints[subset][c] = [line.low[k], line.high[k]];
        }
        for i in 0..16 {
            // All ones for a member: a branch-free choice.
            let keep = ((members >> i & 1) as u8).wrapping_neg();
            let weight = &mut self.weights[plane][i];
            *weight = (*weight & !keep) | (line.weights[i] & keep);
        }
        self.error += line.error;
    }
}

/// A block of one line through the first `N` channels; `BITS` are the weight bits of `mode`, here and below.
#[inline(always)]
pub(super) fn one_line<I: Simd, const N: usize, const BITS: u32>(
    simd: I,
    texels: &[Lane; N],
    all: &Moments<N>,
    axis: &[f32; N],
    scale: &[f32; N],
    mode: &'static Mode,
    rounds: usize,
) -> Block {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut block = empty(mode);
            let line = fit::<N, BITS>(texels, &ALL, all, axis, scale, mode.range, rounds);
            block.place(&line, std::array::from_fn(|c| c), 0, 0, 0xffff);
            block
        },
    )
}

/// A block whose channel `selector` has a line of its own beside that of the other channels.
#[inline(always)]
pub(super) fn two_planes<I: Simd, const N: usize, const BITS: u32>(
    simd: I,
    texels: &[Lane; N],
    all: &Moments<N>,
    selector: usize,
    scale: &[f32; N],
    mode: &'static Mode,
    rounds: usize,
) -> Block {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut block = empty(mode);
            block.selector = selector;
            let alone = fit::<1, BITS>(
                &[texels[selector]],
                &ALL,
                &part(all, [selector]),
                &[1.0],
                &[scale[selector]],
                mode.range,
                rounds,
            );
            block.place(&alone, [selector], 0, 1, 0xffff);
            if N == 2 {
                let channels = [1 - selector];
                let line = together::<N, 1, BITS>(texels, all, channels, scale, mode, rounds);
                block.place(&line, channels, 0, 0, 0xffff);
            } else if N == 3 {
                let channels = rest(selector);
                let line = together::<N, 2, BITS>(texels, all, channels, scale, mode, rounds);
                block.place(&line, channels, 0, 0, 0xffff);
            } else {
                let channels = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]][selector];
                let line = together::<N, 3, BITS>(texels, all, channels, scale, mode, rounds);
                block.place(&line, channels, 0, 0, 0xffff);
            }
            block
        },
    )
}

/// The line of the plane that holds all channels but one.
#[inline(always)]
fn together<const N: usize, const M: usize, const BITS: u32>(
    texels: &[Lane; N],
    all: &Moments<N>,
    channels: [usize; M],
    scale: &[f32; N],
    mode: &'static Mode,
    rounds: usize,
) -> Line<M> {
    let texels = channels.map(|c| texels[c]);
    let m = part(all, channels);
    let axis = principal_axis(&m.scatter);
    fit::<M, BITS>(&texels, &ALL, &m, &axis, &channels.map(|c| scale[c]), mode.range, rounds)
}

/// The `S` subsets of a pattern, ready to be fitted.
pub(super) struct Split<const N: usize, const S: usize> {
    pattern: usize,
    masks: &'static [Lane; S],
    moments: [Moments<N>; S],
    axes: [[f32; N]; S],
}

impl<const N: usize> Split<N, 2> {
    /// Split by one of the two-subset patterns.
    #[inline(always)]
    pub fn in_two(texels: &[Lane; N], pattern: usize) -> Self {
        Self::new(texels, pattern, &SUBSETS[pattern])
    }
}

impl<const N: usize> Split<N, 3> {
    /// Split by each of the three-subset patterns.
    #[inline(always)]
    pub fn in_three(texels: &[Lane; N]) -> [Self; THIRDS.len()] {
        std::array::from_fn(|pattern| Self::new(texels, pattern, &THREE_SUBSETS[pattern]))
    }
}

impl<const N: usize, const S: usize> Split<N, S> {
    #[inline(always)]
    fn new(texels: &[Lane; N], pattern: usize, masks: &'static [Lane; S]) -> Self {
        let moments = masks.each_ref().map(|mask| moments(texels, mask));
        let axes = moments.each_ref().map(|m| principal_axis(&m.scatter));
        Self { pattern, masks, moments, axes }
    }

    /// Scatter off the axes of the subsets, which stays as error, and scatter along them.
    #[inline(always)]
    pub fn scatter(&self) -> (f32, f32) {
        let [mut off, mut along] = [0.0; 2];
        for (m, axis) in self.moments.iter().zip(&self.axes) {
            let total: f32 = (0..N).map(|c| m.scatter[c][c]).sum();
            let on = scatter_along(&m.scatter, axis);
            off += total - on;
            along += on;
        }
        (off, along)
    }
}

/// A block of a line for each subset.
#[inline(always)]
pub(super) fn split_lines<I: Simd, const N: usize, const S: usize, const BITS: u32>(
    simd: I,
    texels: &[Lane; N],
    split: &Split<N, S>,
    scale: &[f32; N],
    mode: &'static Mode,
    rounds: usize,
) -> Block {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut block = empty(mode);
            block.pattern = split.pattern;
            for (subset, mask) in split.masks.iter().enumerate() {
                let (m, axis) = (&split.moments[subset], &split.axes[subset]);
                let line = fit::<N, BITS>(texels, mask, m, axis, scale, mode.range, rounds);
                block.place(&line, std::array::from_fn(|c| c), subset, 0, block.members(subset));
            }
            block
        },
    )
}
