//! Third and fourth moments, which distinguish heavy-tailed and skewed distributions of offsets from normal ones.

use crate::bump::Moments;
use crate::math::symmetric::Symmetric2;
use crate::mip::{Merge, TexelRows};
use crate::simd::Real;

/// Mean, covariance and the third and fourth central moments of the offsets in the area of one texel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapedMoments {
    /// Mean and covariance.
    pub moments: Moments,
    /// E of d_u^3, d_u^2 d_v, d_u d_v^2, d_v^3, where d is the offset minus its mean.
    pub third: [f32; 4],
    /// E of d_u^4, d_u^3 d_v, d_u^2 d_v^2, d_u d_v^3, d_v^4.
    pub fourth: [f32; 5],
}

impl ShapedMoments {
    /// Returns the moments of a normal distribution: third moments are 0, and fourth moments follow from Isserlis'
    /// theorem.
    pub fn normal(moments: Moments) -> Self {
        let Symmetric2 { uu, uv, vv } = moments.covariance;
        let fourth = [3.0 * uu * uu, 3.0 * uu * uv, uu * vv + 2.0 * uv * uv, 3.0 * uv * vv, 3.0 * vv * vv];
        Self { moments, third: [0.0; 4], fourth }
    }
}

/// Channels of a texel: mean, covariance, third and fourth moments.
const VALUES: usize = 14;

impl Merge for ShapedMoments {
    type Numbers<F: Copy> = [F; VALUES];

    #[inline(always)]
    fn numbers(&self) -> [f32; VALUES] {
        let [u, v, uu, uv, vv] = self.moments.numbers();
        let ([t0, t1, t2, t3], [f0, f1, f2, f3, f4]) = (self.third, self.fourth);
        [u, v, uu, uv, vv, t0, t1, t2, t3, f0, f1, f2, f3, f4]
    }

    #[inline(always)]
    fn of([u, v, uu, uv, vv, t0, t1, t2, t3, f0, f1, f2, f3, f4]: [f32; VALUES]) -> Self {
        Self { moments: Moments::of([u, v, uu, uv, vv]), third: [t0, t1, t2, t3], fourth: [f0, f1, f2, f3, f4] }
    }

    /// Merges exactly, for any weights, by expanding E[(d_i + e)^p]: d_i is the deviation within a part, and e the
    /// difference between the part's mean and the merged mean (P. Pebay, "Formulas for robust, one-pass parallel
    /// computation of covariances and arbitrary-order statistical moments", SAND2008-6212, 2008, section 3; here for
    /// two variables and weights that sum to 1).
    #[inline(always)]
    fn merged<F: Real, const MOST: usize>(weights: &[F], parts: &[[F; VALUES]]) -> [F; VALUES] {
        let zero = weights[0].splat_like(0.0);
        let (two, three, four, six) =
            (zero.splat_like(2.0), zero.splat_like(3.0), zero.splat_like(4.0), zero.splat_like(6.0));
        let mut sums = [zero; VALUES];
        for (w, part) in weights.iter().zip(parts) {
            (sums[0], sums[1]) = (sums[0] + *w * part[0], sums[1] + *w * part[1]);
        }
        for (w, &[u, v, kuu, kuv, kvv, t0, t1, t2, t3, f0, f1, f2, f3, f4]) in weights.iter().zip(parts) {
            let (u, v) = (u - sums[0], v - sums[1]);
            let (uu, uv, vv) = (u * u, u * v, v * v);
            let powers = [
                kuu + uu,
                kuv + uv,
                kvv + vv,
                t0 + (three * kuu + uu) * u,
                t1 + two * kuv * u + (kuu + uu) * v,
                t2 + two * kuv * v + (kvv + vv) * u,
                t3 + (three * kvv + vv) * v,
                f0 + four * t0 * u + (six * kuu + uu) * uu,
                f1 + three * t1 * u + t0 * v + three * kuv * uu + (three * kuu + uu) * uv,
                f2 + two * (t2 * u + t1 * v) + kuu * vv + kvv * uu + (four * kuv + uv) * uv,
                f3 + three * t2 * v + t3 * u + three * kuv * vv + (three * kvv + vv) * uv,
                f4 + four * t3 * v + (six * kvv + vv) * vv,
            ];
            for i in 0..powers.len() {
                sums[2 + i] = sums[2 + i] + *w * powers[i];
            }
        }
        sums
    }
}

/// Offsets read as [`ShapedMoments`].
pub struct Shaped<R>(pub R);

impl<R: TexelRows<Texel = Moments>> TexelRows for Shaped<R> {
    type Texel = ShapedMoments;

    fn width(&self) -> u32 {
        self.0.width()
    }

    fn height(&self) -> u32 {
        self.0.height()
    }

    fn row(&self, y: u32, out: &mut [ShapedMoments]) {
        let mut moments = vec![Moments::default(); out.len()];
        self.0.row(y, &mut moments);
        out.iter_mut().zip(moments).for_each(|(texel, m)| *texel = ShapedMoments::normal(m));
    }
}

#[cfg(test)]
mod tests;
