//! Estimates which two-subset patterns suit a block.

use fearless_simd::{Select, Simd, SimdBase};

use crate::lanes::Grid;
use crate::moments::{Moments, principal_axis, scatter_along, unit};
use crate::tables::PATTERNS_2;
use texel_simd::{Real, Wide};

/// The `K` patterns with the least errors, in ascending order of error.
pub(crate) struct BestPatterns<S: Simd, const K: usize> {
    pub patterns: [Wide<S>; K],
    errors: [Wide<S>; K],
}

impl<S: Simd, const K: usize> BestPatterns<S, K> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self { patterns: [Wide::splat(simd, 0.0); K], errors: [Wide::splat(simd, f32::INFINITY); K] }
    }

    /// Inserts a pattern if its error is among the least. Earlier patterns win ties.
    #[inline(always)]
    pub fn insert(&mut self, mut error: Wide<S>, mut pattern: Wide<S>) {
        let mut is_before = error.simd_lt(self.errors[0]);
        for k in 0..K {
            is_before |= error.simd_lt(self.errors[k]);
            let (old_error, old_pattern) = (self.errors[k], self.patterns[k]);
            self.errors[k] = is_before.select(error, old_error);
            self.patterns[k] = is_before.select(pattern, old_pattern);
            // The displaced pattern moves down.
            error = is_before.select(old_error, error);
            pattern = is_before.select(old_pattern, pattern);
        }
    }
}

/// Returns the `K` patterns with the least squared errors expected for lines of 2-bit weights. Texels are projected on
/// the plane of the two largest principal axes of the block, the first of which is `axis`.
#[inline(always)]
pub(crate) fn likely_patterns<S: Simd, const N: usize, const K: usize>(
    simd: S,
    texels: &[Grid<S>; N],
    all: &Moments<S, N>,
    axis: &[Wide<S>; N],
) -> [Wide<S>; K] {
    simd.vectorize(
        #[inline(always)]
        || {
            let first = unit(simd, axis);
            let along = scatter_along(simd, &all.scatter, &first);
            let mut left = all.scatter;
            for a in 0..N {
                for b in 0..N {
                    left[a][b] -= along * first[a] * first[b];
                }
            }
            let second = unit(simd, &principal_axis(simd, &left));
            let (u, v) = (projections(simd, texels, all, &first), projections(simd, texels, all, &second));
            rank_patterns(simd, &u, &v)
        },
    )
}

/// Projects the deviations of texels from their mean on a unit `axis`.
#[inline(always)]
fn projections<S: Simd, const N: usize>(
    simd: S,
    texels: &[Grid<S>; N],
    all: &Moments<S, N>,
    axis: &[Wide<S>; N],
) -> Grid<S> {
    let mut centre = Wide::splat(simd, 0.0);
    for (axis, sum) in axis.iter().zip(all.sums) {
        centre += *axis * sum;
    }
    centre /= all.count;
    let mut projections = [0.0 - centre; 16];
    for (i, projection) in projections.iter_mut().enumerate() {
        for (axis, levels) in axis.iter().zip(texels) {
            *projection += *axis * levels[i];
        }
    }
    projections
}

/// Returns the patterns with the least expected errors for texels at (u, v), whose mean is 0.
#[inline(always)]
fn rank_patterns<S: Simd, const K: usize>(simd: S, u: &Grid<S>, v: &Grid<S>) -> [Wide<S>; K] {
    let zero = Wide::splat(simd, 0.0);
    let mut features = [[zero; 5]; 16];
    let mut total = [zero; 5];
    for (i, feature) in features.iter_mut().enumerate() {
        *feature = [u[i], v[i], u[i] * u[i], u[i] * v[i], v[i] * v[i]];
        for f in 0..5 {
            total[f] += feature[f];
        }
    }
    let mut least = BestPatterns::new(simd);
    for (pattern, &members) in PATTERNS_2.iter().enumerate() {
        // Sums over subset 1; subset 0 is the rest.
        let mut one = [zero; 5];
        let mut bits = members;
        while bits != 0 {
            let feature = &features[bits.trailing_zeros() as usize & 15];
            for f in 0..5 {
                one[f] += feature[f];
            }
            bits &= bits - 1;
        }
        let mut other = total;
        for f in 0..5 {
            other[f] -= one[f];
        }
        let count = members.count_ones() as f32;
        let error = expected_error(count, &one) + expected_error(16.0 - count, &other);
        least.insert(error, Wide::splat(simd, pattern as f32));
    }
    least.patterns
}

/// Returns the smaller eigenvalue of a subset's 2 x 2 scatter plus a twelfth of the larger one.
#[inline(always)]
fn expected_error<S: Simd>(count: f32, &[u, v, uu, uv, vv]: &[Wide<S>; 5]) -> Wide<S> {
    let share = 1.0 / count;
    let (a, b, c) = (uu - u * u * share, uv - u * v * share, vv - v * v * share);
    let radius = Real::sqrt((a - c) * 0.25 * (a - c) + b * b);
    (a + c) * 0.5 * (13.0 / 12.0) - radius * (11.0 / 12.0)
}
