//! Merging: computes a coarser texel from the finer texels that it covers.

use fearless_simd::{Simd, prelude::*};

use crate::simd::{LANES, Real, Wide};

/// The most texels that one coarser texel is merged from: 3 x 3.
pub(crate) const MAX_PARTS: usize = 9;

/// A texel as an array of channels, and the rule that merges several texels into one.
pub trait Merge: Copy + Default + Send + Sync {
    /// The channels of a texel, `[F; N]`. `F` is `f32` for one texel, or a vector for one texel in each lane.
    type Numbers<F: Copy>: Numbers<F>;

    /// Returns the channels of this texel.
    fn numbers(&self) -> Self::Numbers<f32>;

    /// Creates a texel from its channels.
    fn of(numbers: Self::Numbers<f32>) -> Self;

    /// Merges the channels of `parts`. There is one weight for each part; weights are not negative and sum to 1.
    ///
    /// Implementations may reserve memory for `MOST` parts. An implementation that does so must override
    /// [`Merge::merge`], which accepts any number of parts.
    fn merged<F: Real, const MOST: usize>(weights: &[F], parts: &[Self::Numbers<F>]) -> Self::Numbers<F>;

    /// Merges any number of texels, with weights as in [`Merge::merged`].
    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        let parts: Vec<_> = parts.iter().map(Self::numbers).collect();
        Self::of(Self::merged::<_, MAX_PARTS>(weights, &parts))
    }
}

/// The channels of a texel: `[F; N]`.
pub trait Numbers<F: Copy>: Copy + AsRef<[F]> + AsMut<[F]> {
    /// Returns an array in which all channels are `value`.
    fn all(value: F) -> Self;
}

impl<F: Copy, const N: usize> Numbers<F> for [F; N] {
    #[inline(always)]
    fn all(value: F) -> Self {
        [value; N]
    }
}

/// Merges one texel in each lane and writes the texels to `out`.
///
/// The texel of lane i has the weights `weights[..][i]`, at most `MOST`, and the parts `part(.., i)`. `lanes` is
/// scratch memory, which the caller reuses for all groups of a row.
// Loops instead of closures over arrays: code that is not inlined into the caller is not compiled for its vectors.
#[inline(always)]
pub(super) fn merge_lanes<S: Simd, T: Merge, const MOST: usize>(
    simd: S,
    weights: &[[f32; LANES]],
    part: impl Fn(usize, usize) -> T,
    lanes: &mut [T::Numbers<[f32; LANES]>; MOST],
    out: &mut [T],
) {
    let zero = Wide::splat(simd, 0.0);
    for tap in 0..weights.len() {
        for lane in 0..LANES {
            let numbers = part(tap, lane).numbers();
            for (lanes, number) in lanes[tap].as_mut().iter_mut().zip(numbers.as_ref()) {
                lanes[lane] = *number;
            }
        }
    }
    // A loop of its own: a vector that is loaded right after its numbers were stored one by one waits for these stores.
    let (mut wide, mut parts) = ([zero; MOST], [T::Numbers::<Wide<S>>::all(zero); MOST]);
    for tap in 0..weights.len() {
        wide[tap] = Wide::simd_from(simd, weights[tap]);
        for (part, lanes) in parts[tap].as_mut().iter_mut().zip(lanes[tap].as_ref()) {
            *part = Wide::simd_from(simd, *lanes);
        }
    }
    let merged = T::merged::<_, MOST>(&wide[..weights.len()], &parts[..weights.len()]);
    let results = &mut lanes[0];
    for (result, merged) in results.as_mut().iter_mut().zip(merged.as_ref()) {
        *result = (*merged).into();
    }
    for (lane, out) in out.iter_mut().enumerate() {
        let mut numbers = T::Numbers::<f32>::all(0.0);
        for (number, result) in numbers.as_mut().iter_mut().zip(results.as_ref()) {
            *number = result[lane];
        }
        *out = T::of(numbers);
    }
}

/// Averages channels whose variance is not needed.
impl<const N: usize> Merge for [f32; N]
where
    [f32; N]: Default,
{
    type Numbers<F: Copy> = [F; N];

    #[inline(always)]
    fn numbers(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn of(numbers: Self) -> Self {
        numbers
    }

    /// Merges without the copy of the parts that the default makes, because magnified maps merge texel by texel.
    #[inline]
    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        Self::merged::<_, MAX_PARTS>(weights, parts)
    }

    #[inline(always)]
    fn merged<F: Real, const MOST: usize>(weights: &[F], parts: &[[F; N]]) -> [F; N] {
        let mut sum = [weights[0].splat_like(0.0); N];
        for (w, part) in weights.iter().zip(parts) {
            for i in 0..N {
                sum[i] = sum[i] + *w * part[i];
            }
        }
        sum
    }
}
