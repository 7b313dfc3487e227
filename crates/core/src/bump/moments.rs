//! First and second moments of offsets: a texel of the bump pyramid and of the roughness pyramid.

use crate::bump::Offset;
use crate::math::symmetric::Symmetric2;
use crate::mip::Merge;
use crate::simd::Real;

/// Mean and covariance of the offsets in the area of one texel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Mean offset, which the bump pyramid stores.
    pub mean: Offset,
    /// Covariance K of the offsets about `mean`, which the roughness pyramid stores. Positive semidefinite.
    pub covariance: Symmetric2,
}

impl Moments {
    /// Returns the moments of a texel in which the offset does not vary.
    pub fn flat(mean: Offset) -> Self {
        Self { mean, covariance: Symmetric2::ZERO }
    }
}

impl Merge for Moments {
    type Numbers<F: Copy> = [F; 5];

    #[inline(always)]
    fn numbers(&self) -> [f32; 5] {
        let Symmetric2 { uu, uv, vv } = self.covariance;
        [self.mean.u, self.mean.v, uu, uv, vv]
    }

    #[inline(always)]
    fn of([u, v, uu, uv, vv]: [f32; 5]) -> Self {
        Self { mean: Offset { u, v }, covariance: Symmetric2::new(uu, uv, vv) }
    }

    /// Merges by the paper's recursion ("The roughness pyramid", last formula) for any weights:
    /// m = sum w m_i, K = sum w (K_i + (m_i - m)(m_i - m)^T).
    ///
    /// All moments are central, because `E[x^2] - E[x]^2` suffers from cancellation (test
    /// `moment_subtraction_cancels_and_the_recursion_does_not`). The channels of a part are u, v, uu, uv, vv.
    #[inline(always)]
    fn merged<F: Real, const MOST: usize>(weights: &[F], parts: &[[F; 5]]) -> [F; 5] {
        let zero = weights[0].splat_like(0.0);
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
