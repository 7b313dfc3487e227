//! Merging lobes: the GGX lobe under which half-vectors of several lobes are likeliest.
//!
//! Slopes of GGX half-vectors are a bivariate Student t with two degrees of freedom (scale A/2). Its likeliest
//! parameters come from EM with the weights 2 / (1 + q), q = s^T A^-1 s (K. Lange, R. Little, J. Taylor, "Robust
//! statistical modeling using the t distribution", 1989), here in the form that divides by the sum of the weights, which
//! converges faster (J. Kent, D. Tyler, Y. Vardi, "A curious likelihood identity for the multivariate t-distribution",
//! 1994). Unlike moments it has no tails to lose: one steep texel of many hardly moves the lobe.

mod part;
mod points;
mod slopes;
mod start;

use part::{Part, add};
use points::{POINTS, half_vectors, sums};
use slopes::{Matrix, Slopes};
use start::Start;

use super::SquaredAlpha;
use super::oriented::{LEAST_COSINE, OrientedLobe, dot, frame};
use crate::math::symmetric::Symmetric2;
use crate::mip::{MAX_PARTS, Merge};
use crate::simd::Real;

/// EM steps by the parts as wholes: before the first of the two by their points, and between these. Each has a twelfth of the
/// arithmetic of one by the points, though more than that of its time: all of it waits for the step before.
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

/// The merged lobe of at least one and at most `MOST` parts.
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
        let mut room = [[[zero; 2]; POINTS]; MOST];
        let points = half_vectors(&mut room, parts, about);
        let likeliest = likeliest(&start, weights, parts, points, WHOLE_STEPS);
        slopes = slopes.select(likeliest, start.is_smooth);
    }
    // Normals that cancel have no frame.
    parts[0].select(tilted(about, slopes), length.is_zero())
}

/// The lobe where EM ends, with [`WHOLE_STEPS`] to within 0.003 of the width of rough lobes (test `the_steps_suffice`).
///
/// Two steps by the points go as far as four without the steps by the parts as wholes: those before start near the end, and
/// those between go on with what they lacked when the first by the points was taken (defect correction: K. Böhmer, P. Hemker,
/// H. Stetter, "The defect correction approach", 1984).
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

/// The lobe whose slopes about the frame's normal are `a` about `mean`, in the frame of its own normal. To first order in
/// the lobe's width: exact in its centre.
#[inline(always)]
fn tilted<F: Real>(about: [[F; 3]; 3], Slopes { mean, a }: Slopes<F>) -> Part<F> {
    let [t, b, n] = about;
    let length = (mean[0].splat_like(1.0) + mean[0] * mean[0] + mean[1] * mean[1]).sqrt();
    let mut normal = n;
    for i in 0..3 {
        normal[i] = n[i] + mean[0] * t[i] + mean[1] * b[i];
    }
    // Parts all around can make one that points below the surface.
    normal[2] = normal[2].max(length.splat_like(LEAST_COSINE) * length);
    let long = dot(normal, normal).sqrt();
    let normal = [normal[0] / long, normal[1] / long, normal[2] / long];
    let [own_t, own_b, _] = frame(normal);
    // Derivatives of slopes about the new normal by slopes about the old one.
    let p = [dot(own_t, t) / length, dot(own_t, b) / length];
    let q = [dot(own_b, t) / length, dot(own_b, b) / length];
    let a = Matrix { uu: a.between(p, p), uv: a.between(p, q), vv: a.between(q, q) };
    Part { normal, a }
}

#[cfg(test)]
mod tests;
