//! Merging texels: what a coarser texel holds, given the finer ones that it covers.

#![expect(clippy::needless_range_loop, reason = "loops over lanes and channels read several arrays at one index")]

use fearless_simd::{Simd, prelude::*};

use crate::bump::Offset;
use crate::simd::{LANES, Real, Wide};
use crate::symmetric::Symmetric2;

/// Texels that one coarser texel is merged from at most: 3 x 3.
pub(crate) const MAX_PARTS: usize = 9;

/// A value that can be merged over an area.
pub trait Merge: Copy + Default + Send + Sync {
    /// The merged value of `parts`. `weights` has the same length, is not negative and sums to 1.
    fn merge(weights: &[f32], parts: &[Self]) -> Self;

    /// The same for texels side by side: that of lane i has weights `weights[..][i]`, at most `MOST`, and parts
    /// `part(.., i)`.
    #[inline(always)]
    fn merge_lanes<S: Simd, const MOST: usize>(
        _simd: S,
        weights: &[[f32; LANES]],
        part: impl Fn(usize, usize) -> Self,
    ) -> [Self; LANES] {
        std::array::from_fn(|lane| {
            let (mut own, mut parts) = ([0.0; MOST], [Self::default(); MOST]);
            for (tap, weights) in weights.iter().enumerate() {
                own[tap] = weights[lane];
                parts[tap] = part(tap, lane);
            }
            Self::merge(&own[..weights.len()], &parts[..weights.len()])
        })
    }
}

// Loops and not closures over arrays: what is not inlined into the caller has none of its vectors.

/// The `N` numbers of each of the first `taps` parts, `LANES` texels wide.
#[inline(always)]
pub(crate) fn load<S: Simd, const MOST: usize, const N: usize>(
    simd: S,
    taps: usize,
    values: impl Fn(usize, usize) -> [f32; N],
) -> [[Wide<S>; N]; MOST] {
    let mut lanes = [[[0.0; LANES]; N]; MOST];
    for tap in 0..taps {
        for lane in 0..LANES {
            let values = values(tap, lane);
            for i in 0..N {
                lanes[tap][i][lane] = values[i];
            }
        }
    }
    // Not in the same loop: a vector that is read back right after its numbers are written waits for all of them.
    let mut wide = [[Wide::splat(simd, 0.0); N]; MOST];
    for tap in 0..taps {
        for i in 0..N {
            wide[tap][i] = Wide::simd_from(simd, lanes[tap][i]);
        }
    }
    wide
}

/// The numbers of each lane.
#[inline(always)]
pub(crate) fn store<S: Simd, const N: usize>(wide: [Wide<S>; N]) -> [[f32; N]; LANES] {
    let mut values = [[0.0; N]; LANES];
    for i in 0..N {
        let lanes: [f32; LANES] = wide[i].into();
        for lane in 0..LANES {
            values[lane][i] = lanes[lane];
        }
    }
    values
}

/// A texel as `N` numbers, for [`Merge`].
pub(super) trait Numbers<const N: usize>: Copy + Default {
    /// The numbers.
    fn values(&self) -> [f32; N];

    /// The texel of them.
    fn from_values(values: [f32; N]) -> Self;

    /// The numbers of what is merged of `parts`, for one texel or many side by side.
    fn merged<F: Real>(weights: &[F], parts: &[[F; N]]) -> [F; N];
}

/// [`Merge::merge`] of numbers.
pub(super) fn merge_numbers<T: Numbers<N>, const N: usize>(weights: &[f32], parts: &[T]) -> T {
    let parts: Vec<_> = parts.iter().map(T::values).collect();
    T::from_values(T::merged(weights, &parts))
}

/// [`Merge::merge_lanes`] of numbers.
#[inline(always)]
pub(super) fn merge_number_lanes<S: Simd, T: Numbers<N>, const MOST: usize, const N: usize>(
    simd: S,
    weights: &[[f32; LANES]],
    part: impl Fn(usize, usize) -> T,
) -> [T; LANES] {
    let mut wide = [Wide::splat(simd, 0.0); MOST];
    for (tap, weights) in weights.iter().enumerate() {
        wide[tap] = Wide::simd_from(simd, *weights);
    }
    let parts = load::<S, MOST, N>(simd, weights.len(), |tap, lane| part(tap, lane).values());
    let merged = store(T::merged(&wide[..weights.len()], &parts[..weights.len()]));
    let mut texels = [T::default(); LANES];
    for lane in 0..LANES {
        texels[lane] = T::from_values(merged[lane]);
    }
    texels
}

/// Mean and covariance of the offsets in the area of one texel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Mean offset: what the bump pyramid stores.
    pub mean: Offset,
    /// Covariance K of the offsets about `mean`: what the roughness pyramid stores. Positive semidefinite.
    pub covariance: Symmetric2,
}

impl Moments {
    /// The moments of a texel in which the offset does not vary.
    pub fn flat(mean: Offset) -> Self {
        Self { mean, covariance: Symmetric2::ZERO }
    }
}

impl Merge for Moments {
    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        merge_numbers(weights, parts)
    }

    #[inline(always)]
    fn merge_lanes<S: Simd, const MOST: usize>(
        simd: S,
        weights: &[[f32; LANES]],
        part: impl Fn(usize, usize) -> Self,
    ) -> [Self; LANES] {
        merge_number_lanes::<S, Self, MOST, _>(simd, weights, part)
    }
}

impl Numbers<5> for Moments {
    #[inline(always)]
    fn values(&self) -> [f32; 5] {
        let Symmetric2 { uu, uv, vv } = self.covariance;
        [self.mean.u, self.mean.v, uu, uv, vv]
    }

    #[inline(always)]
    fn from_values([u, v, uu, uv, vv]: [f32; 5]) -> Self {
        Self { mean: Offset { u, v }, covariance: Symmetric2::new(uu, uv, vv) }
    }

    /// m = sum w m_i, K = sum w (K_i + (m_i - m)(m_i - m)^T): the paper's recursion ("The roughness pyramid", last formula)
    /// for any weights. Central moments throughout: `E[x^2] - E[x]^2` cancels (test
    /// `moment_subtraction_cancels_and_the_recursion_does_not`). Parts are u, v, uu, uv, vv.
    #[inline(always)]
    fn merged<F: Real>(weights: &[F], parts: &[[F; 5]]) -> [F; 5] {
        let zero = weights[0].like(0.0);
        let (mut u, mut v) = (zero, zero);
        for (w, part) in weights.iter().zip(parts) {
            (u, v) = (u + *w * part[0], v + *w * part[1]);
        }
        let (mut uu, mut uv, mut vv) = (zero, zero, zero);
        for (w, part) in weights.iter().zip(parts) {
            let (x, y) = (part[0] - u, part[1] - v);
            uu = uu + *w * (part[2] + x * x);
            uv = uv + *w * (part[3] + x * y);
            vv = vv + *w * (part[4] + y * y);
        }
        [u, v, uu, uv, vv]
    }
}

/// Plain averages, for channels whose variance no one needs.
impl<const N: usize> Merge for [f32; N]
where
    [f32; N]: Default,
{
    #[inline]
    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        let mut sum = [0.0; N];
        for (w, part) in weights.iter().zip(parts) {
            for (s, p) in sum.iter_mut().zip(part) {
                *s += w * p;
            }
        }
        sum
    }

    #[inline(always)]
    fn merge_lanes<S: Simd, const MOST: usize>(
        simd: S,
        weights: &[[f32; LANES]],
        part: impl Fn(usize, usize) -> Self,
    ) -> [Self; LANES] {
        let parts = load::<S, MOST, N>(simd, weights.len(), part);
        let mut sum = [Wide::splat(simd, 0.0); N];
        for (weights, part) in weights.iter().zip(parts) {
            let weights = Wide::simd_from(simd, *weights);
            for i in 0..N {
                sum[i] += weights * part[i];
            }
        }
        store(sum)
    }
}
