//! EM by points: half-vectors that stand for the parts, and the sums over them that a step needs.

use std::sync::LazyLock;

use super::Part;
use super::slopes::{MIN_SQUARED_ALPHA, Matrix, Slopes};
use crate::lobe::oriented::{LEAST_COSINE, dot, frame};
use crate::pyramid::MAX_PARTS;
use crate::simd::Real;

/// Half-vectors that stand for a lobe: [`RADII`] by [`SPOKES`]. Two radii change the lobe error of `../shared/data` (half floats) by
/// up to 0.008.
pub const POINTS: usize = RADII.len() * SPOKES;
/// Directions of half-vectors. With three the lobe depends 2.5 times as much on the order of its parts.
const SPOKES: usize = 4;
/// Radii, in alphas, within which 1/6, 1/2 and 5/6 of a GGX lobe lie (r^2 = p / (1 - p)). Any such symmetric choice
/// gives back the lobe itself when it is merged alone.
const RADII: [f32; 3] = [0.447_213_6, 1.0, 2.236_068];

/// Unit directions times radii, turned a little from part to part so that no direction is preferred.
static PATTERNS: LazyLock<[[[f32; 2]; POINTS]; MAX_PARTS]> = LazyLock::new(|| {
    std::array::from_fn(|part| {
        std::array::from_fn(|point| {
            let (ring, spoke) = (point / SPOKES, point % SPOKES);
            // Rings are turned against each other by half a spoke, parts by the golden ratio.
            let turn = (spoke as f64 + 0.5 * ring as f64 + 0.381_966_011 * part as f64) / SPOKES as f64;
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
            [(f64::from(RADII[ring]) * cos) as f32, (f64::from(RADII[ring]) * sin) as f32]
        })
    })
});

/// Slopes of the half-vectors of each of `parts` about the mean normal, in `room`.
#[inline(always)]
pub fn half_vectors<'r, F: Real>(
    room: &'r mut [[[F; 2]; POINTS]],
    parts: &[Part<F>],
    about: [[F; 3]; 3],
) -> &'r [[[F; 2]; POINTS]] {
    let zero = parts[0].a.uu.like(0.0);
    let (one, least, least_cosine) = (zero.like(1.0), zero.like(MIN_SQUARED_ALPHA), zero.like(LEAST_COSINE));
    let patterns: &[[[f32; 2]; POINTS]; MAX_PARTS] = &PATTERNS;
    for ((part, pattern), points) in parts.iter().zip(patterns).zip(room.iter_mut()) {
        // The part's axes, scaled by its lobe (A = L L^T, L lower triangular), in the common frame.
        let [t, b, n] = frame(part.normal);
        let Matrix { uu, uv, vv } = part.a;
        let l11 = uu.max(least).sqrt();
        let l21 = uv / l11;
        let l22 = (vv - l21 * l21).max(least).sqrt();
        let (mut along, mut across, mut up) = ([zero; 3], [zero; 3], [zero; 3]);
        for i in 0..3 {
            let across_i = dot(b, about[i]);
            along[i] = l11 * dot(t, about[i]) + l21 * across_i;
            across[i] = l22 * across_i;
            up[i] = dot(n, about[i]);
        }
        for (&[cos, sin], point) in pattern.iter().zip(points) {
            let (cos, sin) = (zero.like(cos), zero.like(sin));
            let mut h = up;
            for i in 0..3 {
                h[i] = cos * along[i] + sin * across[i] + up[i];
            }
            let scale = one / h[2].max(least_cosine);
            *point = [h[0] * scale, h[1] * scale];
        }
    }
    &room[..parts.len()]
}

/// Sums over `points`, those of a part having its weight, of w, w x, w y, w x^2, w x y and w y^2 about the mean, with w the EM
/// weights.
#[inline(always)]
pub fn sums<F: Real>(weights: &[F], points: &[[[F; 2]; POINTS]], Slopes { mean, a }: Slopes<F>) -> [F; 6] {
    let zero = mean[0].like(0.0);
    let (one, twice_share) = (zero.like(1.0), zero.like(2.0 / POINTS as f32));
    let inverse = a.inverse();
    let twice_uv = inverse.uv + inverse.uv;
    let mut sums = [zero; 6];
    for (weight, points) in weights.iter().zip(points) {
        let mut own = [zero; 6];
        for &[x, y] in points {
            let (x, y) = (x - mean[0], y - mean[1]);
            let q = x * (inverse.uu * x + twice_uv * y) + inverse.vv * y * y;
            let w = one / (one + q);
            let (wx, wy) = (w * x, w * y);
            let terms = [w, wx, wy, wx * x, wx * y, wy * y];
            for i in 0..6 {
                own[i] = own[i] + terms[i];
            }
        }
        let share = *weight * twice_share;
        for i in 0..6 {
            sums[i] = sums[i] + share * own[i];
        }
    }
    sums
}
