//! One colour line: a pair of endpoints and a weight per texel, for one subset and one plane.
//!
//! Endpoints follow from linear regression on the weights, weights from projection on the endpoints, in turns. Only
//! +, -, *, / of `f32` in a written order: the same bits on every machine.

#![expect(clippy::needless_range_loop, reason = "loops over texels read several grids at one index")]

use fearless_simd::{Select, Simd, SimdBase, prelude::*};

use crate::lanes::{Grid, ROUND, look_up, sum, take};
use crate::moments::{Moments, counted};
use crate::tables::Range;
use texel_simd::{Real, Wide};

/// A fitted line over `N` channels.
#[derive(Clone, Copy)]
pub(crate) struct Line<S: Simd, const N: usize> {
    /// Endpoint levels, 0..=255, as the quantised endpoints decode.
    pub low: [Wide<S>; N],
    pub high: [Wide<S>; N],
    /// Weight indices; those outside of the subset mean nothing.
    pub weights: Grid<S>,
    /// Sum of squared differences between decoded and source levels over the subset.
    pub error: Wide<S>,
}

/// What a line is fitted to.
pub(crate) struct Points<'a, S: Simd, const N: usize> {
    /// Levels of the channels, times `scale`.
    pub texels: &'a [Grid<S>; N],
    /// 1 for the texels that count, 0 for the rest; none if all do.
    pub subset: Option<&'a Grid<S>>,
    /// What a level counts for, by channel.
    pub scale: [Wide<S>; N],
    /// The levels that endpoints may have.
    pub range: &'static Range,
}

/// The nearest whole number, which is less than 2^22.
#[inline(always)]
pub(crate) fn round<F: Real>(v: F) -> F {
    v + v.splat_like(ROUND) - v.splat_like(ROUND)
}

/// The weight ramp of the format: index to 0..=64, for 1 to 5 bits.
#[inline(always)]
pub(crate) fn ramp<const BITS: u32, F: Real>(index: F) -> F {
    let splat = |value| index.splat_like(value);
    // Halves and quarters without their fractions: nothing lies half way after the shift.
    match BITS {
        1 => index * splat(64.0),
        2 => index * splat(21.0) + round(index * splat(0.5) - splat(0.25)),
        3 => index * splat(9.0) + round(index * splat(0.25) - splat(0.375)),
        4 => {
            let (quarter, eighth) = (index * splat(0.25), index * splat(0.125));
            index * splat(4.0) + round(quarter - splat(0.375)) + round(eighth - splat(0.4375))
        }
        _ => index * splat(2.0) + round(index * splat(0.0625) - splat(0.46875)) * splat(2.0),
    }
}

/// A decoded level: `astc` interpolation of 8-bit endpoints at a weight of 0..=64, that is
/// floor((257 (64 low + (high - low) weight) + 32) / 2^14), in exact `f32` steps.
#[inline(always)]
pub(crate) fn decode<F: Real>(low: F, step: F, weight: F) -> F {
    let splat = |value| low.splat_like(value);
    // A multiple of 2^-14 below 2^8, shifted by 1/2 - 2^-15: rounding is then a floor without ties.
    let start = low * splat(257.0 / 256.0) + splat(32.0 / 16384.0 - (0.5 - 1.0 / 32768.0));
    round(start + step * splat(257.0 / 16384.0) * weight)
}

/// Nearest level of `range` to a value, which may lie outside of 0..=255.
#[inline(always)]
pub(crate) fn quantise<S: Simd>(simd: S, range: &Range, value: Wide<S>) -> Wide<S> {
    let (zero, most) = (Wide::splat(simd, 0.0), Wide::splat(simd, 255.0));
    look_up(simd, &range.level, Real::min(Real::max(value, zero), most))
}

impl<S: Simd, const N: usize> Points<'_, S, N> {
    /// Fits a line of `BITS`-bit weights, starting along `axis`, with one or more `rounds` of regression; the best
    /// round wins.
    #[inline(always)]
    pub fn fit<const BITS: u32>(&self, simd: S, m: &Moments<S, N>, axis: &[Wide<S>; N], rounds: usize) -> Line<S, N> {
        let weights = self.spread::<BITS>(simd, m, axis);
        let (low, high) = self.regress(simd, m, &weights);
        let (mut best, mut weights) = self.settle::<BITS>(simd, &low, &high);
        for _ in 1..rounds {
            let (low, high) = self.regress(simd, m, &weights);
            let (line, next) = self.settle::<BITS>(simd, &low, &high);
            let is_better = line.error.simd_lt(best.error);
            if !is_better.any_true() {
                break;
            }
            for i in 0..16 {
                take(&mut weights[i], next[i], is_better);
            }
            best.take(&line, is_better);
        }
        best
    }

    /// First weights: the texels' places between the ends of their projection on `axis`.
    #[inline(always)]
    fn spread<const BITS: u32>(&self, simd: S, m: &Moments<S, N>, axis: &[Wide<S>; N]) -> Grid<S> {
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
            weights[i] = counted(self.subset, i, t);
            least = Real::min(least, weights[i]);
            most = Real::max(most, weights[i]);
        }
        let last = ((1 << BITS) - 1) as f32;
        let scale = most.simd_gt(least).select(last / (most - least), zero);
        for weight in &mut weights {
            *weight = ramp::<BITS, _>(round((*weight - least) * scale));
        }
        weights
    }

    /// Endpoints that best explain the texels under fixed weights (0..=64), by linear regression;
    /// the mean twice where all weights are equal.
    #[inline(always)]
    fn regress(&self, simd: S, m: &Moments<S, N>, weights: &Grid<S>) -> ([Wide<S>; N], [Wide<S>; N]) {
        let (zero, one) = (Wide::splat(simd, 0.0), Wide::splat(simd, 1.0));
        let w = sum(
            #[inline(always)]
            |i| counted(self.subset, i, weights[i]),
        );
        let ww = sum(
            #[inline(always)]
            |i| counted(self.subset, i, weights[i]) * weights[i],
        );
        let determinant = m.count * ww - w * w;
        let scale = determinant.simd_gt(0.0).select(one / determinant, zero);
        let share = one / m.count;
        let (mut low, mut high) = ([zero; N], [zero; N]);
        for c in 0..N {
            let wx = sum(
                #[inline(always)]
                |i| counted(self.subset, i, weights[i]) * self.texels[c][i],
            );
            let slope = (m.count * wx - w * m.sums[c]) * scale;
            low[c] = (m.sums[c] - slope * w) * share;
            high[c] = low[c] + slope * 64.0;
        }
        (low, high)
    }

    /// Quantises endpoints, chooses the weights anew and measures the error; the line and its weights
    /// as 0..=64.
    #[inline(always)]
    pub fn settle<const BITS: u32>(&self, simd: S, low: &[Wide<S>; N], high: &[Wide<S>; N]) -> (Line<S, N>, Grid<S>) {
        let (mut low, mut high) = (*low, *high);
        for c in 0..N {
            low[c] = quantise(simd, self.range, low[c] / self.scale[c]);
            high[c] = quantise(simd, self.range, high[c] / self.scale[c]);
        }
        self.chosen::<BITS>(simd, low, high)
    }

    /// The line between quantised endpoints, with the best weights for them, and these as 0..=64.
    #[inline(always)]
    pub fn chosen<const BITS: u32>(&self, simd: S, low: [Wide<S>; N], high: [Wide<S>; N]) -> (Line<S, N>, Grid<S>) {
        let zero = Wide::splat(simd, 0.0);
        let (mut step, mut length, mut start) = ([zero; N], zero, zero);
        for c in 0..N {
            let [from, to] = [low[c] * self.scale[c], high[c] * self.scale[c]];
            step[c] = to - from;
            length += step[c] * step[c];
            start += step[c] * from;
        }
        let last = Wide::splat(simd, ((1 << BITS) - 1) as f32);
        let scale = length.simd_gt(0.0).select(last / length, zero);
        let (mut indices, mut weights, mut errors) = ([zero; 16], [zero; 16], [zero; 16]);
        for i in 0..16 {
            let mut t = zero - start;
            for c in 0..N {
                t += step[c] * self.texels[c][i];
            }
            indices[i] = round(Real::min(Real::max(t * scale, zero), last));
            weights[i] = ramp::<BITS, _>(indices[i]);
            for c in 0..N {
                let d = self.scale[c] * decode(low[c], high[c] - low[c], weights[i]) - self.texels[c][i];
                errors[i] += d * d;
            }
        }
        let error = sum(
            #[inline(always)]
            |i| counted(self.subset, i, errors[i]),
        );
        (Line { low, high, weights: indices, error }, weights)
    }
}

impl<S: Simd, const N: usize> Line<S, N> {
    /// Becomes `other` where `mask` holds.
    #[inline(always)]
    pub fn take(&mut self, other: &Self, mask: <Wide<S> as Real>::Mask) {
        for c in 0..N {
            take(&mut self.low[c], other.low[c], mask);
            take(&mut self.high[c], other.high[c], mask);
        }
        for i in 0..16 {
            take(&mut self.weights[i], other.weights[i], mask);
        }
        take(&mut self.error, other.error, mask);
    }
}
