//! A part of a merge: a lobe, or one lobe in each lane.

use super::slopes::Matrix;
use crate::simd::Real;

/// A lobe to be merged.
#[derive(Clone, Copy, Default)]
pub(super) struct Part<F> {
    pub(super) normal: [F; 3],
    pub(super) a: Matrix<F>,
}

impl<F: Real> Part<F> {
    #[inline(always)]
    pub(super) fn of([x, y, z, uu, uv, vv]: [F; 6]) -> Self {
        Self { normal: [x, y, z], a: Matrix { uu, uv, vv } }
    }

    #[inline(always)]
    pub(super) fn numbers(self) -> [F; 6] {
        let ([x, y, z], Matrix { uu, uv, vv }) = (self.normal, self.a);
        [x, y, z, uu, uv, vv]
    }

    #[inline(always)]
    pub(super) fn select(self, other: Self, mask: F::Mask) -> Self {
        let (mut numbers, other) = (self.numbers(), other.numbers());
        for i in 0..6 {
            numbers[i] = numbers[i].select(other[i], mask);
        }
        Self::of(numbers)
    }
}

/// Adds `weight` * `vector` to `sum`.
#[inline(always)]
pub(super) fn add<F: Real>(sum: &mut [F; 3], weight: F, vector: [F; 3]) {
    for i in 0..3 {
        sum[i] = sum[i] + weight * vector[i];
    }
}
