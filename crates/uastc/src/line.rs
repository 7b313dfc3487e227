//! Fits a colour line: a pair of endpoints and a weight for each texel, of one subset and one plane.
//!
//! Two steps alternate: linear regression on the weights gives endpoints, and projection on the line between the
//! endpoints gives weights. All arithmetic is +, -, * and / of `f32` in a fixed order, which gives the same bits on
//! every machine.

#![expect(clippy::needless_range_loop, reason = "loops over texels read several grids at one index")]

use fearless_simd::{Select, Simd, SimdBase, prelude::*};

use crate::lanes::{Grid, look_up, round, set_where, sum};
use crate::moments::{Moments, masked};
use crate::ramp::Ramp;
use crate::tables::Range;
use texel_simd::{Real, Wide};

/// A fitted line over `N` channels.
#[derive(Clone, Copy)]
pub(crate) struct Line<S: Simd, const N: usize> {
    /// Endpoint levels, 0..=255, as the quantised endpoints decode.
    pub low: [Wide<S>; N],
    pub high: [Wide<S>; N],
    /// Weight indices; meaningless outside of the subset.
    pub weights: Grid<S>,
    /// Sum of squared differences between decoded and source levels over the subset.
    pub error: Wide<S>,
}

/// The points that a line is fitted to.
pub(crate) struct Points<'a, S: Simd, const N: usize> {
    /// Levels of the channels, multiplied by `scale`.
    pub texels: &'a [Grid<S>; N],
    /// 1 for the texels of the subset, 0 for other texels; `None` if the subset has all texels.
    pub subset: Option<&'a Grid<S>>,
    /// The factor of each channel in the metric.
    pub scale: [Wide<S>; N],
    /// The levels that endpoints may have.
    pub range: &'static Range,
    /// The weights that indices stand for.
    pub ramp: &'static Ramp,
}

/// Returns a decoded level: ASTC's interpolation of 8-bit endpoints at a weight of 0..=64, which is
/// floor((257 (64 low + (high - low) weight) + 32) / 2^14), in exact `f32` steps. `step` is high - low.
#[inline(always)]
pub(crate) fn decode<F: Real>(low: F, step: F, weight: F) -> F {
    let splat = |value| low.splat_like(value);
    // The value is a multiple of 2^-14 below 2^8. The shift by 1/2 - 2^-15 turns `round` into floor without ties.
    let start = low * splat(257.0 / 256.0) + splat(32.0 / 16384.0 - (0.5 - 1.0 / 32768.0));
    round(start + step * splat(257.0 / 16384.0) * weight)
}

/// Returns the level of `range` nearest to a value, which may lie outside of 0..=255.
#[inline(always)]
pub(crate) fn quantise<S: Simd>(simd: S, range: &Range, value: Wide<S>) -> Wide<S> {
    let (zero, most) = (Wide::splat(simd, 0.0), Wide::splat(simd, 255.0));
    look_up(simd, &range.level, Real::min(Real::max(value, zero), most))
}

impl<S: Simd, const N: usize> Points<'_, S, N> {
    /// Fits a line by one or more `rounds` of regression, starting along `axis`. Returns the line
    /// of the best round.
    #[inline(always)]
    pub fn fit(&self, simd: S, m: &Moments<S, N>, axis: &[Wide<S>; N], rounds: usize) -> Line<S, N> {
        simd.vectorize(
            #[inline(always)]
            || {
                let weights = self.initial_weights(simd, m, axis);
                let (low, high) = self.regress(simd, m, &weights);
                let (mut best, mut weights) = self.quantised_line(simd, &low, &high);
                for _ in 1..rounds {
                    let (low, high) = self.regress(simd, m, &weights);
                    let (line, next) = self.quantised_line(simd, &low, &high);
                    let is_better = line.error.simd_lt(best.error);
                    if !is_better.any_true() {
                        break;
                    }
                    for i in 0..16 {
                        set_where(&mut weights[i], next[i], is_better);
                    }
                    best.set_where(&line, is_better);
                }
                best
            },
        )
    }

    /// Returns initial weights: the positions of the texels on `axis`, relative to the least and the largest position.
    #[inline(always)]
    fn initial_weights(&self, simd: S, m: &Moments<S, N>, axis: &[Wide<S>; N]) -> Grid<S> {
        let zero = Wide::splat(simd, 0.0);
        let mut centre = zero;
        for c in 0..N {
            centre += axis[c] * m.sums[c];
        }
        centre /= m.count;
        let (mut least, mut most) = (zero, zero);
        let mut weights = [zero; 16];
        for i in 0..16 {
            let mut t = zero - centre;
            for c in 0..N {
                t += axis[c] * self.texels[c][i];
            }
            weights[i] = masked(self.subset, i, t);
            least = Real::min(least, weights[i]);
            most = Real::max(most, weights[i]);
        }
        let last = self.ramp.last;
        let scale = most.simd_gt(least).select(last / (most - least), zero);
        for weight in &mut weights {
            *weight = self.ramp.weight(round((*weight - least) * scale));
        }
        weights
    }

    /// Returns the endpoints that fit fixed weights (0..=64) best, by linear regression. If all weights are equal, both
    /// endpoints are the mean.
    #[inline(always)]
    fn regress(&self, simd: S, m: &Moments<S, N>, weights: &Grid<S>) -> ([Wide<S>; N], [Wide<S>; N]) {
        let (zero, one) = (Wide::splat(simd, 0.0), Wide::splat(simd, 1.0));
        let w = sum(
            #[inline(always)]
            |i| masked(self.subset, i, weights[i]),
        );
        let ww = sum(
            #[inline(always)]
            |i| masked(self.subset, i, weights[i]) * weights[i],
        );
        let determinant = m.count * ww - w * w;
        let scale = determinant.simd_gt(0.0).select(one / determinant, zero);
        let share = one / m.count;
        let (mut low, mut high) = ([zero; N], [zero; N]);
        for c in 0..N {
            let wx = sum(
                #[inline(always)]
                |i| masked(self.subset, i, weights[i]) * self.texels[c][i],
            );
            let slope = (m.count * wx - w * m.sums[c]) * scale;
            low[c] = (m.sums[c] - slope * w) * share;
            high[c] = low[c] + slope * 64.0;
        }
        (low, high)
    }

    /// Quantises endpoints, chooses the best weights and measures the error. Returns the line and its weights as
    /// 0..=64.
    #[inline(always)]
    pub fn quantised_line(&self, simd: S, low: &[Wide<S>; N], high: &[Wide<S>; N]) -> (Line<S, N>, Grid<S>) {
        let (mut low, mut high) = (*low, *high);
        for c in 0..N {
            low[c] = quantise(simd, self.range, low[c] / self.scale[c]);
            high[c] = quantise(simd, self.range, high[c] / self.scale[c]);
        }
        self.line_between(simd, low, high)
    }

    /// Returns the line between quantised endpoints with the best weights, and these weights as 0..=64.
    #[inline(always)]
    pub fn line_between(&self, simd: S, low: [Wide<S>; N], high: [Wide<S>; N]) -> (Line<S, N>, Grid<S>) {
        let zero = Wide::splat(simd, 0.0);
        let (mut step, mut length, mut start) = ([zero; N], zero, zero);
        for c in 0..N {
            let [from, to] = [low[c] * self.scale[c], high[c] * self.scale[c]];
            step[c] = to - from;
            length += step[c] * step[c];
            start += step[c] * from;
        }
        let last = Wide::splat(simd, self.ramp.last);
        let scale = length.simd_gt(0.0).select(last / length, zero);
        let (mut indices, mut weights, mut errors) = ([zero; 16], [zero; 16], [zero; 16]);
        for i in 0..16 {
            let mut t = zero - start;
            for c in 0..N {
                t += step[c] * self.texels[c][i];
            }
            indices[i] = round(Real::min(Real::max(t * scale, zero), last));
            weights[i] = self.ramp.weight(indices[i]);
            for c in 0..N {
                let d = self.scale[c] * decode(low[c], high[c] - low[c], weights[i]) - self.texels[c][i];
                errors[i] += d * d;
            }
        }
        let error = sum(
            #[inline(always)]
            |i| masked(self.subset, i, errors[i]),
        );
        (Line { low, high, weights: indices, error }, weights)
    }
}

impl<S: Simd, const N: usize> Line<S, N> {
    /// Replaces the line by `other` where `mask` is set.
    #[inline(always)]
    pub fn set_where(&mut self, other: &Self, mask: <Wide<S> as Real>::Mask) {
        for c in 0..N {
            set_where(&mut self.low[c], other.low[c], mask);
            set_where(&mut self.high[c], other.high[c], mask);
        }
        for i in 0..16 {
            set_where(&mut self.weights[i], other.weights[i], mask);
        }
        set_where(&mut self.error, other.error, mask);
    }
}
