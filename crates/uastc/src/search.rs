//! Choice of the mode of blocks of colours.
//!
//! Both efforts fit candidates and keep the one with the least squared error. `best_rgb` fits all
//! that pay; the `fast` ones first estimate errors from the moments of the colours and fit only what
//! can win: on 83,000 blocks of eighteen real maps the gates below cost 0.03 dB.

use fearless_simd::{Select, Simd, SimdBase, prelude::*};

use crate::blocks::Blocks;
use crate::candidate::{Split, one_line, split_lines, two_planes};
use crate::lanes::{Grid, every, sum};
use crate::line::Points;
use crate::moments::{Moments, moments, principal_axis, scatter_along, trace};
use crate::partition::likely_patterns;
use crate::tables::{MODE_0, MODE_1, MODE_2, MODE_4, MODE_5, MODE_6, MODE_15, MODE_18, Mode};
use texel_simd::{Real, Wide};

/// Rounds of regression of thorough searches. A third round gains 0.04 dB.
const ROUNDS: usize = 2;

/// Rounds of regression of quick searches. A second round gains 0.1 dB on real maps and takes a quarter of the time
/// more.
const QUICK_ROUNDS: usize = 1;

/// The error of a block below which a second subset hardly ever wins. (One step of each channel of each texel is 48.)
pub(crate) const GOOD: f32 = 100.0;

impl<S: Simd> Blocks<S> {
    /// Offers lines of one number for blocks whose texels are all grey, with `passes` over single endpoints.
    #[inline(always)]
    pub fn offer_grey(&mut self, simd: S, texels: &[Grid<S>; 3], scale: &[f32; 3], passes: usize) {
        let is_grey = is_grey(texels, scale);
        if is_grey.any_true() {
            let weight = scale[0] * scale[0] + scale[1] * scale[1] + scale[2] * scale[2];
            let mut green = texels[1];
            for level in &mut green {
                // Exact: scales are powers of two.
                *level *= 1.0 / scale[1];
            }
            self.offer(&grey::<_, 4>(simd, &[green], weight, &MODE_15, passes), is_grey);
            self.offer(&grey::<_, 5>(simd, &[green], weight, &MODE_18, passes), is_grey);
        }
    }

    /// Offers two planes, one of them for the channel that gains most from it.
    #[inline(always)]
    pub fn offer_planes(&mut self, simd: S, texels: &[Grid<S>; 3], scale: &[f32; 3]) {
        let all = moments(simd, texels, None);
        let (selector, _) = likely_planes(simd, &all);
        self.offer(&two_planes::<_, 3, 2>(simd, texels, &all, selector, scale, &MODE_6, QUICK_ROUNDS), every(simd));
    }

    /// Offers two subsets in the likeliest pattern.
    #[inline(always)]
    pub fn offer_subsets<const N: usize>(&mut self, simd: S, texels: &[Grid<S>; N], scale: &[f32; N]) {
        let all = moments(simd, texels, None);
        let axis = principal_axis(simd, &all.scatter);
        let [pattern] = likely_patterns(simd, texels, &all, &axis);
        let split = Split::in_two(simd, texels, pattern);
        let (off, along) = split.scatter(simd);
        let is_likely = (off + along / 12.0).simd_lt(self.error * 1.4);
        if is_likely.any_true() {
            // The finer weights of mode 2 would gain 0.5 % of the angle of normals and take 12 % of the time more.
            self.offer(&split_lines::<_, N, 2, 2>(simd, texels, &split, scale, &MODE_4, QUICK_ROUNDS), is_likely);
        }
    }

    /// Offers a line in the mode that suits its length.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "those of `one_line`")]
    pub fn offer_line<const N: usize>(
        &mut self,
        simd: S,
        texels: &[Grid<S>; N],
        all: &Moments<S, N>,
        axis: &[Wide<S>; N],
        scale: &[f32; N],
        rounds: usize,
        allowed: <Wide<S> as Real>::Mask,
    ) {
        let along = scatter_along(simd, &all.scatter, axis);
        let off = trace(&all.scatter) - along;
        let is_short = along.simd_lt(300.0);
        let is_long = along.simd_gt(25000.0) & off.simd_lt(along * 0.02);
        let [short, long, middle] = [allowed & is_short, allowed & is_long, allowed & !is_short & !is_long];
        if short.any_true() {
            // Short lines gain more from exact endpoints than from sixteen weights,
            self.offer(&one_line::<_, N, 3>(simd, texels, all, axis, scale, &MODE_5, rounds), short);
        }
        if long.any_true() {
            // and long ones more from 32 weights.
            self.offer(&one_line::<_, N, 5>(simd, texels, all, axis, scale, &MODE_18, rounds), long);
        }
        if middle.any_true() {
            self.offer(&one_line::<_, N, 4>(simd, texels, all, axis, scale, &MODE_0, rounds), middle);
        }
    }
}

/// Returns which blocks have equal red, green and blue in all texels.
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

/// Blocks of grey `texels`, whose squared differences count `weight` times.
#[inline(always)]
fn grey<S: Simd, const BITS: u32>(
    simd: S,
    texels: &[Grid<S>; 1],
    weight: f32,
    mode: &'static Mode,
    passes: usize,
) -> Blocks<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let one = [Wide::splat(simd, 1.0)];
            let points = Points { texels, subset: None, scale: one, range: mode.range };
            let mut line = points.fit::<BITS>(simd, &moments(simd, texels, None), &one, ROUNDS);
            let (mut low, mut high) = (texels[0][0], texels[0][0]);
            for level in texels[0] {
                low = Real::min(low, level);
                high = Real::max(high, level);
            }
            // Between exact endpoints that are as far apart as there are weights, each weight gives the next level.
            // Decoding rounds down, by less the brighter a level is.
            let last = ((1 << BITS) - 1) as f32;
            let apart = low.simd_lt(51.0).select(Wide::splat(simd, last + 1.0), Wide::splat(simd, last));
            low = Real::min(low, Wide::splat(simd, 255.0 - last));
            high = Real::max(high, low + apart);
            let (spanning, _) = points.settle::<BITS>(simd, &[low], &[high]);
            line.take(&spanning, spanning.error.simd_lt(line.error));
            line = points.polish::<BITS>(simd, line, passes);
            let mut blocks = Blocks::empty(simd, mode);
            blocks.place(&line, 0, None);
            let [grey, ..] = blocks.endpoints[0];
            let alpha = [Wide::splat(simd, 255.0); 2];
            blocks.endpoints[0] = if mode.has_alpha() { [grey, alpha, grey, grey] } else { [grey; 4] };
            blocks.error *= weight;
            blocks
        },
    )
}

/// The best blocks found for opaque `texels`, whose channels have `scale` per level.
#[inline(always)]
pub(crate) fn best_rgb<S: Simd>(simd: S, texels: &[Grid<S>; 3], scale: &[f32; 3]) -> Blocks<S> {
    let all = moments(simd, texels, None);
    let axis = principal_axis(simd, &all.scatter);
    let mut winner = one_line::<_, 3, 4>(simd, texels, &all, &axis, scale, &MODE_0, ROUNDS);
    let every = every(simd);
    // Many weights serve long lines, exact endpoints short ones.
    let along = scatter_along(simd, &all.scatter, &axis);
    let is_long = along.simd_gt(400.0);
    if is_long.any_true() {
        winner.offer(&one_line::<_, 3, 5>(simd, texels, &all, &axis, scale, &MODE_18, ROUNDS), is_long);
    }
    let is_short = along.simd_lt(3000.0);
    if is_short.any_true() {
        winner.offer(&one_line::<_, 3, 3>(simd, texels, &all, &axis, scale, &MODE_5, ROUNDS), is_short);
    }
    let is_shortest = along.simd_lt(200.0);
    if is_shortest.any_true() {
        winner.offer(&one_line::<_, 3, 2>(simd, texels, &all, &axis, scale, &MODE_1, ROUNDS), is_shortest);
    }
    for selector in [0.0, 1.0, 2.0] {
        let selector = Wide::splat(simd, selector);
        winner.offer(&two_planes::<_, 3, 2>(simd, texels, &all, selector, scale, &MODE_6, ROUNDS), every);
    }
    for pattern in likely_patterns::<_, 3, 2>(simd, texels, &all, &axis) {
        let split = Split::in_two(simd, texels, pattern);
        let is_likely = split.scatter(simd).0.simd_le(winner.error);
        if !is_likely.any_true() {
            continue;
        }
        winner.offer(&split_lines::<_, 3, 2, 2>(simd, texels, &split, scale, &MODE_4, ROUNDS), is_likely);
        // Sixteen levels an endpoint are too coarse for less.
        let is_coarse = is_likely & winner.error.simd_gt(150.0);
        if is_coarse.any_true() {
            winner.offer(&split_lines::<_, 3, 2, 3>(simd, texels, &split, scale, &MODE_2, ROUNDS), is_coarse);
        }
    }
    winner.offer_grey(simd, texels, scale, 2);
    winner
}

/// Lines through opaque `texels`, whose channels have `scale` per level, where they are likely to be the best; and
/// where two planes may be better, and where all texels are grey.
#[inline(always)]
pub(crate) fn fast_lines<S: Simd>(
    simd: S,
    texels: &[Grid<S>; 3],
    scale: &[f32; 3],
) -> (Blocks<S>, [<Wide<S> as Real>::Mask; 2]) {
    /// Estimates are right within a factor of 2 for 90 % of blocks.
    const DOUBT: f32 = 2.0;

    let all = moments(simd, texels, None);
    let axis = principal_axis(simd, &all.scatter);
    let along = scatter_along(simd, &all.scatter, &axis);
    let off = trace(&all.scatter) - along;
    let line_estimate = off * 1.05 + along * 0.003 + 3.0;
    let (_, planes_estimate) = likely_planes(simd, &all);
    let mut winner = Blocks::none(simd);
    let is_line_likely = line_estimate.simd_lt(planes_estimate * DOUBT);
    winner.offer_line(simd, texels, &all, &axis, scale, QUICK_ROUNDS, is_line_likely);
    (winner, [planes_estimate.simd_lt(line_estimate * DOUBT), is_grey(texels, scale)])
}

/// Lines through opaque texels of which only the green varies: those of [`fast_lines`], of a third of the numbers. A
/// roughness texture of a material with one metalness and no occlusion is made of them.
#[inline(always)]
pub(crate) fn fast_green<S: Simd>(simd: S, [reds, green, blues]: &[Grid<S>; 3], scale: &[f32; 3]) -> Blocks<S> {
    let green = [*green];
    let all = moments(simd, &green, None);
    let mut winner = Blocks::none(simd);
    winner.offer_line(simd, &green, &all, &[Wide::splat(simd, 1.0)], &[scale[1]], QUICK_ROUNDS, every(simd));
    let [green, ..] = winner.endpoints[0];
    let [red, blue] =
        [winner.nearest(simd, reds[0] * (1.0 / scale[0])), winner.nearest(simd, blues[0] * (1.0 / scale[2]))];
    for (c, level, texels) in [(0, red, reds), (2, blue, blues)] {
        let off = level * scale[c] - texels[0];
        winner.error += off * off * 16.0;
    }
    winner.endpoints[0][..3].copy_from_slice(&[[red; 2], green, [blue; 2]]);
    winner
}

/// The channel that is best given a plane of its own, and the squared error to expect then.
#[inline(always)]
fn likely_planes<S: Simd>(simd: S, all: &Moments<S, 3>) -> (Wide<S>, Wide<S>) {
    let mut least = (Wide::splat(simd, 0.0), Wide::splat(simd, f32::INFINITY));
    for alone in 0..3 {
        let [p, q] = [[1, 2], [0, 2], [0, 1]][alone];
        let (a, b, c) = (all.scatter[p][p], all.scatter[p][q], all.scatter[q][q]);
        let radius = Real::sqrt((a - c) * 0.25 * (a - c) + b * b);
        let middle = (a + c) * 0.5;
        // 2-bit weights leave about a twelfth of the scatter along their line.
        let error = (middle - radius) + (middle + radius + all.scatter[alone][alone]) / 12.0;
        let is_less = error.simd_lt(least.1);
        least.0 = is_less.select(Wide::splat(simd, alone as f32), least.0);
        least.1 = is_less.select(error, least.1);
    }
    (least.0, least.1 * 0.85 + 4.0)
}
