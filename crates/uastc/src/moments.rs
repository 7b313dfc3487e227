//! First and second moments of the colours of a block or subset.
//!
//! Sums of texels and of their products are whole numbers below 2^24, hence exact in `f32`
//! whatever the order.

#![expect(clippy::needless_range_loop, reason = "loops over channels read several arrays at one index")]

use fearless_simd::{Select, Simd, SimdBase};

use crate::lanes::{Grid, sum};
use texel_simd::{Real, Wide};

/// Count, sums and scatter (sum of products of the departures from the mean) of a subset.
#[derive(Clone, Copy)]
pub(crate) struct Moments<S: Simd, const N: usize> {
    pub count: Wide<S>,
    pub sums: [Wide<S>; N],
    pub scatter: [[Wide<S>; N]; N],
}

/// `v`, of a texel that counts with 1 in its subset or with 0; without a subset all texels count.
#[inline(always)]
pub(crate) fn counted<S: Simd>(subset: Option<&Grid<S>>, i: usize, v: Wide<S>) -> Wide<S> {
    match subset {
        Some(subset) => subset[i] * v,
        None => v,
    }
}

/// Texels of a subset.
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

/// Moments of the texels in `subset` (1 for a member, 0 for the rest), which has a member.
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
            |i| counted(subset, i, texels[a][i]),
        );
    }
    for a in 0..N {
        for b in a..N {
            let products = sum(
                #[inline(always)]
                |i| counted(subset, i, texels[a][i]) * texels[b][i],
            );
            m.scatter[a][b] = products - m.sums[a] * m.sums[b] * share;
            m.scatter[b][a] = m.scatter[a][b];
        }
    }
    m
}

/// Sum of the diagonal.
#[inline(always)]
pub(crate) fn trace<S: Simd, const N: usize>(scatter: &[[Wide<S>; N]; N]) -> Wide<S> {
    let mut trace = scatter[0][0];
    for c in 1..N {
        trace += scatter[c][c];
    }
    trace
}

/// Squared length of a vector.
#[inline(always)]
fn squared_length<S: Simd, const N: usize>(vector: &[Wide<S>; N]) -> Wide<S> {
    let mut length = vector[0] * vector[0];
    for v in &vector[1..] {
        length += *v * *v;
    }
    length
}

/// Direction of the largest scatter, of any length; zero where all texels are equal.
#[inline(always)]
pub(crate) fn principal_axis<S: Simd, const N: usize>(simd: S, scatter: &[[Wide<S>; N]; N]) -> [Wide<S>; N] {
    let (zero, one) = (Wide::splat(simd, 0.0), Wide::splat(simd, 1.0));
    if N == 1 {
        return [one; N];
    }
    // Eight power iterations as three squarings; the best-aligned column of the result.
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

/// Scatter along `axis`, the larger eigenvalue if the axis is principal.
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

/// `axis` with length 1; zero stays.
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
