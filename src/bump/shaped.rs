//! Third and fourth moments: what tells a heavy-tailed or lopsided distribution of offsets from a normal one.

use crate::bump::Moments;
use crate::math::symmetric::Symmetric2;
use crate::mip::{Merge, Rows};
use crate::simd::Real;

/// Mean, covariance and the third and fourth central moments of the offsets in the area of one texel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapedMoments {
    /// Mean and covariance.
    pub moments: Moments,
    /// E of d_u^3, d_u^2 d_v, d_u d_v^2, d_v^3, with d the offset less its mean.
    pub third: [f32; 4],
    /// E of d_u^4, d_u^3 d_v, d_u^2 d_v^2, d_u d_v^3, d_v^4.
    pub fourth: [f32; 5],
}

impl ShapedMoments {
    /// The moments of a normal distribution: no third ones, and fourth ones by Isserlis' theorem.
    pub fn normal(moments: Moments) -> Self {
        let Symmetric2 { uu, uv, vv } = moments.covariance;
        let fourth = [3.0 * uu * uu, 3.0 * uu * uv, uu * vv + 2.0 * uv * uv, 3.0 * uv * vv, 3.0 * vv * vv];
        Self { moments, third: [0.0; 4], fourth }
    }
}

/// Numbers of a texel: mean, covariance, third and fourth moments.
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

    /// Exact for any weights: E[(d_i + e)^p] expanded, with d_i central in its part and e from the whole's mean to the
    /// part's (P. Pebay, "Formulas for robust, one-pass parallel computation of covariances and arbitrary-order
    /// statistical moments", SAND2008-6212, 2008, section 3; here for two variables and weights that sum to 1).
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

impl<R: Rows<Texel = Moments>> Rows for Shaped<R> {
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
mod tests {
    use super::*;
    use crate::bump::Offset;
    use proptest::prelude::*;

    /// Sum of w d_u^p d_v^q over points, in f64.
    fn central(points: &[([f64; 2], f64)], p: i32, q: i32) -> f64 {
        let mean = |i: usize| points.iter().map(|(x, w)| w * x[i]).sum::<f64>();
        let (u, v) = (mean(0), mean(1));
        points.iter().map(|(x, w)| w * (x[0] - u).powi(p) * (x[1] - v).powi(q)).sum()
    }

    proptest! {
        /// Merging in two steps gives the moments of all the points, computed directly in f64.
        #[test]
        fn merges_are_exact(points in prop::collection::vec((-2.0f32..2.0, -2.0f32..2.0), 9), split in 1usize..8) {
            let flat = |(u, v): (f32, f32)| ShapedMoments::normal(Moments::flat(Offset { u, v }));
            let of = |points: &[(f32, f32)]| {
                let weights = vec![1.0 / points.len() as f32; points.len()];
                ShapedMoments::merge(&weights, &points.iter().map(|p| flat(*p)).collect::<Vec<_>>())
            };
            let share = split as f32 / 9.0;
            let merged = ShapedMoments::merge(&[share, 1.0 - share], &[of(&points[..split]), of(&points[split..])]);
            let all: Vec<_> = points.iter().map(|(u, v)| ([f64::from(*u), f64::from(*v)], 1.0 / 9.0)).collect();
            for (i, third) in merged.third.into_iter().enumerate() {
                let expected = central(&all, 3 - i as i32, i as i32);
                prop_assert!((f64::from(third) - expected).abs() < 1e-4, "third {}: {} for {}", i, third, expected);
            }
            for (i, fourth) in merged.fourth.into_iter().enumerate() {
                let expected = central(&all, 4 - i as i32, i as i32);
                prop_assert!((f64::from(fourth) - expected).abs() < 3e-4, "fourth {}: {} for {}", i, fourth, expected);
            }
        }
    }

    /// Two normal distributions with one mean and covariance merge to themselves.
    #[test]
    fn normal_parts_stay_normal() {
        let m = ShapedMoments::normal(Moments { mean: Offset::default(), covariance: Symmetric2::new(2.0, 0.5, 1.0) });
        assert_eq!(ShapedMoments::merge(&[0.25, 0.75], &[m, m]), m);
    }
}
