//! Merging texels: what a coarser texel holds, given the finer ones that it covers.

use fearless_simd::{Simd, prelude::*};

use crate::simd::{LANES, Real, Wide};

/// Texels that one coarser texel is merged from at most: 3 x 3.
pub(crate) const MAX_PARTS: usize = 9;

/// A texel that can be merged over an area: some numbers, and what they are of several texels together.
pub trait Merge: Copy + Default + Send + Sync {
    /// `[F; N]`: each number of one texel, or of several side by side.
    type Numbers<F: Copy>: Numbers<F>;

    /// The numbers of this texel.
    fn numbers(&self) -> Self::Numbers<f32>;

    /// The texel of `numbers`.
    fn of(numbers: Self::Numbers<f32>) -> Self;

    /// The merged numbers of `parts`. `weights` are as many, not negative, and sum to 1. Where merging needs room for each part,
    /// there is room for `MOST`, and [`Merge::merge`] must see to larger numbers of them.
    fn merged<F: Real, const MOST: usize>(weights: &[F], parts: &[Self::Numbers<F>]) -> Self::Numbers<F>;

    /// The merged texel of any number of parts, with weights like those of [`Merge::merged`].
    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        let parts: Vec<_> = parts.iter().map(Self::numbers).collect();
        Self::of(Self::merged::<_, MAX_PARTS>(weights, &parts))
    }
}

/// The numbers of a texel: `[F; N]`.
pub trait Numbers<F: Copy>: Copy + AsRef<[F]> + AsMut<[F]> {
    /// `value` for all of them.
    fn all(value: F) -> Self;
}

impl<F: Copy, const N: usize> Numbers<F> for [F; N] {
    #[inline(always)]
    fn all(value: F) -> Self {
        [value; N]
    }
}

/// [`Merge::merge`] for texels side by side, to `out`: that of lane i has the weights `weights[..][i]`, at most `MOST`, and the
/// parts `part(.., i)`. `lanes` is room for numbers, which is cleared once for all groups.
// Loops and not closures over arrays: what is not inlined into the caller has none of its vectors.
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
    // Not in the same loop: a vector that is read back right after its numbers are written waits for all of them.
    let (mut wide, mut parts) = ([zero; MOST], [T::Numbers::<Wide<S>>::all(zero); MOST]);
    for tap in 0..weights.len() {
        wide[tap] = Wide::simd_from(simd, weights[tap]);
        for (part, lanes) in parts[tap].as_mut().iter_mut().zip(lanes[tap].as_ref()) {
            *part = Wide::simd_from(simd, *lanes);
        }
    }
    let merged = T::merged::<_, MOST>(&wide[..weights.len()], &parts[..weights.len()]);
    let room = &mut lanes[0];
    for (room, merged) in room.as_mut().iter_mut().zip(merged.as_ref()) {
        *room = (*merged).into();
    }
    for (lane, out) in out.iter_mut().enumerate() {
        let mut numbers = T::Numbers::<f32>::all(0.0);
        for (number, room) in numbers.as_mut().iter_mut().zip(room.as_ref()) {
            *number = room[lane];
        }
        *out = T::of(numbers);
    }
}

/// Plain averages, for channels whose variance no one needs.
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

    /// Without the copy of the parts: maps are magnified texel by texel.
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
