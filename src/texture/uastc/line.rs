//! One colour line: a pair of endpoints and a weight per texel, for one subset and one plane.
//!
//! Kernels only: fixed-size arrays in and out. Endpoints follow from linear regression on the
//! weights, weights from projection on the endpoints, in turns. Only +, -, *, / of `f32` in a
//! written order: the same bits on every machine.

#![expect(clippy::needless_range_loop, reason = "lane loops read several arrays at one index")]

use super::moments::{Lane, Moments, sum};
use super::tables::Range;
use crate::simd::Real;

/// 1.5 * 2^23: adding and subtracting it rounds a number of less than 2^22 to the nearest integer,
/// and the low bits of the sum are that integer. (`round` takes a call on baseline x86-64.)
pub(super) const ROUND: f32 = 12_582_912.0;

/// A fitted line over `N` channels.
#[derive(Clone, Copy)]
pub(super) struct Line<const N: usize> {
    /// Endpoint levels, 0..=255, as the quantised endpoints decode.
    pub low: [u8; N],
    pub high: [u8; N],
    /// Weights; those outside of the subset mean nothing.
    pub weights: [u8; 16],
    /// Sum of squared differences between decoded and source levels over the subset.
    pub error: f32,
}

#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The weight ramp of the format: index to 0..=64, for 2 to 5 bits.
#[inline(always)]
pub(super) fn ramp<const BITS: u32>(index: i32) -> i32 {
    match BITS {
        2 => 21 * index + (index >> 1),
        3 => 9 * index + (index >> 2),
        4 => 4 * index + (index >> 2) + (index >> 3),
        _ => 2 * index + 2 * (index >> 4),
    }
}

/// A decoded level: `astc` interpolation of 8-bit endpoints at a weight of 0..=64, that is
/// floor((257 (64 low + (high - low) weight) + 32) / 2^14), in exact `f32` steps.
#[inline(always)]
pub(super) fn decode<F: Real>(low: F, step: F, weight: F) -> F {
    let like = |value| low.like(value);
    let v = ((low * like(64.0) + step * weight) * like(257.0) + like(32.0)) * like(1.0 / 16384.0);
    // v is a multiple of 2^-14: shifting by 1/2 - 2^-15 makes rounding a floor without ties.
    (v - like(0.5 - 1.0 / 32768.0) + like(ROUND)) - like(ROUND)
}

/// Nearest weight indices of `texels` on the line from `low` to `high`.
#[inline(always)]
fn project<const N: usize, const BITS: u32>(texels: &[Lane; N], low: &[f32; N], high: &[f32; N]) -> [i32; 16] {
    let last = ((1 << BITS) - 1) as f32;
    let mut step = [0.0; N];
    let mut length = 0.0;
    let mut start = 0.0;
    for c in 0..N {
        step[c] = high[c] - low[c];
        length += step[c] * step[c];
        start += step[c] * low[c];
    }
    let scale = if length > 0.0 { last / length } else { 0.0 };
    let mut indices = [0; 16];
    for (i, index) in indices.iter_mut().enumerate() {
        let mut t = -start;
        for c in 0..N {
            t += step[c] * texels[c][i];
        }
        let t = min(max(t * scale, 0.0), last);
        *index = ((t + ROUND).to_bits() & 31) as i32;
    }
    indices
}

/// Endpoints that best explain `texels` under fixed weights (0..=64), by linear regression;
/// the mean twice where all weights are equal.
#[inline(always)]
fn regress<const N: usize>(texels: &[Lane; N], subset: &Lane, m: &Moments<N>, weights: &Lane) -> ([f32; N], [f32; N]) {
    let w = sum(|i| subset[i] * weights[i]);
    let ww = sum(|i| subset[i] * weights[i] * weights[i]);
    let determinant = m.count * ww - w * w;
    let scale = if determinant > 0.0 { 1.0 / determinant } else { 0.0 };
    let share = 1.0 / m.count;
    let (mut low, mut high) = ([0.0; N], [0.0; N]);
    for c in 0..N {
        let wx = sum(|i| subset[i] * weights[i] * texels[c][i]);
        let slope = (m.count * wx - w * m.sums[c]) * scale;
        low[c] = (m.sums[c] - slope * w) * share;
        high[c] = low[c] + 64.0 * slope;
    }
    (low, high)
}

/// Nearest level of `range` to a value, which may lie outside of 0..=255.
#[inline(always)]
pub(super) fn quantise(range: &Range, value: f32) -> u8 {
    let v = min(max(value, 0.0), 255.0);
    range.level[((v + ROUND).to_bits() & 255) as usize]
}

/// Fits a line of `BITS`-bit weights through the members of `subset`, starting along `axis`, with
/// one or more `rounds` of regression; the best round wins. A channel of `texels` has `scale` per level.
#[inline(always)]
pub(super) fn fit<const N: usize, const BITS: u32>(
    texels: &[Lane; N],
    subset: &Lane,
    m: &Moments<N>,
    axis: &[f32; N],
    scale: &[f32; N],
    range: &Range,
    rounds: usize,
) -> Line<N> {
    let weights = spread::<N, BITS>(texels, subset, m, axis);
    let (low, high) = regress(texels, subset, m, &weights);
    let (mut best, mut weights) = settle::<N, BITS>(texels, subset, &low, &high, scale, range);
    for _ in 1..rounds {
        let (low, high) = regress(texels, subset, m, &weights);
        let (line, next) = settle::<N, BITS>(texels, subset, &low, &high, scale, range);
        if line.error >= best.error {
            break;
        }
        (best, weights) = (line, next);
    }
    best
}

/// First weights: the texels' places between the ends of their projection on `axis`.
#[inline(always)]
fn spread<const N: usize, const BITS: u32>(texels: &[Lane; N], subset: &Lane, m: &Moments<N>, axis: &[f32; N]) -> Lane {
    let mut centre = 0.0;
    for c in 0..N {
        centre += axis[c] * m.sums[c];
    }
    centre /= m.count;
    let mut along = [0.0; 16];
    for i in 0..16 {
        let mut t = -centre;
        for c in 0..N {
            t += axis[c] * texels[c][i];
        }
        along[i] = t * subset[i];
    }
    let (mut least, mut most) = ([0.0; 4], [0.0; 4]);
    for k in 0..4 {
        for j in 0..4 {
            least[j] = min(least[j], along[4 * k + j]);
            most[j] = max(most[j], along[4 * k + j]);
        }
    }
    let least = min(min(least[0], least[1]), min(least[2], least[3]));
    let most = max(max(most[0], most[1]), max(most[2], most[3]));
    let last = ((1 << BITS) - 1) as f32;
    let scale = if most > least { last / (most - least) } else { 0.0 };
    let mut weights = [0.0; 16];
    for i in 0..16 {
        let index = ((along[i] - least) * scale + ROUND).to_bits() & 31;
        weights[i] = ramp::<BITS>(index as i32) as f32;
    }
    weights
}

/// Quantises endpoints, chooses the weights anew and measures the error; the line and its weights
/// as 0..=64.
#[inline(always)]
pub(super) fn settle<const N: usize, const BITS: u32>(
    texels: &[Lane; N],
    subset: &Lane,
    low: &[f32; N],
    high: &[f32; N],
    scale: &[f32; N],
    range: &Range,
) -> (Line<N>, Lane) {
    let quantised = |ends: &[f32; N]| std::array::from_fn(|c| quantise(range, ends[c] / scale[c]));
    let scaled = |ends: [u8; N]| std::array::from_fn(|c| f32::from(ends[c]) * scale[c]);
    let (low, high): ([u8; N], [u8; N]) = (quantised(low), quantised(high));
    let (from, to) = (low.map(f32::from), high.map(f32::from));
    let indices = project::<N, BITS>(texels, &scaled(low), &scaled(high));
    let (mut weights, mut errors) = ([0.0; 16], [0.0; 16]);
    for i in 0..16 {
        weights[i] = ramp::<BITS>(indices[i]) as f32;
    }
    for c in 0..N {
        for i in 0..16 {
            let d = scale[c] * decode(from[c], to[c] - from[c], weights[i]) - texels[c][i];
            errors[i] += d * d;
        }
    }
    let mut line = Line { low, high, weights: [0; 16], error: sum(|i| subset[i] * errors[i]) };
    for i in 0..16 {
        line.weights[i] = indices[i] as u8;
    }
    (line, weights)
}
