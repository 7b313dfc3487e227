//! A block of one given mode, fitted to its texels.

use super::line::{Line, fit};
use super::moments::{ALL, Lane, Moments, moments, part, principal_axis, scatter_along};
use super::pack::Block;
use super::tables::{Mode, PATTERNS};

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

/// The channels of an RGB block but one.
pub(super) fn rest(alone: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][alone]
}

fn empty(mode: &'static Mode) -> Block {
    Block { mode, pattern: 0, selector: 0, endpoints: [[[0; 2]; 4]; 2], weights: [[0; 16]; 2], error: 0.0 }
}

impl Block {
    /// Takes over a line whose channel `k` is channel `channels[k]` of the block.
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

/// A block of one line through all channels; `BITS` are the weight bits of `mode`, here and below.
pub(super) fn one_line<const N: usize, const BITS: u32>(
    texels: &[Lane; N],
    all: &Moments<N>,
    axis: &[f32; N],
    mode: &'static Mode,
    rounds: usize,
) -> Block {
    let mut block = empty(mode);
    let line = fit::<N, BITS>(texels, &ALL, all, axis, mode.range, rounds);
    block.place(&line, std::array::from_fn(|c| c), 0, 0, 0xffff);
    block
}

/// A block whose channel `selector` has a line of its own beside that of the other channels.
pub(super) fn two_planes<const N: usize, const BITS: u32>(
    texels: &[Lane; N],
    all: &Moments<N>,
    selector: usize,
    mode: &'static Mode,
    rounds: usize,
) -> Block {
    let mut block = empty(mode);
    block.selector = selector;
    let alone = fit::<1, BITS>(&[texels[selector]], &ALL, &part(all, [selector]), &[1.0], mode.range, rounds);
    block.place(&alone, [selector], 0, 1, 0xffff);
    if N == 3 {
        let channels = rest(selector);
        let line = together::<N, 2, BITS>(texels, all, channels, mode, rounds);
        block.place(&line, channels, 0, 0, 0xffff);
    } else {
        let channels = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]][selector];
        let line = together::<N, 3, BITS>(texels, all, channels, mode, rounds);
        block.place(&line, channels, 0, 0, 0xffff);
    }
    block
}

/// The line of the plane that holds all channels but one.
fn together<const N: usize, const M: usize, const BITS: u32>(
    texels: &[Lane; N],
    all: &Moments<N>,
    channels: [usize; M],
    mode: &'static Mode,
    rounds: usize,
) -> Line<M> {
    let texels = channels.map(|c| texels[c]);
    let m = part(all, channels);
    let axis = principal_axis(&m.scatter);
    fit::<M, BITS>(&texels, &ALL, &m, &axis, mode.range, rounds)
}

/// The two subsets of a pattern, ready to be fitted.
pub(super) struct Split<const N: usize> {
    pattern: usize,
    moments: [Moments<N>; 2],
    axes: [[f32; N]; 2],
}

impl<const N: usize> Split<N> {
    pub fn new(texels: &[Lane; N], pattern: usize) -> Self {
        let moments = [0, 1].map(|subset| moments(texels, &SUBSETS[pattern][subset]));
        Self { pattern, moments, axes: [0, 1].map(|subset| principal_axis(&moments[subset].scatter)) }
    }

    /// Scatter off the axes of the subsets, which stays as error, and scatter along them.
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

/// A block of two subsets with a line each.
pub(super) fn two_lines<const N: usize, const BITS: u32>(
    texels: &[Lane; N],
    split: &Split<N>,
    mode: &'static Mode,
    rounds: usize,
) -> Block {
    let mut block = empty(mode);
    block.pattern = split.pattern;
    let ones = PATTERNS[split.pattern];
    for (subset, members) in [!ones, ones].into_iter().enumerate() {
        let mask = &SUBSETS[split.pattern][subset];
        let (m, axis) = (&split.moments[subset], &split.axes[subset]);
        let line = fit::<N, BITS>(texels, mask, m, axis, mode.range, rounds);
        block.place(&line, std::array::from_fn(|c| c), subset, 0, members);
    }
    block
}
