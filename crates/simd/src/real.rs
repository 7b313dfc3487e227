//! The trait of numbers and of vectors of numbers.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, prelude::*};

use crate::{Wide, WideMask};

/// A number, or a vector with one number in each lane.
///
/// All operations work lane by lane and give the same bits for a number and for a lane of a vector. Names that the
/// vectors of `fearless_simd` already have are avoided (`splat`, `simd_le`), so that kernels on vectors can use both.
pub trait Real: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// One truth value for each lane.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    /// Returns `value` in every lane. `self` only provides the type and the instruction set; its numbers are not used.
    fn splat_like(self, value: f32) -> Self;

    /// Returns the correctly rounded square root of each lane.
    fn sqrt(self) -> Self;

    /// Returns the larger number of each lane. The result for NaN depends on the machine.
    fn max(self, other: Self) -> Self;

    /// Returns the smaller number of each lane. The result for NaN depends on the machine.
    fn min(self, other: Self) -> Self;

    /// Compares lane by lane ("less or equal"): the mask is set where `self` is at most `other`.
    fn lanes_le(self, other: Self) -> Self::Mask;

    /// Compares lane by lane with 0: the mask is set where `self` is 0 or -0.
    fn is_zero(self) -> Self::Mask;

    /// Selects `self` where `mask` is set and `other` elsewhere.
    fn select(self, other: Self, mask: Self::Mask) -> Self;

    /// Returns whether `mask` is set in all lanes.
    fn all(mask: Self::Mask) -> bool;
}

impl Real for f32 {
    type Mask = bool;

    #[inline(always)]
    fn splat_like(self, value: f32) -> Self {
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
    fn lanes_le(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self == 0.0
    }

    #[inline(always)]
    fn select(self, other: Self, mask: bool) -> Self {
        if mask { self } else { other }
    }

    #[inline(always)]
    fn all(mask: bool) -> bool {
        mask
    }
}

impl<S: Simd> Real for Wide<S> {
    type Mask = WideMask<S>;

    #[inline(always)]
    fn splat_like(self, value: f32) -> Self {
        SimdBase::splat(self.simd, value)
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
    fn lanes_le(self, other: Self) -> Self::Mask {
        self.simd_le(other)
    }

    #[inline(always)]
    fn is_zero(self) -> Self::Mask {
        self.simd_eq(0.0)
    }

    #[inline(always)]
    fn select(self, other: Self, mask: Self::Mask) -> Self {
        mask.select(self, other)
    }

    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        mask.all_true()
    }
}
