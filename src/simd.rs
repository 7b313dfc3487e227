//! Arithmetic written once, for single numbers and for vectors of them.
//!
//! Kernels are generic over [`Real`] and put one texel into each lane, so that a vector holds the bits that single
//! numbers would, whatever the machine has. Only what IEEE 754 rounds alike everywhere is offered: no fused
//! multiplication, no approximate reciprocal.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16, mask32x16, prelude::*};

/// Texels side by side in a vector: as many as one of AVX-512 holds. With shorter vectors each number takes two or four; with
/// AVX2 a whole bake takes as long as with eight lanes.
pub const LANES: usize = 16;

/// Numbers of [`LANES`] texels.
pub type Wide<S> = f32x16<S>;

/// Does `$op` with the vectors `$simd` of the processor at `$level`, as `fearless_simd::dispatch` does. On x86-64 with three of
/// the crate's four sets, each of which adds as much to the time that the kernels take to compile: few machines have SSE4.2 and
/// no AVX2. With AVX-512 a whole bake takes 0.86 of the time that it takes with AVX2.
macro_rules! dispatch {
    ($level:expr, $simd:ident => $op:expr) => {{
        let level: fearless_simd::Level = $level;
        #[cfg(target_arch = "x86_64")]
        match (level.as_avx512(), level.as_avx2(), level.as_sse2()) {
            (Some($simd), ..) => fearless_simd::Simd::vectorize($simd, #[inline(always)] || $op),
            (None, Some($simd), _) => fearless_simd::Simd::vectorize($simd, #[inline(always)] || $op),
            (None, None, Some($simd)) => fearless_simd::Simd::vectorize($simd, #[inline(always)] || $op),
            (None, None, None) => unreachable!("SSE2 is part of x86-64"),
        }
        #[cfg(not(target_arch = "x86_64"))]
        fearless_simd::dispatch!(level, $simd => $op)
    }};
}
pub(crate) use dispatch;

/// What this machine can do, and less.
#[cfg(test)]
pub fn instruction_sets() -> Vec<fearless_simd::Level> {
    let all = fearless_simd::Level::new();
    #[cfg(target_arch = "x86_64")]
    let sets = [
        all.as_sse2().map(fearless_simd::Level::Sse2),
        all.as_avx2().map(fearless_simd::Level::Avx2),
        all.as_avx512().map(fearless_simd::Level::Avx512),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let sets = [Some(all)];
    sets.into_iter().flatten().collect()
}

/// Texels of a row that are worked on at a time: their numbers stay in the nearest cache.
const STRIP: usize = 64;

/// Stores in each of `out` what `of` makes of the numbers of its texel in `texels`, which are as many, with the vectors of the
/// processor. `of` should not branch.
///
/// Equal numbers of texels that stand side by side are put side by side first: compilers make vectors of loops over plain
/// arrays, but not of loops over texels of three or five numbers.
pub fn map_row<'a, T: 'a, const N: usize, const M: usize>(
    texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    of: impl Fn([f32; N]) -> [f32; M],
    store: impl FnMut(&mut T, [f32; M]),
) {
    map_row_marking(texels, out, |texel| (of(texel), false), store);
}

/// [`map_row`] where `of` also marks texels; returns whether it marked any.
pub fn map_row_marking<'a, T: 'a, const N: usize, const M: usize>(
    texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    of: impl Fn([f32; N]) -> ([f32; M], bool),
    store: impl FnMut(&mut T, [f32; M]),
) -> bool {
    map_row_with(fearless_simd::Level::new(), texels, out, of, store)
}

fn map_row_with<'a, T: 'a, const N: usize, const M: usize>(
    level: fearless_simd::Level,
    texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    of: impl Fn([f32; N]) -> ([f32; M], bool),
    store: impl FnMut(&mut T, [f32; M]),
) -> bool {
    dispatch!(level, _simd => map_strips(texels, out, of, store))
}

#[inline(always)]
fn map_strips<'a, T: 'a, const N: usize, const M: usize>(
    mut texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    of: impl Fn([f32; N]) -> ([f32; M], bool),
    mut store: impl FnMut(&mut T, [f32; M]),
) -> bool {
    let (mut from, mut to, mut marks) = ([[0.0; STRIP]; N], [[0.0; STRIP]; M], [0; STRIP]);
    let mut is_any_marked = false;
    for out in out.chunks_mut(STRIP) {
        for (i, texel) in texels.by_ref().take(out.len()).enumerate() {
            for n in 0..N {
                from[n][i] = texel[n];
            }
        }
        for i in 0..STRIP {
            let mut texel = [0.0; N];
            for n in 0..N {
                texel[n] = from[n][i];
            }
            let (made, is_marked) = of(texel);
            for m in 0..M {
                to[m][i] = made[m];
            }
            marks[i] = u32::from(is_marked);
        }
        is_any_marked |= marks[..out.len()].iter().fold(0, |any, mark| any | mark) != 0;
        for (i, out) in out.iter_mut().enumerate() {
            let mut made = [0.0; M];
            for m in 0..M {
                made[m] = to[m][i];
            }
            store(out, made);
        }
    }
    is_any_marked
}

/// A number, or one for each lane of a vector.
pub trait Real: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// A truth for each lane.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    /// `value` in as many lanes.
    fn like(self, value: f32) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The larger number.
    fn max(self, other: Self) -> Self;

    /// The smaller number.
    fn min(self, other: Self) -> Self;

    /// Where it is at most `other`.
    fn at_most(self, other: Self) -> Self::Mask;

    /// Where it is 0.
    fn is_zero(self) -> Self::Mask;

    /// It where `mask` holds, else `other`.
    fn or(self, other: Self, mask: Self::Mask) -> Self;

    /// Whether `mask` holds in all lanes.
    fn all(mask: Self::Mask) -> bool;
}

impl Real for f32 {
    type Mask = bool;

    #[inline(always)]
    fn like(self, value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        f32::max(self, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        f32::min(self, other)
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self == 0.0
    }

    #[inline(always)]
    fn or(self, other: Self, mask: bool) -> Self {
        if mask { self } else { other }
    }

    #[inline(always)]
    fn all(mask: bool) -> bool {
        mask
    }
}

impl<S: Simd> Real for Wide<S> {
    type Mask = mask32x16<S>;

    #[inline(always)]
    fn like(self, value: f32) -> Self {
        Self::splat(self.simd, value)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        SimdFloat::sqrt(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        SimdBase::max(self, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        SimdBase::min(self, other)
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> Self::Mask {
        self.simd_le(other)
    }

    #[inline(always)]
    fn is_zero(self) -> Self::Mask {
        self.simd_eq(0.0)
    }

    #[inline(always)]
    fn or(self, other: Self, mask: Self::Mask) -> Self {
        mask.select(self, other)
    }

    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        mask.all_true()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_any_length_hold_what_single_texels_would() {
        let of = |[x, y]: [f32; 2]| [x / y, (x * x + y * y).sqrt(), x.max(y)];
        for length in [0usize, 1, 63, 64, 65, 200] {
            let texels: Vec<[f32; 2]> = (0..length).map(|i| [i as f32 - 70.5, 0.1 + i as f32]).collect();
            let expected: Vec<[f32; 3]> = texels.iter().copied().map(of).collect();
            // The last texel alone, one beyond it, and none.
            for (marked, is_any) in [(length.wrapping_sub(1), length > 0), (length, false), (usize::MAX, false)] {
                let marking = |texel: [f32; 2]| (of(texel), texel[1] == 0.1 + marked as f32);
                for set in instruction_sets() {
                    let mut out = vec![[0.0; 3]; length];
                    let found =
                        map_row_with(set, texels.iter().copied(), &mut out, marking, |texel, made| *texel = made);
                    assert_eq!((&out, found), (&expected, is_any), "{length} texels, {marked}, {set:?}");
                }
            }
        }
    }

    #[test]
    fn what_stands_beyond_a_row_marks_nothing() {
        let mut row = vec![0.0; 6];
        // The rest of its strip is zeros.
        let is_zero = |[x]: [f32; 1]| ([x], x == 0.0);
        assert!(!map_row_marking((1..7).map(|i| [i as f32]), &mut row, is_zero, |out, [x]| *out = x));
    }
}
