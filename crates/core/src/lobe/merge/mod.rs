//! Merges lobes by maximum likelihood: the GGX lobe under which half-vectors of several lobes are likeliest.
//!
//! Slopes of GGX half-vectors follow a bivariate Student t distribution with two degrees of freedom (scale A/2). EM
//! with the weights 2 / (1 + q), q = s^T A^-1 s, finds its likeliest parameters (K. Lange, R. Little, J. Taylor,
//! "Robust statistical modeling using the t distribution", 1989). The form used here divides by the sum of the weights,
//! which converges faster (J. Kent, D. Tyler, Y. Vardi, "A curious likelihood identity for the multivariate
//! t-distribution", 1994). Unlike moments, likelihood is robust: one steep texel among many hardly changes the lobe.

mod part;
mod points;
mod slopes;
mod start;

use part::{Part, add};
use points::{POINTS, half_vectors, sums};
use slopes::{Matrix, Slopes};
use start::Start;

use super::SquaredAlpha;
use super::oriented::{LEAST_COSINE, OrientedLobe, frame};
use crate::math::symmetric::Symmetric2;
use crate::math::vector::dot;
use crate::mip::{MAX_PARTS, Merge};
use crate::simd::Real;

/// Numbers of rough EM steps, with one point for each part: before the first of the two EM steps by half-vectors, and
/// between these two. A rough step has a twelfth of the arithmetic of a step by half-vectors, but takes more than a
/// twelfth of its time, because all its arithmetic waits for the step before.
const WHOLE_STEPS: [usize; 2] = [2, 2];

impl Merge for OrientedLobe {
    type Numbers<F: Copy> = [F; 6];

    #[inline(always)]
    fn numbers(&self) -> [f32; 6] {
        let ([x, y, z], Symmetric2 { uu, uv, vv }) = (self.normal, self.squared_alpha.0);
        [x, y, z, uu, uv, vv]
    }

    #[inline(always)]
    fn of([x, y, z, uu, uv, vv]: [f32; 6]) -> Self {
        Self { normal: [x, y, z], squared_alpha: SquaredAlpha(Symmetric2::new(uu, uv, vv)) }
    }

    #[inline(always)]
    fn merged<F: Real, const MOST: usize>(weights: &[F], parts: &[[F; 6]]) -> [F; 6] {
        let mut lobes = [Part::of([weights[0].splat_like(0.0); 6]); MOST];
        lobes.iter_mut().zip(parts).for_each(|(lobe, part)| *lobe = Part::of(*part));
        merged::<_, MOST>(weights, &lobes[..parts.len()]).numbers()
    }

    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        if parts.len() <= MAX_PARTS {
            let mut numbers = [[0.0; 6]; MAX_PARTS];
            numbers.iter_mut().zip(parts).for_each(|(numbers, part)| *numbers = part.numbers());
            return Self::of(Self::merged::<_, MAX_PARTS>(weights, &numbers[..parts.len()]));
        }
        let groups = weights.chunks(MAX_PARTS).zip(parts.chunks(MAX_PARTS));
        let (weights, parts): (Vec<f32>, Vec<Self>) = groups
            .map(|(weights, parts)| {
                let total = weights.iter().sum::<f32>().max(f32::MIN_POSITIVE);
                let shares: Vec<f32> = weights.iter().map(|w| w / total).collect();
                (total, Self::merge(&shares, parts))
            })
            .unzip();
        Self::merge(&weights, &parts)
    }
}

/// Merges at least one and at most `MOST` parts.
#[inline(always)]
fn merged<F: Real, const MOST: usize>(weights: &[F], parts: &[Part<F>]) -> Part<F> {
    let zero = weights[0].splat_like(0.0);
    let mut sum = [zero; 3];
    for (w, part) in weights.iter().zip(parts) {
        add(&mut sum, *w, part.normal);
    }
    let length = dot(sum, sum).sqrt();
    let about = frame([sum[0] / length, sum[1] / length, sum[2] / length]);
    let start = Start::<F, MOST>::of(weights, parts, about);
    let mut slopes = start.slopes;
    if !F::all(start.is_smooth) {
        let mut memory = [[[zero; 2]; POINTS]; MOST];
        let points = half_vectors(&mut memory, parts, about);
        let likeliest = likeliest(&start, weights, parts, points, WHOLE_STEPS);
        slopes = slopes.select(likeliest, start.is_smooth);
    }
    // If the normals cancel, there is no mean normal, and the first part is returned.
    parts[0].select(tilted(about, slopes), length.is_zero())
}

/// Returns the likeliest lobe by EM. With [`WHOLE_STEPS`], its error is at most 0.003 of the width of rough lobes (test
/// `the_steps_suffice`).
///
/// Two steps by half-vectors with rough steps converge as far as four steps without. The rough steps before the first
/// one start near the result. The rough steps between the two are corrected by the difference between the first step by
/// half-vectors and a rough step from the same lobe (defect correction: K. Böhmer, P. Hemker, H. Stetter, "The defect
/// correction approach", 1984).
#[inline(always)]
fn likeliest<F: Real, const MOST: usize>(
    start: &Start<F, MOST>,
    weights: &[F],
    parts: &[Part<F>],
    points: &[[[F; 2]; POINTS]],
    [before, between]: [usize; 2],
) -> Slopes<F> {
    let mut slopes = start.slopes;
    for _ in 0..before {
        let next = start.roughly_next(slopes, weights, parts);
        slopes = slopes.step(next, next);
    }
    let (rough, next) = (start.roughly_next(slopes, weights, parts), slopes.next(sums(weights, points, slopes)));
    slopes = slopes.step(next, next);
    for _ in 0..between {
        let corrected = start.roughly_next(slopes, weights, parts).moved(rough, next);
        slopes = slopes.step(corrected, slopes);
    }
    let next = slopes.next(sums(weights, points, slopes));
    slopes.step(next, next)
}

/// Converts a lobe of slopes in the frame `about` to a lobe in the frame of its own normal. The conversion is exact in
/// the centre of the lobe, and of first order in its width.
#[inline(always)]
fn tilted<F: Real>(about: [[F; 3]; 3], Slopes { mean, a }: Slopes<F>) -> Part<F> {
    let [t, b, n] = about;
    let length = (mean[0].splat_like(1.0) + mean[0] * mean[0] + mean[1] * mean[1]).sqrt();
    let mut normal = n;
    for i in 0..3 {
        normal[i] = n[i] + mean[0] * t[i] + mean[1] * b[i];
    }
    // Parts in all directions can merge to a normal that points below the surface.
    normal[2] = normal[2].max(length.splat_like(LEAST_COSINE) * length);
    let long = dot(normal, normal).sqrt();
    let normal = [normal[0] / long, normal[1] / long, normal[2] / long];
    let [own_t, own_b, _] = frame(normal);
    // Derivatives of slopes about the new normal with respect to slopes about the old normal.
    let p = [dot(own_t, t) / length, dot(own_t, b) / length];
    let q = [dot(own_b, t) / length, dot(own_b, b) / length];
    let a = Matrix { uu: a.between(p, p), uv: a.between(p, q), vv: a.between(q, q) };
    Part { normal, a }
}

#[cfg(test)]
mod tests;
