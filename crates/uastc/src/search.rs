//! Chooses the modes of blocks of colours.
//!
//! Both efforts fit candidates and keep the one with the least squared error. `best_rgb` fits all candidates that pay.
//! The `fast` functions first estimate errors from the moments of the colours and fit only candidates that can win.
//! On 83,000 blocks of eighteen real maps, these estimates cost 0.03 dB.

use fearless_simd::{Select, Simd, SimdBase, prelude::*};

use crate::blocks::Blocks;
use crate::candidate::{Split, one_line, splat, split_lines, two_planes};
use crate::lanes::{Grid, all_lanes, sum};
use crate::line::Points;
use crate::moments::{Moments, moments, principal_axis, scatter_along, trace};
use crate::partition::likely_patterns;
use crate::tables::{MODE_0, MODE_1, MODE_2, MODE_4, MODE_5, MODE_6, MODE_15, MODE_18, Mode};
use texel_simd::{Real, Wide};

/// Rounds of regression of thorough searches. A third round gains 0.04 dB.
const ROUNDS: usize = 2;

/// Rounds of regression of quick searches. A second round gains 0.1 dB on real maps and takes a quarter more time.
const FAST_ROUNDS: usize = 1;

/// The error of a block below which a second subset hardly ever wins. (A difference of one level in all three channels
/// of every texel is an error of 48.)
pub(crate) const GOOD_ERROR: f32 = 100.0;

impl<S: Simd> Blocks<S> {
    /// Tries the modes of grey and of grey with alpha for blocks whose texels are all grey, with `passes` over single
    /// endpoints.
    #[inline(always)]
    pub fn try_grey(&mut self, simd: S, texels: &[Grid<S>; 3], scale: &[f32; 3], passes: usize) {
        let is_grey = is_grey(texels, scale);
        if is_grey.any_true() {
            let weight = scale[0] * scale[0] + scale[1] * scale[1] + scale[2] * scale[2];
            let mut green = texels[1];
            for level in &mut green {
                // Exact: scales are powers of two.
                *level *= 1.0 / scale[1];
            }
            self.keep_better(&grey(simd, &[green], weight, &MODE_15, passes), is_grey);
            self.keep_better(&grey(simd, &[green], weight, &MODE_18, passes), is_grey);
        }
    }

    /// Tries two planes, where the second plane holds the channel that gains most.
    #[inline(always)]
    pub fn try_planes(&mut self, simd: S, texels: &[Grid<S>; 3], scale: &[f32; 3]) {
        let all = moments(simd, texels, None);
        let (selector, _) = likely_planes(simd, &all);
        let scale = splat(simd, scale);
        self.keep_better(&two_planes(simd, texels, &all, selector, &scale, &MODE_6, FAST_ROUNDS), all_lanes(simd));
    }

    /// Tries two subsets in the likeliest pattern.
    #[inline(always)]
    pub fn try_subsets<const N: usize>(&mut self, simd: S, texels: &[Grid<S>; N], scale: &[Wide<S>; N]) {
        let all = moments(simd, texels, None);
        let axis = principal_axis(simd, &all.scatter);
        let [pattern] = likely_patterns(simd, texels, &all, &axis);
        let split = Split::two_subsets(simd, texels, pattern);
        let (off_axis, along) = split.scatter(simd);
        let is_likely = (off_axis + along / 12.0).simd_lt(self.error * 1.4);
        if is_likely.any_true() {
            // The finer weights of mode 2 would gain 0.5 % of the angle of normals and take 12 % more time.
            self.keep_better(&split_lines(simd, texels, &split, scale, &MODE_4, FAST_ROUNDS), is_likely);
        }
    }

    /// Tries one line in the mode that suits its length.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "those of `one_line`")]
    pub fn try_line<const N: usize>(
        &mut self,
        simd: S,
        texels: &[Grid<S>; N],
        all: &Moments<S, N>,
        axis: &[Wide<S>; N],
        scale: &[Wide<S>; N],
        rounds: usize,
        allowed: <Wide<S> as Real>::Mask,
    ) {
        let along = scatter_along(simd, &all.scatter, axis);
        let off = trace(&all.scatter) - along;
        let is_short = along.simd_lt(300.0);
        let is_long = along.simd_gt(25000.0) & off.simd_lt(along * 0.02);
        let [short, long, middle] = [allowed & is_short, allowed & is_long, allowed & !is_short & !is_long];
        if short.any_true() {
            // Short lines gain more from exact endpoints than from sixteen weights.
            self.keep_better(&one_line(simd, texels, all, axis, scale, &MODE_5, rounds), short);
        }
        if long.any_true() {
            // Long lines gain more from 32 weights than from fine endpoints.
            self.keep_better(&one_line(simd, texels, all, axis, scale, &MODE_18, rounds), long);
        }
        if middle.any_true() {
            self.keep_better(&one_line(simd, texels, all, axis, scale, &MODE_0, rounds), middle);
        }
    }
}

/// Returns a mask of the blocks with equal red, green and blue in all texels.
#[inline(always)]
fn is_grey<S: Simd>([r, g, b]: &[Grid<S>; 3], scale: &[f32; 3]) -> <Wide<S> as Real>::Mask {
    // Exact: scales are powers of two.
    let [red, green, blue] = [1.0 / scale[0], 1.0 / scale[1], 1.0 / scale[2]];
    let off = sum(
        #[inline(always)]
        |i| {
            let (x, z) = (r[i] * red - g[i] * green, b[i] * blue - g[i] * green);
            x * x + z * z
        },
    );
    off.simd_eq(0.0)
}

/// Fits blocks of grey `texels`, whose squared differences are multiplied by `weight`.
#[inline(always)]
fn grey<S: Simd>(simd: S, texels: &[Grid<S>; 1], weight: f32, mode: &'static Mode, passes: usize) -> Blocks<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let one = [Wide::splat(simd, 1.0)];
            let points = Points { texels, subset: None, scale: one, range: mode.range, ramp: mode.ramp() };
            let mut line = points.fit(simd, &moments(simd, texels, None), &one, ROUNDS);
            let (mut low, mut high) = (texels[0][0], texels[0][0]);
            for level in texels[0] {
                low = Real::min(low, level);
                high = Real::max(high, level);
            }
            // If exact endpoints differ by the number of weights, each weight decodes to the next level. Decoding
            // rounds down, and rounds bright levels down less.
            let last = points.ramp.last;
            let distance = low.simd_lt(51.0).select(Wide::splat(simd, last + 1.0), Wide::splat(simd, last));
            low = Real::min(low, Wide::splat(simd, 255.0 - last));
            high = Real::max(high, low + distance);
            let (spanning, _) = points.quantised_line(simd, &[low], &[high]);
            line.set_where(&spanning, spanning.error.simd_lt(line.error));
            line = points.polish(simd, line, passes);
            let mut blocks = Blocks::empty(simd, mode);
            blocks.set_line(&line, 0, None);
            let [grey, ..] = blocks.endpoints[0];
            let alpha = [Wide::splat(simd, 255.0); 2];
            blocks.endpoints[0] = if mode.has_alpha() { [grey, alpha, grey, grey] } else { [grey; 4] };
            blocks.error *= weight;
            blocks
        },
    )
}

/// Fits all modes that pay to opaque `texels`, whose levels are multiplied by `scale`, and returns the best blocks.
#[inline(always)]
pub(crate) fn best_rgb<S: Simd>(simd: S, texels: &[Grid<S>; 3], scale: &[f32; 3]) -> Blocks<S> {
    let scales = splat(simd, scale);
    let all = moments(simd, texels, None);
    let axis = principal_axis(simd, &all.scatter);
    let mut winner = one_line(simd, texels, &all, &axis, &scales, &MODE_0, ROUNDS);
    let every_lane = all_lanes(simd);
    // Long lines need many weights, and short lines need exact endpoints.
    let along = scatter_along(simd, &all.scatter, &axis);
    let is_long = along.simd_gt(400.0);
    if is_long.any_true() {
        winner.keep_better(&one_line(simd, texels, &all, &axis, &scales, &MODE_18, ROUNDS), is_long);
    }
    let is_short = along.simd_lt(3000.0);
    if is_short.any_true() {
        winner.keep_better(&one_line(simd, texels, &all, &axis, &scales, &MODE_5, ROUNDS), is_short);
    }
    let is_shortest = along.simd_lt(200.0);
    if is_shortest.any_true() {
        winner.keep_better(&one_line(simd, texels, &all, &axis, &scales, &MODE_1, ROUNDS), is_shortest);
    }
    for selector in [0.0, 1.0, 2.0] {
        let selector = Wide::splat(simd, selector);
        winner.keep_better(&two_planes(simd, texels, &all, selector, &scales, &MODE_6, ROUNDS), every_lane);
    }
    for pattern in likely_patterns::<_, 3, 2>(simd, texels, &all, &axis) {
        let split = Split::two_subsets(simd, texels, pattern);
        let is_likely = split.scatter(simd).0.simd_le(winner.error);
        if !is_likely.any_true() {
            continue;
        }
        winner.keep_better(&split_lines(simd, texels, &split, &scales, &MODE_4, ROUNDS), is_likely);
        // Below this error, the sixteen endpoint levels of mode 2 are too coarse.
        let is_coarse = is_likely & winner.error.simd_gt(150.0);
        if is_coarse.any_true() {
            winner.keep_better(&split_lines(simd, texels, &split, &scales, &MODE_2, ROUNDS), is_coarse);
        }
    }
    winner.try_grey(simd, texels, scale, 2);
    winner
}

/// Fits lines to opaque `texels`, whose levels are multiplied by `scale`, in blocks where a line is likely to be best.
/// Returns these lines, a mask of the blocks in which two planes may be better, and a mask of grey blocks.
#[inline(always)]
pub(crate) fn fast_lines<S: Simd>(
    simd: S,
    texels: &[Grid<S>; 3],
    scale: &[f32; 3],
) -> (Blocks<S>, [<Wide<S> as Real>::Mask; 2]) {
    /// Estimates are right within this factor for 90 % of blocks.
    const UNCERTAINTY: f32 = 2.0;

    let all = moments(simd, texels, None);
    let axis = principal_axis(simd, &all.scatter);
    let along = scatter_along(simd, &all.scatter, &axis);
    let off = trace(&all.scatter) - along;
    let line_estimate = off * 1.05 + along * 0.003 + 3.0;
    let (_, planes_estimate) = likely_planes(simd, &all);
    let mut winner = Blocks::none(simd);
    let is_line_likely = line_estimate.simd_lt(planes_estimate * UNCERTAINTY);
    winner.try_line(simd, texels, &all, &axis, &splat(simd, scale), FAST_ROUNDS, is_line_likely);
    (winner, [planes_estimate.simd_lt(line_estimate * UNCERTAINTY), is_grey(texels, scale)])
}

/// Fits lines to opaque texels in which only green varies, like [`fast_lines`] with a third of the numbers. The
/// roughness texture of a material with constant metalness and no occlusion has only such blocks.
#[inline(always)]
pub(crate) fn fast_green<S: Simd>(simd: S, [reds, green, blues]: &[Grid<S>; 3], scale: &[f32; 3]) -> Blocks<S> {
    let green = [*green];
    let all = moments(simd, &green, None);
    let mut winner = Blocks::none(simd);
    let scales = splat(simd, &[scale[1]]);
    winner.try_line(simd, &green, &all, &[Wide::splat(simd, 1.0)], &scales, FAST_ROUNDS, all_lanes(simd));
    let [green, ..] = winner.endpoints[0];
    let [red, blue] =
        [winner.nearest(simd, reds[0] * (1.0 / scale[0])), winner.nearest(simd, blues[0] * (1.0 / scale[2]))];
    for (c, level, texels) in [(0, red, reds), (2, blue, blues)] {
        let difference = level * scale[c] - texels[0];
        winner.error += difference * difference * 16.0;
    }
    winner.endpoints[0][..3].copy_from_slice(&[[red; 2], green, [blue; 2]]);
    winner
}

/// Returns the channel that gains most from a plane of its own, and the squared error expected with two planes.
#[inline(always)]
fn likely_planes<S: Simd>(simd: S, all: &Moments<S, 3>) -> (Wide<S>, Wide<S>) {
    let mut least = (Wide::splat(simd, 0.0), Wide::splat(simd, f32::INFINITY));
    for selector in 0..3 {
        let [p, q] = [[1, 2], [0, 2], [0, 1]][selector];
        let (a, b, c) = (all.scatter[p][p], all.scatter[p][q], all.scatter[q][q]);
        let radius = Real::sqrt((a - c) * 0.25 * (a - c) + b * b);
        let middle = (a + c) * 0.5;
        // 2-bit weights leave about a twelfth of the scatter along their line.
        let error = (middle - radius) + (middle + radius + all.scatter[selector][selector]) / 12.0;
        let is_less = error.simd_lt(least.1);
        least.0 = is_less.select(Wide::splat(simd, selector as f32), least.0);
        least.1 = is_less.select(error, least.1);
    }
    (least.0, least.1 * 0.85 + 4.0)
}
