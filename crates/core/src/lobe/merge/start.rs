//! The start of EM: an initial lobe from moments, and rough EM steps with one point for each part.

use super::part::{Part, add};
use super::slopes::{Matrix, Slopes};
use crate::lobe::oriented::LEAST_COSINE;
use crate::math::symmetric::MohrCircle;
use crate::math::vector::dot;
use crate::simd::Real;

/// Ratio of the covariance of the normals to the squared alpha, below which the merged lobe is A + 2 K within 1 % of A,
/// whatever the shape of the distribution.
const SMOOTH: f32 = 0.01;

/// The initial lobe of EM, and a mask of the lanes in which this lobe is already the result.
pub struct Start<F: Real, const MOST: usize> {
    /// Slopes of the normals of the parts.
    parts: [[F; 2]; MOST],
    pub slopes: Slopes<F>,
    pub is_smooth: F::Mask,
}

impl<F: Real, const MOST: usize> Start<F, MOST> {
    #[inline(always)]
    pub fn of(weights: &[F], parts: &[Part<F>], [t, b, n]: [[F; 3]; 3]) -> Self {
        let zero = weights[0].splat_like(0.0);
        let half = zero.splat_like(0.5);
        let mut slopes = [[zero; 2]; MOST];
        let mut mean = [zero; 2];
        let (mut least, mut largest) = (zero.splat_like(f32::INFINITY), zero);
        for ((w, part), slope) in weights.iter().zip(parts).zip(&mut slopes) {
            let z = dot(part.normal, n).max(zero.splat_like(LEAST_COSINE));
            let (x, y) = (dot(part.normal, t) / z, dot(part.normal, b) / z);
            *slope = [x, y];
            mean = [mean[0] + *w * x, mean[1] + *w * y];
            let Matrix { uu, uv, vv } = part.a;
            let [major, minor] = MohrCircle::new([uu, uv, vv]).eigenvalues();
            least = least.min(minor.max(zero));
            largest = largest.max(major);
        }
        let (mut own, mut spread) = ([zero; 3], [zero; 3]);
        for ((w, part), [x, y]) in weights.iter().zip(parts).zip(slopes) {
            let (x, y) = (x - mean[0], y - mean[1]);
            add(&mut own, *w, [part.a.uu, part.a.uv, part.a.vv]);
            add(&mut spread, *w, [x * x, x * y, y * y]);
        }
        // Parts of different widths need EM.
        let trace = spread[0] + spread[2];
        let alike = largest.lanes_le(zero.splat_like(1.2) * least) | trace.is_zero();
        let is_smooth = trace.lanes_le(zero.splat_like(SMOOTH) * least) & alike;
        // EM converges to the same lobe from any start. It converges fastest from A + K / 2, which suits heavy tails.
        add(&mut own, zero.splat_like(2.0).select(half, is_smooth), spread);
        let [uu, uv, vv] = own;
        Self { parts: slopes, slopes: Slopes { mean, a: Matrix { uu, uv, vv } }, is_smooth }
    }

    /// Returns the next lobe of EM after `slopes`, with one point for each part. The squared distance of the point is
    /// that of the part's centre plus half of its A, which is E[w x x^T] / E[w] of a lobe.
    #[inline(always)]
    pub fn roughly_next(&self, slopes: Slopes<F>, weights: &[F], parts: &[Part<F>]) -> Slopes<F> {
        let zero = weights[0].splat_like(0.0);
        let (one, half) = (zero.splat_like(1.0), zero.splat_like(0.5));
        let (inverse, mut sums) = (slopes.a.inverse(), [zero; 6]);
        for ((weight, part), [x, y]) in weights.iter().zip(parts).zip(self.parts) {
            let (x, y) = (x - slopes.mean[0], y - slopes.mean[1]);
            let (xx, xy, yy) = (x * x + half * part.a.uu, x * y + half * part.a.uv, y * y + half * part.a.vv);
            let q = inverse.uu * xx + (inverse.uv + inverse.uv) * xy + inverse.vv * yy;
            let w = *weight / (one + q);
            let terms = [w, w * x, w * y, w * xx, w * xy, w * yy];
            for i in 0..6 {
                sums[i] = sums[i] + terms[i];
            }
        }
        slopes.next(sums)
    }
}
