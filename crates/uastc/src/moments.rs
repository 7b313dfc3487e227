//! First and second moments of the colours of a block or subset.
//!
//! Sums of texels and of their products are whole numbers below 2^24, which `f32` holds exactly in any order of
//! addition.

#![expect(clippy::needless_range_loop, reason = "loops over channels read several arrays at one index")]

use fearless_simd::{Select, Simd, SimdBase};

use crate::lanes::{Grid, sum};
use texel_simd::{Real, Wide};

/// Count, sums and scatter matrix of a subset. The scatter is the sum of products of deviations from the mean.
#[derive(Clone, Copy)]
pub(crate) struct Moments<S: Simd, const N: usize> {
    pub count: Wide<S>,
    pub sums: [Wide<S>; N],
    pub scatter: [[Wide<S>; N]; N],
}

/// Returns `v` for texel `i` if the texel is in the subset, and 0 otherwise. Without a subset, all texels count.
#[inline(always)]
pub(crate) fn masked<S: Simd>(subset: Option<&Grid<S>>, i: usize, v: Wide<S>) -> Wide<S> {
    match subset {
        Some(subset) => subset[i] * v,
        None => v,
    }
}

/// Returns the number of texels in a subset.
#[inline(always)]
pub(crate) fn count<S: Simd>(simd: S, subset: Option<&Grid<S>>) -> Wide<S> {
    match subset {
        Some(subset) => sum(
            #[inline(always)]
            |i| subset[i],
        ),
        None => Wide::splat(simd, 16.0),
    }
}

/// Computes the moments of the texels in `subset` (1 for a member, 0 for other texels), which must not be empty.
#[inline(always)]
pub(crate) fn moments<S: Simd, const N: usize>(
    simd: S,
    texels: &[Grid<S>; N],
    subset: Option<&Grid<S>>,
) -> Moments<S, N> {
    let zero = Wide::splat(simd, 0.0);
    let mut m = Moments { count: count(simd, subset), sums: [zero; N], scatter: [[zero; N]; N] };
    let share = Wide::splat(simd, 1.0) / m.count;
    for a in 0..N {
        m.sums[a] = sum(
            #[inline(always)]
            |i| masked(subset, i, texels[a][i]),
        );
    }
    for a in 0..N {
        for b in a..N {
            let products = sum(
                #[inline(always)]
                |i| masked(subset, i, texels[a][i]) * texels[b][i],
            );
            m.scatter[a][b] = products - m.sums[a] * m.sums[b] * share;
            m.scatter[b][a] = m.scatter[a][b];
        }
    }
    m
}

/// Returns the sum of the diagonal.
#[inline(always)]
pub(crate) fn trace<S: Simd, const N: usize>(scatter: &[[Wide<S>; N]; N]) -> Wide<S> {
    let mut trace = scatter[0][0];
    for c in 1..N {
        trace += scatter[c][c];
    }
    trace
}

/// Returns the squared length of a vector.
#[inline(always)]
fn squared_length<S: Simd, const N: usize>(vector: &[Wide<S>; N]) -> Wide<S> {
    let mut length = vector[0] * vector[0];
    for v in &vector[1..] {
        length += *v * *v;
    }
    length
}

/// Returns the direction of the largest scatter, of any length; 0 if all texels are equal.
#[inline(always)]
pub(crate) fn principal_axis<S: Simd, const N: usize>(simd: S, scatter: &[[Wide<S>; N]; N]) -> [Wide<S>; N] {
    let (zero, one) = (Wide::splat(simd, 0.0), Wide::splat(simd, 1.0));
    if N == 1 {
        return [one; N];
    }
    // Three squarings are eight power iterations. The column with the largest diagonal element is aligned best.
    let mut power = *scatter;
    for _ in 0..3 {
        let trace = trace(&power);
        let scale = trace.simd_gt(1e-6).select(one / trace, zero);
        for row in &mut power {
            for v in row {
                *v *= scale;
            }
        }
        let mut square = [[zero; N]; N];
        for a in 0..N {
            for b in a..N {
                for k in 0..N {
                    square[a][b] += power[a][k] * power[k][b];
                }
                square[b][a] = square[a][b];
            }
        }
        power = square;
    }
    let mut best = power[0][0];
    let mut axis = power[0];
    for c in 1..N {
        let is_larger = power[c][c].simd_gt(best);
        best = is_larger.select(power[c][c], best);
        for a in 0..N {
            axis[a] = is_larger.select(power[c][a], axis[a]);
        }
    }
    axis
}

/// Returns the scatter along `axis`, which is the largest eigenvalue for the principal axis.
#[inline(always)]
pub(crate) fn scatter_along<S: Simd, const N: usize>(
    simd: S,
    scatter: &[[Wide<S>; N]; N],
    axis: &[Wide<S>; N],
) -> Wide<S> {
    let zero = Wide::splat(simd, 0.0);
    let length = squared_length(axis);
    let mut along = zero;
    for a in 0..N {
        for b in 0..N {
            along += axis[a] * axis[b] * scatter[a][b];
        }
    }
    length.simd_gt(0.0).select(along / length, zero)
}

/// Scales `axis` to length 1. A zero vector stays 0.
#[inline(always)]
pub(crate) fn unit<S: Simd, const N: usize>(simd: S, axis: &[Wide<S>; N]) -> [Wide<S>; N] {
    let (zero, one) = (Wide::splat(simd, 0.0), Wide::splat(simd, 1.0));
    let length = squared_length(axis);
    let scale = length.simd_gt(0.0).select(one / Real::sqrt(length), zero);
    let mut axis = *axis;
    for a in &mut axis {
        *a *= scale;
    }
    axis
}
