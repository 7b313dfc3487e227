//! Merging lobes: the GGX lobe under which half-vectors of several lobes are likeliest.
//!
//! Slopes of GGX half-vectors are a bivariate Student t with two degrees of freedom (scale A/2). Its likeliest
//! parameters come from EM with the weights 2 / (1 + q), q = s^T A^-1 s (K. Lange, R. Little, J. Taylor, "Robust
//! statistical modeling using the t distribution", 1989), here in the form that divides by the sum of the weights, which
//! converges faster (J. Kent, D. Tyler, Y. Vardi, "A curious likelihood identity for the multivariate t-distribution",
//! 1994). Unlike moments it has no tails to lose: one steep texel of many hardly moves the lobe.

use std::sync::LazyLock;

use fearless_simd::{Simd, prelude::*};

use super::SquaredAlpha;
use super::oriented::{LEAST_COSINE, OrientedLobe, dot, frame};
use crate::pyramid::{MAX_PARTS, Merge, load, store};
use crate::simd::{LANES, Real, Wide};
use crate::symmetric::Symmetric2;

/// Half-vectors that stand for a lobe: [`RADII`] by [`SPOKES`]. Two radii change the lobe error of `../shared/data` (half floats) by
/// up to 0.008.
const POINTS: usize = RADII.len() * SPOKES;
/// Directions of half-vectors. With three the lobe depends 2.5 times as much on the order of its parts.
const SPOKES: usize = 4;
/// Radii, in alphas, within which 1/6, 1/2 and 5/6 of a GGX lobe lie (r^2 = p / (1 - p)). Any such symmetric choice
/// gives back the lobe itself when it is merged alone.
const RADII: [f32; 3] = [0.447_213_6, 1.0, 2.236_068];
/// Sums are kept for every eighth point and then added, which rounds less than one sum does.
const SUMS: usize = 8;
/// EM steps by the parts as wholes, which cost a twelfth of one by their points and bring it near: without them three steps by
/// points end five times as far from where EM does.
const ROUGH_STEPS: usize = 3;
/// EM steps by the points. Lobes then differ from where EM ends by 0.0006 of their width on average on `../shared/data`, after
/// six plain steps without rough ones by 0.001.
const STEPS: usize = 3;
/// How far to go along an EM step. Where the points are a GGX lobe, one step leaves a third of what mean, width and
/// shape alike lack, so that 3/2 of it leaves nothing to first order: q has the density 1 / (1 + q)^2 and with
/// w = 1 / (1 + q), E[w] = 1/2, E[w^2 q] = 1/6 and E[w^2 q^2] = 1/3 what is left is E[w^2 q] / E[w] of the mean,
/// 2 (E[w^2 q^2] - E[w^2 q]) of the width and E[w^2 q^2] of the shape. Steps by whole parts gain by it as well (measured).
const STRIDE: f32 = 1.5;
/// Spread of the normals over the lobe, as squared slopes, below which widening is linear in it and its shape plays no
/// part: A + 2 K, within 1 % of A.
const SMOOTH: f32 = 0.01;

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

impl Merge for OrientedLobe {
    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        if parts.len() > MAX_PARTS {
            let total = |weights: &[f32]| weights.iter().sum::<f32>().max(f32::MIN_POSITIVE);
            let groups = weights.chunks(MAX_PARTS).zip(parts.chunks(MAX_PARTS));
            let merged: Vec<(f32, Self)> = groups
                .map(|(weights, parts)| {
                    let total = total(weights);
                    let shares: Vec<f32> = weights.iter().map(|w| w / total).collect();
                    (total, Self::merge(&shares, parts))
                })
                .collect();
            let (weights, parts): (Vec<f32>, Vec<Self>) = merged.into_iter().unzip();
            return Self::merge(&weights, &parts);
        }
        let mut values = [Parts::default(); MAX_PARTS];
        values.iter_mut().zip(parts).for_each(|(value, part)| *value = Parts::of(part.values()));
        Self::from_values(merged::<_, MAX_PARTS>(weights, &values[..parts.len()]).values())
    }

    #[inline(always)]
    fn merge_lanes<S: Simd, const MOST: usize>(
        simd: S,
        weights: &[[f32; LANES]],
        part: impl Fn(usize, usize) -> Self,
    ) -> [Self; LANES] {
        let zero = Wide::splat(simd, 0.0);
        let mut wide = [zero; MOST];
        let mut parts = [Parts::of([zero; 6]); MOST];
        let values = load::<S, MOST, 6>(simd, weights.len(), |tap, lane| part(tap, lane).values());
        for (tap, weights) in weights.iter().enumerate() {
            wide[tap] = Wide::simd_from(simd, *weights);
            parts[tap] = Parts::of(values[tap]);
        }
        let merged = store(merged::<_, MOST>(&wide[..weights.len()], &parts[..weights.len()]).values());
        let mut lobes = [Self::default(); LANES];
        for lane in 0..LANES {
            lobes[lane] = Self::from_values(merged[lane]);
        }
        lobes
    }
}

impl OrientedLobe {
    #[inline(always)]
    fn values(&self) -> [f32; 6] {
        let ([x, y, z], Symmetric2 { uu, uv, vv }) = (self.normal, self.squared_alpha.0);
        [x, y, z, uu, uv, vv]
    }

    #[inline(always)]
    fn from_values([x, y, z, uu, uv, vv]: [f32; 6]) -> Self {
        Self { normal: [x, y, z], squared_alpha: SquaredAlpha(Symmetric2::new(uu, uv, vv)) }
    }
}

/// Lobes, one in each lane.
#[derive(Clone, Copy, Default)]
struct Parts<F> {
    normal: [F; 3],
    a: Matrix<F>,
}

/// Symmetric matrices, one in each lane.
#[derive(Clone, Copy, Default)]
struct Matrix<F> {
    uu: F,
    uv: F,
    vv: F,
}

impl<F: Real> Matrix<F> {
    /// |A|.
    #[inline(always)]
    fn determinant(self) -> F {
        self.uu * self.vv - self.uv * self.uv
    }

    /// A^-1, with A made as wide at least as lobes are taken to be, and wider where it is long, so that rounding leaves it a
    /// determinant.
    #[inline(always)]
    fn inverse(self) -> Self {
        let zero = self.uu.like(0.0);
        let (one, least) = (zero.like(1.0), zero.like(MIN_SQUARED_ALPHA));
        let uu = self.uu.max(least);
        let vv = self.vv.max(self.uv * self.uv / uu + least * (one + self.vv));
        let scale = one / Self { uu, vv, ..self }.determinant();
        Self { uu: vv * scale, uv: zero - self.uv * scale, vv: uu * scale }
    }

    /// p^T A q.
    #[inline(always)]
    fn between(self, p: [F; 2], q: [F; 2]) -> F {
        p[0] * q[0] * self.uu + (p[0] * q[1] + p[1] * q[0]) * self.uv + p[1] * q[1] * self.vv
    }
}

impl<F: Real> Parts<F> {
    #[inline(always)]
    fn of([x, y, z, uu, uv, vv]: [F; 6]) -> Self {
        Self { normal: [x, y, z], a: Matrix { uu, uv, vv } }
    }

    #[inline(always)]
    fn values(self) -> [F; 6] {
        let ([x, y, z], Matrix { uu, uv, vv }) = (self.normal, self.a);
        [x, y, z, uu, uv, vv]
    }

    #[inline(always)]
    fn or(self, other: Self, mask: F::Mask) -> Self {
        let (mut values, other) = (self.values(), other.values());
        for i in 0..6 {
            values[i] = values[i].or(other[i], mask);
        }
        Self::of(values)
    }
}

/// The merged lobe in each lane; at least one and at most `MOST` parts.
#[inline(always)]
fn merged<F: Real, const MOST: usize>(weights: &[F], parts: &[Parts<F>]) -> Parts<F> {
    let zero = weights[0].like(0.0);
    let mut sum = [zero; 3];
    for (w, part) in weights.iter().zip(parts) {
        add(&mut sum, *w, part.normal);
    }
    let length = dot(sum, sum).sqrt();
    let about = frame([sum[0] / length, sum[1] / length, sum[2] / length]);
    let start = Start::<F, MOST>::of(weights, parts, about);
    let mut slopes = start.slopes;
    if !F::all(start.is_smooth) {
        let mut room = [[[zero; 3]; POINTS]; MOST];
        let points = half_vectors(&mut room, weights, parts, about);
        let likeliest = (0..STEPS).fold(start.roughly(weights, parts), |slopes, _| slopes.step(sums(points, slopes)));
        slopes = slopes.or(likeliest, start.is_smooth);
    }
    // Normals that cancel have no frame.
    parts[0].or(tilted(about, slopes), length.is_zero())
}

/// `sum` + `weight` * `vector`.
#[inline(always)]
fn add<F: Real>(sum: &mut [F; 3], weight: F, vector: [F; 3]) {
    for i in 0..3 {
        sum[i] = sum[i] + weight * vector[i];
    }
}

/// A lobe as slopes about some normal.
#[derive(Clone, Copy)]
struct Slopes<F> {
    mean: [F; 2],
    a: Matrix<F>,
}

impl<F: Real> Slopes<F> {
    #[inline(always)]
    fn or(self, other: Self, mask: F::Mask) -> Self {
        let mean = [self.mean[0].or(other.mean[0], mask), self.mean[1].or(other.mean[1], mask)];
        let (own, other) = (self.a, other.a);
        let a = Matrix { uu: own.uu.or(other.uu, mask), uv: own.uv.or(other.uv, mask), vv: own.vv.or(other.vv, mask) };
        Self { mean, a }
    }

    /// An EM step from here, given the sums of w, w x, w y, w x^2, w x y and w y^2 about the mean; [`STRIDE`] times as far
    /// where that leaves a tenth of the determinant, which 1 in 500 lobes of `../shared/data` would lose.
    #[inline(always)]
    fn step(self, [weight, x, y, xx, xy, yy]: [F; 6]) -> Self {
        let (share, two, stride) = (weight.like(1.0) / weight, weight.like(2.0), weight.like(STRIDE));
        let (dx, dy) = (x * share, y * share);
        let a = Matrix {
            uu: two * (xx * share - dx * dx),
            uv: two * (xy * share - dx * dy),
            vv: two * (yy * share - dy * dy),
        };
        let [u, v] = self.mean;
        let plain = Self { mean: [u + dx, v + dy], a };
        let along = |from: F, to: F| from + stride * (to - from);
        let far = Matrix { uu: along(self.a.uu, a.uu), uv: along(self.a.uv, a.uv), vv: along(self.a.vv, a.vv) };
        let least = weight.like(0.1) * a.determinant();
        let overshoots = far.determinant().at_most(least) | far.uu.at_most(weight.like(0.0));
        plain.or(Self { mean: [u + stride * dx, v + stride * dy], a: far }, overshoots)
    }
}

/// What moments tell: where EM starts, and where it need not start.
struct Start<F: Real, const MOST: usize> {
    /// Where the normals of the parts point.
    parts: [[F; 2]; MOST],
    slopes: Slopes<F>,
    is_smooth: F::Mask,
}

impl<F: Real, const MOST: usize> Start<F, MOST> {
    #[inline(always)]
    fn of(weights: &[F], parts: &[Parts<F>], [t, b, n]: [[F; 3]; 3]) -> Self {
        let zero = weights[0].like(0.0);
        let half = zero.like(0.5);
        let mut slopes = [[zero; 2]; MOST];
        let mut mean = [zero; 2];
        let (mut least, mut largest) = (zero.like(f32::INFINITY), zero);
        for ((w, part), slope) in weights.iter().zip(parts).zip(&mut slopes) {
            let z = dot(part.normal, n).max(zero.like(LEAST_COSINE));
            let (x, y) = (dot(part.normal, t) / z, dot(part.normal, b) / z);
            *slope = [x, y];
            mean = [mean[0] + *w * x, mean[1] + *w * y];
            // Eigenvalues, as `Symmetric2::eigen` has them.
            let Matrix { uu, uv, vv } = part.a;
            let (half_sum, half_difference) = (half * (uu + vv), half * (uu - vv));
            let radius = (half_difference * half_difference + uv * uv).sqrt();
            least = least.min((half_sum - radius).max(zero));
            largest = largest.max(half_sum + radius);
        }
        let (mut own, mut spread) = ([zero; 3], [zero; 3]);
        for ((w, part), [x, y]) in weights.iter().zip(parts).zip(slopes) {
            let (x, y) = (x - mean[0], y - mean[1]);
            add(&mut own, *w, [part.a.uu, part.a.uv, part.a.vv]);
            add(&mut spread, *w, [x * x, x * y, y * y]);
        }
        // Parts of unlike widths merge to one that fits both only through EM.
        let trace = spread[0] + spread[2];
        let alike = largest.at_most(zero.like(1.2) * least) | trace.is_zero();
        let is_smooth = trace.at_most(zero.like(SMOOTH) * least) & alike;
        // EM comes to the same lobe from wherever it starts, soonest from what a heavy-tailed spread would want.
        add(&mut own, zero.like(2.0).or(half, is_smooth), spread);
        let [uu, uv, vv] = own;
        Self { parts: slopes, slopes: Slopes { mean, a: Matrix { uu, uv, vv } }, is_smooth }
    }

    /// Near the likeliest lobe: EM with a point for each part, as far off as its centre and half its A are, which is
    /// E[w x x^T] / E[w] of a lobe.
    #[inline(always)]
    fn roughly(&self, weights: &[F], parts: &[Parts<F>]) -> Slopes<F> {
        let zero = weights[0].like(0.0);
        let (one, half) = (zero.like(1.0), zero.like(0.5));
        let mut slopes = self.slopes;
        for _ in 0..ROUGH_STEPS {
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
            slopes = slopes.step(sums);
        }
        slopes
    }
}

/// Slopes of the half-vectors of `parts` about the mean normal, each with twice its share, in `room`.
#[inline(always)]
fn half_vectors<'r, F: Real>(
    room: &'r mut [[[F; 3]; POINTS]],
    weights: &[F],
    parts: &[Parts<F>],
    about: [[F; 3]; 3],
) -> &'r [[F; 3]] {
    let zero = weights[0].like(0.0);
    let (one, least, least_cosine) = (zero.like(1.0), zero.like(MIN_SQUARED_ALPHA), zero.like(LEAST_COSINE));
    let patterns: &[[[f32; 2]; POINTS]; MAX_PARTS] = &PATTERNS;
    for (((w, part), pattern), points) in weights.iter().zip(parts).zip(patterns).zip(room.iter_mut()) {
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
        let share = *w / zero.like(POINTS as f32) * zero.like(2.0);
        for (&[cos, sin], point) in pattern.iter().zip(points) {
            let (cos, sin) = (zero.like(cos), zero.like(sin));
            let mut h = up;
            for i in 0..3 {
                h[i] = cos * along[i] + sin * across[i] + up[i];
            }
            let scale = one / h[2].max(least_cosine);
            *point = [h[0] * scale, h[1] * scale, share];
        }
    }
    room[..parts.len()].as_flattened()
}

/// Sums over `points` of w, w x, w y, w x^2, w x y and w y^2 about the mean, with w the EM weights.
#[inline(always)]
fn sums<F: Real>(points: &[[F; 3]], Slopes { mean, a }: Slopes<F>) -> [F; 6] {
    let zero = mean[0].like(0.0);
    let one = zero.like(1.0);
    let inverse = a.inverse();
    let twice_uv = inverse.uv + inverse.uv;
    let mut sums = [zero; 6];
    for first in 0..SUMS {
        let mut every = [zero; 6];
        for &[x, y, share] in points[first..].iter().step_by(SUMS) {
            let (x, y) = (x - mean[0], y - mean[1]);
            let q = x * (inverse.uu * x + twice_uv * y) + inverse.vv * y * y;
            let w = share / (one + q);
            let (wx, wy) = (w * x, w * y);
            let terms = [w, wx, wy, wx * x, wx * y, wy * y];
            for i in 0..6 {
                every[i] = every[i] + terms[i];
            }
        }
        for i in 0..6 {
            sums[i] = sums[i] + every[i];
        }
    }
    sums
}

/// Lobes are taken to be at least 0.001 wide: without width there is no density.
const MIN_SQUARED_ALPHA: f32 = 1e-6;

/// The lobe whose slopes about the frame's normal are `a` about `mean`, in the frame of its own normal. To first order in
/// the lobe's width: exact in its centre.
#[inline(always)]
fn tilted<F: Real>(about: [[F; 3]; 3], Slopes { mean, a }: Slopes<F>) -> Parts<F> {
    let [t, b, n] = about;
    let length = (mean[0].like(1.0) + mean[0] * mean[0] + mean[1] * mean[1]).sqrt();
    let mut normal = n;
    for i in 0..3 {
        normal[i] = n[i] + mean[0] * t[i] + mean[1] * b[i];
    }
    // Parts all around can make one that points below the surface.
    normal[2] = normal[2].max(length.like(LEAST_COSINE) * length);
    let long = dot(normal, normal).sqrt();
    let normal = [normal[0] / long, normal[1] / long, normal[2] / long];
    let [own_t, own_b, _] = frame(normal);
    // Derivatives of slopes about the new normal by slopes about the old one.
    let p = [dot(own_t, t) / length, dot(own_t, b) / length];
    let q = [dot(own_b, t) / length, dot(own_b, b) / length];
    let a = Matrix { uu: a.between(p, p), uv: a.between(p, q), vv: a.between(q, q) };
    Parts { normal, a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bump::Offset;
    use crate::judge::{Family, Footprint, Lobe, Part, Reference, oracle};

    fn lobe([u, v]: [f32; 2], a: [f32; 3]) -> OrientedLobe {
        OrientedLobe::new(Offset { u, v }, SquaredAlpha(Symmetric2::new(a[0], a[1], a[2])))
    }

    fn merge(parts: &[OrientedLobe]) -> OrientedLobe {
        OrientedLobe::merge(&vec![1.0 / parts.len() as f32; parts.len()], parts)
    }

    fn assert_alike(a: OrientedLobe, b: OrientedLobe, tolerance: f32) {
        let (x, y) = (a.squared_alpha.0, b.squared_alpha.0);
        let scale = y.trace();
        for (p, q) in [(x.uu, y.uu), (x.uv, y.uv), (x.vv, y.vv)] {
            assert!((p - q).abs() <= tolerance * scale, "{a:?} is not {b:?}");
        }
        let angle = a.normal.iter().zip(b.normal).map(|(p, q)| (p - q) * (p - q)).sum::<f32>().sqrt();
        assert!(angle <= tolerance * scale.sqrt(), "{a:?} is not {b:?}");
    }

    /// Slopes of three scales about a tilted mean: what EM has to fit.
    fn rough_parts() -> Vec<OrientedLobe> {
        [[0.0, 0.1], [0.3, 0.0], [-0.2, 0.4], [0.9, -0.5]].map(|o| lobe(o, [0.01, 0.002, 0.02])).to_vec()
    }

    #[test]
    fn equal_lobes_merge_to_themselves() {
        for part in [lobe([0.0, 0.0], [0.04, 0.0, 0.04]), lobe([0.8, -1.5], [0.09, 0.02, 0.01])] {
            assert_alike(merge(&[part; 4]), part, 1e-5);
            assert_alike(merge(&[part; 25]), part, 1e-5);
        }
        // EM itself, without the short cut for smooth parts.
        let part = lobe([0.5, 0.2], [0.09, 0.02, 0.04]);
        let about = frame(part.normal);
        let wide = Slopes { mean: [0.0; 2], a: Matrix { uu: 0.2, uv: 0.0, vv: 0.2 } };
        let mut room = [[[0.0; 3]; POINTS]; 4];
        let points = half_vectors(&mut room, &[0.25; 4], &[Parts::of(part.values()); 4], about);
        let slopes = (0..STEPS).fold(wide, |slopes, _| slopes.step(sums(points, slopes)));
        assert_alike(OrientedLobe::from_values(tilted(about, slopes).values()), part, 0.01);
    }

    /// Forty more steps hardly move the lobe.
    #[test]
    fn the_steps_suffice() {
        let shares = [0.25; 4];
        let number = |seed: u32| {
            (seed.wrapping_mul(0x9e37_79b9) ^ (seed >> 3)).wrapping_mul(0x85eb_ca6b) as f32 / 4_294_967_808.0 - 0.5
        };
        let (mut sum, mut without, mut fewer) = (0.0, 0.0, 0.0);
        for seed in 0..400 {
            let parts = [0, 1, 2, 3].map(|i| lobe([0, 1].map(|j| number(8 * seed + 2 * i + j)), [0.04, 0.01, 0.02]));
            let parts = parts.map(|part| Parts::of(part.values()));
            let about = frame([0.0, 0.0, 1.0]);
            let mut room = [[[0.0; 3]; POINTS]; 4];
            let points = half_vectors(&mut room, &shares, &parts, about);
            let after = |steps, from| (0..steps).fold(from, |slopes: Slopes<f32>, _| slopes.step(sums(points, slopes)));
            let start = Start::<_, 4>::of(&shares, &parts, about);
            let rough = start.roughly(&shares, &parts);
            let end = after(40, rough);
            let trace = end.a.uu + end.a.vv;
            let apart = |lobe: Slopes<f32>| {
                let [u, v] = [lobe.mean[0] - end.mean[0], lobe.mean[1] - end.mean[1]];
                let [uu, uv, vv] = [lobe.a.uu - end.a.uu, lobe.a.uv - end.a.uv, lobe.a.vv - end.a.vv];
                ((u * u + v * v) / trace).sqrt() + (uu * uu + uv * uv + vv * vv).sqrt() / trace
            };
            sum += apart(after(STEPS, rough)) / 400.0;
            without += apart(after(STEPS, start.slopes)) / 400.0;
            fewer += apart(after(STEPS - 1, rough)) / 400.0;
        }
        assert!(sum < 0.003, "{sum}");
        // Neither kind of step is there for nothing.
        assert!(without.min(fewer) > 2.0 * sum, "{sum}, without rough steps {without}, with a fine one less {fewer}");
    }

    /// Bumps far smaller than the lobe add their covariance, twice.
    #[test]
    fn small_bumps_add_their_covariance() {
        let parts = [[0.01, 0.0], [-0.01, 0.0], [0.0, 0.005], [0.0, -0.005]].map(|o| lobe(o, [0.04, 0.0, 0.04]));
        let merged = merge(&parts);
        assert_alike(merged, lobe([0.0; 2], [0.0401, 0.0, 0.040_025]), 1e-4);
    }

    /// The merged lobe is hardly worse than the best one that a numerical search finds.
    #[test]
    fn merged_lobes_are_near_the_oracle() {
        let two_peaks = [[0.4, 0.0], [-0.4, 0.0]].map(|o| lobe(o, [0.01, 0.0, 0.01])).to_vec();
        for parts in [rough_parts(), two_peaks] {
            let f64s = |lobe: &OrientedLobe| {
                let a = lobe.squared_alpha.0;
                (lobe.normal.map(f64::from), [a.uu, a.uv, a.vv].map(f64::from))
            };
            let part = |lobe: &OrientedLobe| Part { weight: 1.0, normal: f64s(lobe).0, base: f64s(lobe).1 };
            let footprint = Footprint::new(parts.iter().map(part).collect()).unwrap();
            let reference = Reference::new(Family::Ggx, &footprint, 2048);
            let (normal, a) = f64s(&merge(&parts));
            let ours = Lobe::new(Family::Ggx, normal, a);
            let (_, best) = oracle(&reference, &[ours]);
            let error = reference.error(&ours);
            assert!(error <= 1.15 * best + 0.01, "{error} where {best} is possible");
        }
    }

    /// Moments would make the lobe 49 times as wide in square; likelihood, four times.
    #[test]
    fn one_steep_texel_hardly_moves_the_lobe() {
        let flat = lobe([0.0, 0.0], [0.02, 0.0, 0.02]);
        let mut parts = vec![flat; 9];
        parts[4] = lobe([2.0, 1.0], [0.02, 0.0, 0.02]);
        let merged = merge(&parts);
        let offset = merged.offset();
        assert!(merged.squared_alpha.0.trace() < 5.0 * flat.squared_alpha.0.trace(), "{merged:?}");
        assert!(offset.u.abs() < 0.1 && offset.v.abs() < 0.1, "{merged:?}");
    }

    /// Mirroring the parts mirrors the lobe; so does turning them by a right angle.
    #[test]
    fn merging_is_symmetric() {
        let parts = rough_parts();
        let merged = merge(&parts);
        type Map = fn(OrientedLobe) -> OrientedLobe;
        let maps: [Map; 2] = [
            |l| {
                let ([x, y, z], a) = (l.normal, l.squared_alpha.0);
                OrientedLobe { normal: [-x, y, z], squared_alpha: SquaredAlpha(Symmetric2::new(a.uu, -a.uv, a.vv)) }
            },
            |l| {
                let Offset { u, v } = l.offset();
                // The frames of a normal and of the turned one are not turned alike: go by slopes about N.
                let [[t0, t1, _], [b0, b1, _], _] = frame(l.normal);
                let n = OrientedLobe::new(Offset { u: -v, v: u }, SquaredAlpha::default()).normal;
                let [own_t, own_b, _] = frame(n);
                let turned = |x: f32, y: f32| [-y, x];
                let (t, b) = (turned(t0, t1), turned(b0, b1));
                let along =
                    |axis: [f32; 3], with: [f32; 2], z: f32| axis[0] * with[0] + axis[1] * with[1] + axis[2] * z;
                let (tz, bz) = (frame(l.normal)[0][2], frame(l.normal)[1][2]);
                let j = [own_t, own_b].map(|axis| [along(axis, t, tz), along(axis, b, bz)]);
                let a = l.squared_alpha.0;
                let form = |p: [f32; 2], q: [f32; 2]| {
                    p[0] * q[0] * a.uu + (p[0] * q[1] + p[1] * q[0]) * a.uv + p[1] * q[1] * a.vv
                };
                let turned_a = Symmetric2::new(form(j[0], j[0]), form(j[0], j[1]), form(j[1], j[1]));
                OrientedLobe { normal: n, squared_alpha: SquaredAlpha(turned_a) }
            },
        ];
        for map in maps {
            let image = merge(&parts.iter().map(|p| map(*p)).collect::<Vec<_>>());
            // The points that stand for a lobe are not symmetric themselves.
            assert_alike(image, map(merged), 0.05);
        }
    }

    /// The order of the parts changes only which points stand for which.
    #[test]
    fn order_hardly_matters() {
        let mut parts = rough_parts();
        let merged = merge(&parts);
        parts.reverse();
        assert_alike(merge(&parts), merged, 0.05);
    }

    #[test]
    fn degenerate_parts_merge_to_finite_lobes() {
        for parts in [
            vec![lobe([0.0; 2], [0.0; 3]); 4],
            vec![lobe([16.0, 0.0], [0.0; 3]), lobe([-16.0, 0.0], [1.0, 0.0, 1.0])],
            vec![lobe([0.0, 11.0], [1.0, 1.0, 1.0]), lobe([0.0, 0.0], [1e-12, 0.0, 1e-12])],
            vec![OrientedLobe::default(); 3],
            vec![
                lobe([13.98, -7.781], [0.0622, -0.0886, 0.9916]),
                lobe([15.81, 2.442], [0.452, 0.4977, 0.548]),
                lobe([-15.54, -3.818], [0.0084, -0.0913, 0.9916]),
                lobe([-10.1, -12.41], [1.0, 0.0, 1.0]),
            ],
        ] {
            let merged = merge(&parts);
            let a = merged.squared_alpha.0;
            assert!(merged.normal[2] >= 0.0, "{merged:?}");
            assert!(merged.normal.iter().chain(&[a.uu, a.uv, a.vv]).all(|x| x.is_finite()), "{merged:?}");
            assert!(a.uu >= 0.0 && a.vv >= 0.0 && a.uu * a.vv - a.uv * a.uv >= -1e-6 * a.trace() * a.trace());
        }
    }
}
