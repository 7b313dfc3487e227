//! Candidates: blocks of one given mode, fitted to their texels.

#![expect(clippy::needless_range_loop, reason = "loops over channels read several arrays at one index")]

use fearless_simd::{Select, Simd, SimdBase, SimdCvtFloat, prelude::*};

use crate::blocks::Blocks;
use crate::lanes::Grid;
use crate::line::{Line, Points};
use crate::moments::{Moments, moments, principal_axis, scatter_along, trace};
use crate::partition::BestPatterns;
use crate::tables::{Mode, PATTERNS_2, PATTERNS_3};
use texel_simd::{LANES, Wide, WideU32};

/// Returns the channels of texel `i`.
#[inline(always)]
pub(crate) fn texel<S: Simd, const N: usize>(texels: &[Grid<S>; N], i: usize) -> [Wide<S>; N] {
    let mut texel = [texels[0][i]; N];
    for c in 1..N {
        texel[c] = texels[c][i];
    }
    texel
}

/// Splits the channels of texels into the channel at `selector` and the `M` other channels.
#[inline(always)]
pub(crate) fn split_channels<S: Simd, const N: usize, const M: usize>(
    texels: &[Grid<S>; N],
    selector: Wide<S>,
) -> ([Grid<S>; 1], [Grid<S>; M]) {
    let (mut single, mut others) = ([texels[0]], [texels[0]; M]);
    for i in 0..16 {
        let texel = texel(texels, i);
        single[0][i] = channel_at(selector, &texel);
        let other: [Wide<S>; M] = other_channels(selector, &texel);
        for k in 0..M {
            others[k][i] = other[k];
        }
    }
    (single, others)
}

/// Copies one number for each channel to all lanes.
#[inline(always)]
pub(crate) fn splat<S: Simd, const N: usize>(simd: S, numbers: &[f32; N]) -> [Wide<S>; N] {
    let mut all = [Wide::splat(simd, numbers[0]); N];
    for c in 1..N {
        all[c] = Wide::splat(simd, numbers[c]);
    }
    all
}

/// Returns all channels except the one at `selector`.
#[inline(always)]
pub(crate) fn other_channels<S: Simd, const N: usize, const M: usize>(
    selector: Wide<S>,
    channels: &[Wide<S>; N],
) -> [Wide<S>; M] {
    let mut rest = [channels[0]; M];
    for k in 0..M {
        rest[k] = selector.simd_gt(k as f32).select(channels[k], channels[k + 1]);
    }
    rest
}

/// Returns the channel at `selector`.
#[inline(always)]
pub(crate) fn channel_at<S: Simd, const N: usize>(selector: Wide<S>, channels: &[Wide<S>; N]) -> Wide<S> {
    let mut found = channels[0];
    for c in 1..N {
        found = selector.simd_eq(c as f32).select(channels[c], found);
    }
    found
}

impl<S: Simd> Blocks<S> {
    /// Sets the endpoints of `subset` and the weights of the texels in `mask` to those of a line, and adds its error.
    #[inline(always)]
    pub(crate) fn set_line<const N: usize>(&mut self, line: &Line<S, N>, subset: usize, mask: Option<&Grid<S>>) {
        for c in 0..N {
            self.endpoints[subset][c] = [line.low[c], line.high[c]];
        }
        for i in 0..16 {
            match mask {
                Some(mask) => self.weights[0][i] += mask[i] * line.weights[i],
                None => self.weights[0][i] = line.weights[i],
            }
        }
        self.error += line.error;
    }

    /// Sets endpoints, weights and error to those of two planes: the channel at the selector, and the other channels.
    #[inline(always)]
    pub(crate) fn set_planes<const N: usize, const M: usize>(&mut self, single: &Line<S, 1>, others: &Line<S, M>) {
        for c in 0..N {
            let is_single = self.selector.simd_eq(c as f32);
            let is_before = self.selector.simd_gt(c as f32);
            let (before, after) = (c.min(M - 1), c.saturating_sub(1));
            let low = is_before.select(others.low[before], others.low[after]);
            let high = is_before.select(others.high[before], others.high[after]);
            self.endpoints[0][c] = [is_single.select(single.low[0], low), is_single.select(single.high[0], high)];
        }
        self.weights = [others.weights, single.weights];
        self.error = single.error + others.error;
    }
}

/// Returns blocks of one line through the first `N` channels.
#[inline(always)]
pub(crate) fn one_line<S: Simd, const N: usize>(
    simd: S,
    texels: &[Grid<S>; N],
    all: &Moments<S, N>,
    axis: &[Wide<S>; N],
    scale: &[Wide<S>; N],
    mode: &'static Mode,
    rounds: usize,
) -> Blocks<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut blocks = Blocks::empty(simd, mode);
            let points = Points { texels, subset: None, scale: *scale, range: mode.range, ramp: mode.ramp() };
            blocks.set_line(&points.fit(simd, all, axis, rounds), 0, None);
            blocks
        },
    )
}

/// Returns blocks of two planes: one line for the channel at `selector` and one line for the other channels.
#[inline(always)]
pub(crate) fn two_planes<S: Simd, const N: usize>(
    simd: S,
    texels: &[Grid<S>; N],
    all: &Moments<S, N>,
    selector: Wide<S>,
    scale: &[Wide<S>; N],
    mode: &'static Mode,
    rounds: usize,
) -> Blocks<S> {
    simd.vectorize(
        #[inline(always)]
        || match N {
            2 => planes::<S, N, 1>(simd, texels, all, selector, scale, mode, rounds),
            4 => planes::<S, N, 3>(simd, texels, all, selector, scale, mode, rounds),
            _ => planes::<S, N, 2>(simd, texels, all, selector, scale, mode, rounds),
        },
    )
}

/// Implements [`two_planes`] with `M`, which is one less than `N`.
#[inline(always)]
fn planes<S: Simd, const N: usize, const M: usize>(
    simd: S,
    texels: &[Grid<S>; N],
    all: &Moments<S, N>,
    selector: Wide<S>,
    scale: &[Wide<S>; N],
    mode: &'static Mode,
    rounds: usize,
) -> Blocks<S> {
    let zero = Wide::splat(simd, 0.0);
    let (single, others) = split_channels::<_, N, M>(texels, selector);
    let (mut own, mut columns, mut scatter) = ([zero; N], [[zero; N]; M], [[zero; M]; M]);
    for c in 0..N {
        own[c] = all.scatter[c][c];
        let row: [Wide<S>; M] = other_channels(selector, &all.scatter[c]);
        for k in 0..M {
            columns[k][c] = row[k];
        }
    }
    for k in 0..M {
        scatter[k] = other_channels(selector, &columns[k]);
    }
    let single_moments =
        Moments { count: all.count, sums: [channel_at(selector, &all.sums)], scatter: [[channel_at(selector, &own)]] };
    let other_moments = Moments { count: all.count, sums: other_channels(selector, &all.sums), scatter };

    let points = Points {
        texels: &single,
        subset: None,
        scale: [channel_at(selector, scale)],
        range: mode.range,
        ramp: mode.ramp(),
    };
    let single = points.fit(simd, &single_moments, &[Wide::splat(simd, 1.0)], rounds);
    let points = Points {
        texels: &others,
        subset: None,
        scale: other_channels(selector, scale),
        range: mode.range,
        ramp: mode.ramp(),
    };
    let axis = principal_axis(simd, &other_moments.scatter);
    let others = points.fit(simd, &other_moments, &axis, rounds);
    let mut blocks = Blocks::empty(simd, mode);
    blocks.selector = selector;
    blocks.set_planes::<N, M>(&single, &others);
    blocks
}

/// The `K` subsets of a pattern with their moments and principal axes.
pub(crate) struct Split<S: Simd, const N: usize, const K: usize> {
    pattern: Wide<S>,
    masks: [Grid<S>; K],
    moments: [Moments<S, N>; K],
    axes: [[Wide<S>; N]; K],
}

/// Returns 1 for the texels of a subset of a pattern and 0 for the others. `members` returns the subset as bits, bit i
/// for texel i.
#[inline(always)]
fn mask<S: Simd>(simd: S, pattern: Wide<S>, members: impl Fn(usize) -> u16) -> Grid<S> {
    let pattern: [f32; LANES] = pattern.into();
    let bits = WideU32::simd_from(simd, pattern.map(|p| u32::from(members(p as usize))));
    let mut mask = [Wide::splat(simd, 0.0); 16];
    for (i, member) in mask.iter_mut().enumerate() {
        *member = Wide::float_from((bits >> i as u32) & 1);
    }
    mask
}

/// Returns the masks of the subsets of two-subset patterns.
#[inline(always)]
fn two_subset_masks<S: Simd>(simd: S, pattern: Wide<S>) -> [Grid<S>; 2] {
    let members = |p: usize| PATTERNS_2[p % PATTERNS_2.len()];
    [mask(simd, pattern, |p| !members(p)), mask(simd, pattern, members)]
}

/// Returns the masks of the subsets of three-subset patterns.
#[inline(always)]
fn three_subset_masks<S: Simd>(simd: S, pattern: Wide<S>) -> [Grid<S>; 3] {
    let members = |p: usize| PATTERNS_3[p % PATTERNS_3.len()];
    [
        mask(simd, pattern, |p| members(p)[0]),
        mask(simd, pattern, |p| members(p)[1]),
        mask(simd, pattern, |p| members(p)[2]),
    ]
}

impl<S: Simd> Blocks<S> {
    /// Returns the masks of the subsets of blocks of one mode: 1 for a member, 0 for other texels. Returns `None` if
    /// the mode has one subset.
    #[inline(always)]
    pub(crate) fn masks(&self, simd: S) -> Option<[Grid<S>; 3]> {
        match self.modes[0].subsets {
            1 => None,
            2 => {
                let [zero, one] = two_subset_masks(simd, self.pattern);
                Some([zero, one, one])
            }
            _ => Some(three_subset_masks(simd, self.pattern)),
        }
    }
}

impl<S: Simd, const N: usize> Split<S, N, 2> {
    /// Splits texels by a two-subset pattern.
    #[inline(always)]
    pub fn two_subsets(simd: S, texels: &[Grid<S>; N], pattern: Wide<S>) -> Self {
        Self::new(simd, texels, pattern, two_subset_masks(simd, pattern))
    }
}

impl<S: Simd, const N: usize> Split<S, N, 3> {
    /// Splits texels by a three-subset pattern.
    #[inline(always)]
    pub fn three_subsets(simd: S, texels: &[Grid<S>; N], pattern: Wide<S>) -> Self {
        Self::new(simd, texels, pattern, three_subset_masks(simd, pattern))
    }

    /// Returns the `M` three-subset patterns with the least squared errors expected for lines of 2-bit weights.
    #[inline(always)]
    pub fn likely_patterns<const M: usize>(simd: S, texels: &[Grid<S>; N]) -> [Wide<S>; M] {
        let mut least = BestPatterns::new(simd);
        for pattern in 0..PATTERNS_3.len() {
            let pattern = Wide::splat(simd, pattern as f32);
            let (off_axis, along) = Self::three_subsets(simd, texels, pattern).scatter(simd);
            least.insert(off_axis + along / 12.0, pattern);
        }
        least.patterns
    }
}

impl<S: Simd, const N: usize, const K: usize> Split<S, N, K> {
    #[inline(always)]
    fn new(simd: S, texels: &[Grid<S>; N], pattern: Wide<S>, masks: [Grid<S>; K]) -> Self {
        let mut parts = [moments(simd, texels, Some(&masks[0])); K];
        let mut axes = [principal_axis(simd, &parts[0].scatter); K];
        for k in 1..K {
            parts[k] = moments(simd, texels, Some(&masks[k]));
            axes[k] = principal_axis(simd, &parts[k].scatter);
        }
        Self { pattern, masks, moments: parts, axes }
    }

    /// Returns the scatter off the axes of the subsets, which remains as error, and the scatter along the axes.
    #[inline(always)]
    pub fn scatter(&self, simd: S) -> (Wide<S>, Wide<S>) {
        let [mut off_axis, mut along] = [Wide::splat(simd, 0.0); 2];
        for (m, axis) in self.moments.iter().zip(&self.axes) {
            let on = scatter_along(simd, &m.scatter, axis);
            off_axis += trace(&m.scatter) - on;
            along += on;
        }
        (off_axis, along)
    }
}

/// Returns blocks of one line for each subset.
#[inline(always)]
pub(crate) fn split_lines<S: Simd, const N: usize, const K: usize>(
    simd: S,
    texels: &[Grid<S>; N],
    split: &Split<S, N, K>,
    scale: &[Wide<S>; N],
    mode: &'static Mode,
    rounds: usize,
) -> Blocks<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut blocks = Blocks::empty(simd, mode);
            blocks.pattern = split.pattern;
            for (subset, mask) in split.masks.iter().enumerate() {
                let (m, axis) = (&split.moments[subset], &split.axes[subset]);
                let points = Points { texels, subset: Some(mask), scale: *scale, range: mode.range, ramp: mode.ramp() };
                blocks.set_line(&points.fit(simd, m, axis, rounds), subset, Some(mask));
            }
            blocks
        },
    )
}
