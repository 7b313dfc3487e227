//! Merging lobes: the GGX lobe under which half-vectors of several lobes are likeliest.
//!
//! Slopes of GGX half-vectors are a bivariate Student t with two degrees of freedom (scale A/2). Its likeliest
//! parameters come from EM with the weights 2 / (1 + q), q = s^T A^-1 s (K. Lange, R. Little, J. Taylor, "Robust
//! statistical modeling using the t distribution", 1989), here in the form that divides by the sum of the weights, which
//! converges faster (J. Kent, D. Tyler, Y. Vardi, "A curious likelihood identity for the multivariate t-distribution",
//! 1994). Unlike moments it has no tails to lose: one steep texel of many hardly moves the lobe.

use std::sync::LazyLock;

use super::SquaredAlpha;
use super::oriented::{LEAST_COSINE, OrientedLobe, dot, frame};
use crate::pyramid::Merge;
use crate::symmetric::Symmetric2;

/// Half-vectors that stand for a lobe: [`RADII`] by 4 directions.
const POINTS: usize = 12;
/// Radii, in alphas, within which 1/6, 1/2 and 5/6 of a GGX lobe lie (r^2 = p / (1 - p)). Any such symmetric choice
/// gives back the lobe itself when it is merged alone.
const RADII: [f32; 3] = [0.447_213_6, 1.0, 2.236_068];
/// Lobes merged at once: 3 x 3 under a texel of an odd level.
const PARTS: usize = 9;
/// Sums are kept for this many points side by side, whatever the machine's vectors hold: the same bits everywhere.
const LANES: usize = 8;
/// Points of all parts, in full lanes.
const CAPACITY: usize = (PARTS * POINTS).next_multiple_of(LANES);
/// EM steps. Twice as many change the lobe error of `../shared/data` by less than 0.001.
const STEPS: usize = 6;
/// Spread of the normals over the lobe, as squared slopes, below which widening is linear in it and its shape plays no
/// part: A + 2 K, within 1 % of A.
const SMOOTH: f32 = 0.01;

/// Unit directions times radii, turned a little from part to part so that no direction is preferred.
static PATTERNS: LazyLock<[[[f32; 2]; POINTS]; PARTS]> = LazyLock::new(|| {
    std::array::from_fn(|part| {
        std::array::from_fn(|point| {
            let (ring, spoke) = (point / 4, point % 4);
            // Rings are turned against each other by half a spoke, parts by the golden ratio.
            let turn = (spoke as f64 + 0.5 * ring as f64 + 0.381_966_011 * part as f64) / 4.0;
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
            [(f64::from(RADII[ring]) * cos) as f32, (f64::from(RADII[ring]) * sin) as f32]
        })
    })
});

impl Merge for OrientedLobe {
    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        if parts.len() > PARTS {
            let total = |weights: &[f32]| weights.iter().sum::<f32>().max(f32::MIN_POSITIVE);
            let groups = weights.chunks(PARTS).zip(parts.chunks(PARTS));
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
        let mut sum = [0.0; 3];
        for (w, part) in weights.iter().zip(parts) {
            sum = [0, 1, 2].map(|i| sum[i] + w * part.normal[i]);
        }
        let length = dot(sum, sum).sqrt();
        if length == 0.0 {
            return parts.first().copied().unwrap_or_default();
        }
        let about = frame(sum.map(|c| c / length));
        let start = Start::of(weights, parts, about);
        let Slopes { mean, a } =
            if start.is_smooth { start.slopes } else { Points::of(weights, parts, about).likeliest(start.slopes) };
        tilted(about, mean, a)
    }
}

/// A lobe as slopes about some normal.
#[derive(Clone, Copy)]
struct Slopes {
    mean: [f32; 2],
    a: Symmetric2,
}

/// What moments tell: where EM starts, and where it need not start.
struct Start {
    slopes: Slopes,
    is_smooth: bool,
}

impl Start {
    fn of(weights: &[f32], parts: &[OrientedLobe], [t, b, n]: [[f32; 3]; 3]) -> Self {
        let slope = |part: &OrientedLobe| {
            let z = dot(part.normal, n).max(LEAST_COSINE);
            [dot(part.normal, t) / z, dot(part.normal, b) / z]
        };
        let mut mean = [0.0; 2];
        let (mut least, mut largest) = (f32::INFINITY, 0.0_f32);
        for (w, part) in weights.iter().zip(parts) {
            let [x, y] = slope(part);
            mean = [mean[0] + w * x, mean[1] + w * y];
            let eigen = part.squared_alpha.0.eigen();
            (least, largest) = (least.min(eigen.minor), largest.max(eigen.major));
        }
        let (mut own, mut spread) = (Symmetric2::ZERO, Symmetric2::ZERO);
        for (w, part) in weights.iter().zip(parts) {
            let [x, y] = slope(part);
            own = own + *w * part.squared_alpha.0;
            spread = spread + *w * Symmetric2::outer([x - mean[0], y - mean[1]]);
        }
        // Parts of unlike widths merge to one that fits both only through EM.
        let is_smooth = spread.trace() <= SMOOTH * least && (largest <= 1.2 * least || spread.trace() == 0.0);
        // EM comes to the same lobe from wherever it starts, soonest from what a heavy-tailed spread would want.
        let widening = if is_smooth { 2.0 } else { 0.5 };
        Self { slopes: Slopes { mean, a: own + widening * spread }, is_smooth }
    }
}

/// Slopes of half-vectors about the mean normal, each with its share.
struct Points {
    x: [f32; CAPACITY],
    y: [f32; CAPACITY],
    weight: [f32; CAPACITY],
    lanes: usize,
}

impl Points {
    fn of(weights: &[f32], parts: &[OrientedLobe], about: [[f32; 3]; 3]) -> Self {
        let mut points = Self { x: [0.0; CAPACITY], y: [0.0; CAPACITY], weight: [0.0; CAPACITY], lanes: 0 };
        let patterns: &[[[f32; 2]; POINTS]; PARTS] = &PATTERNS;
        for (index, ((w, part), pattern)) in weights.iter().zip(parts).zip(patterns).enumerate() {
            // The part's axes, scaled by its lobe (A = L L^T, L lower triangular), in the common frame.
            let own = frame(part.normal).map(|axis| about.map(|common| dot(axis, common)));
            let Symmetric2 { uu, uv, vv } = part.squared_alpha.0;
            let l11 = uu.max(MIN_SQUARED_ALPHA).sqrt();
            let l21 = uv / l11;
            let l22 = (vv - l21 * l21).max(MIN_SQUARED_ALPHA).sqrt();
            let along = [0, 1, 2].map(|i| l11 * own[0][i] + l21 * own[1][i]);
            let across = [0, 1, 2].map(|i| l22 * own[1][i]);
            let share = w / POINTS as f32;
            let from = index * POINTS;
            let targets = points.x[from..].iter_mut().zip(&mut points.y[from..]).zip(&mut points.weight[from..]);
            for ([cos, sin], ((x, y), weight)) in pattern.iter().zip(targets) {
                let h = [0, 1, 2].map(|i| cos * along[i] + sin * across[i] + own[2][i]);
                let scale = 1.0 / h[2].max(LEAST_COSINE);
                (*x, *y, *weight) = (h[0] * scale, h[1] * scale, share);
            }
        }
        points.lanes = (parts.len() * POINTS).div_ceil(LANES);
        points
    }

    fn likeliest(&self, start: Slopes) -> Slopes {
        let Slopes { mut mean, mut a } = start;
        for _ in 0..STEPS {
            let [weight, x, y, xx, xy, yy] = self.sums(mean, a);
            let (dx, dy) = (x / weight, y / weight);
            a = Symmetric2::new(
                2.0 * (xx / weight - dx * dx),
                2.0 * (xy / weight - dx * dy),
                2.0 * (yy / weight - dy * dy),
            );
            mean = [mean[0] + dx, mean[1] + dy];
        }
        Slopes { mean, a }
    }

    /// Sums over the points of w, w x, w y, w x^2, w x y and w y^2 about `mean`, with w the EM weights.
    #[inline]
    fn sums(&self, mean: [f32; 2], a: Symmetric2) -> [f32; 6] {
        let scale = 1.0 / a.determinant().max(MIN_SQUARED_ALPHA * MIN_SQUARED_ALPHA);
        let (inverse_uu, inverse_uv, inverse_vv) = (a.vv * scale, -2.0 * a.uv * scale, a.uu * scale);
        let mut sums = [[0.0_f32; LANES]; 6];
        let (xs, ys, weights) =
            (self.x.as_chunks::<LANES>().0, self.y.as_chunks::<LANES>().0, self.weight.as_chunks::<LANES>().0);
        for ((xs, ys), weights) in xs.iter().zip(ys).zip(weights).take(self.lanes) {
            for lane in 0..LANES {
                let (x, y) = (xs[lane] - mean[0], ys[lane] - mean[1]);
                let q = inverse_uu * x * x + inverse_uv * x * y + inverse_vv * y * y;
                let w = weights[lane] * 2.0 / (1.0 + q);
                let (wx, wy) = (w * x, w * y);
                sums[0][lane] += w;
                sums[1][lane] += wx;
                sums[2][lane] += wy;
                sums[3][lane] += wx * x;
                sums[4][lane] += wx * y;
                sums[5][lane] += wy * y;
            }
        }
        sums.map(|lanes| lanes.iter().sum())
    }
}

/// Lobes are taken to be at least 0.001 wide: without width there is no density.
const MIN_SQUARED_ALPHA: f32 = 1e-6;

/// The lobe whose slopes about the frame's normal are `a` about `mean`, in the frame of its own normal. To first order in
/// the lobe's width: exact in its centre.
fn tilted(about: [[f32; 3]; 3], mean: [f32; 2], a: Symmetric2) -> OrientedLobe {
    let [t, b, n] = about;
    let length = (1.0 + mean[0] * mean[0] + mean[1] * mean[1]).sqrt();
    let normal = [0, 1, 2].map(|i| (n[i] + mean[0] * t[i] + mean[1] * b[i]) / length);
    let [own_t, own_b, _] = frame(normal);
    // Derivatives of slopes about the new normal by slopes about the old one.
    let j = [own_t, own_b].map(|own| [dot(own, t) / length, dot(own, b) / length]);
    let along = |p: [f32; 2], q: [f32; 2]| p[0] * q[0] * a.uu + (p[0] * q[1] + p[1] * q[0]) * a.uv + p[1] * q[1] * a.vv;
    let squared_alpha = SquaredAlpha(Symmetric2::new(along(j[0], j[0]), along(j[0], j[1]), along(j[1], j[1])));
    OrientedLobe { normal, squared_alpha }
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
        let points = Points::of(&[0.25; 4], &[part; 4], about);
        let Slopes { mean, a } = points.likeliest(Slopes { mean: [0.0; 2], a: Symmetric2::diagonal(0.2, 0.2) });
        assert_alike(tilted(about, mean, a), part, 0.01);
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
        ] {
            let merged = merge(&parts);
            let a = merged.squared_alpha.0;
            assert!(merged.normal.iter().chain(&[a.uu, a.uv, a.vv]).all(|x| x.is_finite()), "{merged:?}");
            assert!(a.uu >= 0.0 && a.vv >= 0.0 && a.uu * a.vv - a.uv * a.uv >= -1e-6 * a.trace() * a.trace());
        }
    }
}
