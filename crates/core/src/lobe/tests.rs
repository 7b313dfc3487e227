use super::*;
use crate::bump::{Moments, Offset, ShapedMoments};
use crate::lobe::correction::Distribution;

/// Evaluates GGX over slopes in f64.
fn ggx(a: [f64; 3], s: [f64; 2]) -> f64 {
    let [xx, xy, yy] = a;
    let det = xx * yy - xy * xy;
    let q = (yy * s[0] * s[0] - 2.0 * xy * s[0] * s[1] + xx * s[1] * s[1]) / det;
    1.0 / (std::f64::consts::PI * det.sqrt() * (1.0 + q) * (1.0 + q))
}

/// Computes half the integral of |p - q| over all slopes by the midpoint rule in s = scale * t / (1 - t^2).
fn distance(scale: f64, p: impl Fn([f64; 2]) -> f64, q: impl Fn([f64; 2]) -> f64) -> f64 {
    let n = 300;
    let axis: Vec<(f64, f64)> = (0..n)
        .map(|i| {
            let t = 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
            let slope = scale * t / (1.0 - t * t);
            let width = scale * (1.0 + t * t) / (1.0 - t * t).powi(2) * 2.0 / f64::from(n);
            (slope, width)
        })
        .collect();
    let mut sum = 0.0;
    for (x, dx) in &axis {
        for (y, dy) in &axis {
            sum += (p([*x, *y]) - q([*x, *y])).abs() * dx * dy;
        }
    }
    0.5 * sum
}

#[test]
fn roughening_is_exact_for_beckmann_and_normal_slopes() {
    // Beckmann alpha 0.3 is a normal density of variance 0.045; normal slopes of variance 0.02 add to 0.065 = 0.13/2.
    let roughened = SquaredAlpha::isotropic(Alpha(0.3)).roughen(Symmetric2::diagonal(0.02, 0.02));
    assert!((roughened.0.uu - 0.13).abs() < 1e-6);
    assert!((roughened.closest_isotropic().0 - 0.13f32.sqrt()).abs() < 1e-6);
}

#[test]
fn closed_distances_match_the_integral() {
    for (a, b) in [(0.1, 0.1), (0.1, 0.2), (0.3, 0.9)] {
        let exact = f64::from(isotropic_distance(Alpha(a), Alpha(b)));
        let (a, b) = (f64::from(a), f64::from(b));
        let numeric = distance((a * b).sqrt(), |s| ggx([a * a, 0.0, a * a], s), |s| ggx([b * b, 0.0, b * b], s));
        assert!((exact - numeric).abs() < 2e-3, "{exact} {numeric}");
    }
    for ratio in [1.0, 1.5, 4.0, 20.0] {
        let exact = f64::from(shape_distance(ratio));
        let r = f64::from(ratio);
        let numeric = distance(1.0, |s| ggx([r, 0.0, 1.0 / r], s), |s| ggx([1.0, 0.0, 1.0], s));
        assert!((exact - numeric).abs() < 4e-3, "{exact} {numeric}");
    }
}

#[test]
fn the_closest_isotropic_lobe_has_the_determinant() {
    let a = SquaredAlpha(Symmetric2::diagonal(0.09, 0.01));
    let best = a.closest_isotropic().0;
    assert!((best - 0.03f32.sqrt()).abs() < 1e-6);
    let error = |alpha: f32| {
        let squared = f64::from(alpha * alpha);
        distance(0.17, |s| ggx([0.09, 0.0, 0.01], s), |s| ggx([squared, 0.0, squared], s))
    };
    assert!(error(best) < error(best * 1.1) && error(best) < error(best / 1.1));
}

#[test]
fn anisotropy_round_trips() {
    for (alpha_t, alpha_b, direction) in
        [(0.5, 0.1, [0.8, 0.6]), (1.0, 0.25, [0.0, 1.0]), (0.3, 0.0, [-0.6, 0.8]), (0.4, 0.4, [1.0, 0.0])]
    {
        let a = SquaredAlpha(Symmetric2::from_axes(alpha_t * alpha_t, alpha_b * alpha_b, direction));
        let parameters = Anisotropy::of(a, direction);
        let back = parameters.squared_alpha();
        for (x, y) in [(a.0.uu, back.0.uu), (a.0.uv, back.0.uv), (a.0.vv, back.0.vv)] {
            assert!((x - y).abs() < 1e-6, "{parameters:?} {a:?} {back:?}");
        }
    }
}

#[test]
fn directions_agree_with_the_reference() {
    let a = SquaredAlpha(Symmetric2::from_axes(0.25, 0.01, [0.8, 0.6]));
    let forward = Anisotropy::of(a, [1.0, 0.0]).direction;
    let backward = Anisotropy::of(a, [-1.0, 0.0]).direction;
    assert!(forward[0] > 0.0);
    assert_eq!(backward, [-forward[0], -forward[1]]);
    // An isotropic lobe has no direction, so the direction is that of the reference.
    let isotropic = Anisotropy::of(SquaredAlpha::isotropic(Alpha(0.4)), [0.6, -0.8]);
    assert!((isotropic.direction[0] - 0.6).abs() < 1e-6 && (isotropic.direction[1] + 0.8).abs() < 1e-6);
    assert_eq!(isotropic.strength, 0.0);
}

#[test]
fn alphas_above_one_are_clamped() {
    let wide = SquaredAlpha(Symmetric2::diagonal(9.0, 4.0));
    assert!(wide.exceeds_one());
    let parameters = Anisotropy::of(wide, [1.0, 0.0]);
    assert_eq!((parameters.roughness, parameters.strength), (Roughness(1.0), 0.0));
}

/// On its own distribution, at a deviation of two alphas, no other c in steps of 0.05 is better.
#[test]
fn the_correction_factor_is_the_best() {
    let (alpha, sigma) = (0.1_f64, 0.2);
    for distribution in [Distribution::Normal, Distribution::Uniform] {
        // Equally likely slopes along each axis.
        let count = 48;
        let quantiles: Vec<f64> = (0..count)
            .map(|i| {
                let p = (f64::from(i) + 0.5) / f64::from(count);
                match distribution {
                    Distribution::Normal => sigma * normal_quantile(p),
                    _ => sigma * 3f64.sqrt() * (2.0 * p - 1.0),
                }
            })
            .collect();
        let reference = |s: [f64; 2]| {
            let mut sum = 0.0;
            for x in &quantiles {
                for y in &quantiles {
                    sum += ggx([alpha * alpha, 0.0, alpha * alpha], [s[0] - x, s[1] - y]);
                }
            }
            sum / f64::from(count * count)
        };
        let samples = Quarter::new(sigma, reference);
        let error = |c: f64| {
            let squared = alpha * alpha + 2.0 * c * sigma * sigma;
            samples.distance(|s| ggx([squared, 0.0, squared], s))
        };
        let spread = Symmetric2::diagonal((sigma * sigma) as f32, (sigma * sigma) as f32);
        let moments = ShapedMoments::normal(Moments { mean: Offset::default(), covariance: spread });
        let base = SquaredAlpha::isotropic(Alpha(alpha as f32));
        let ours = f64::from(distribution.correct(&moments, base, Family::Ggx).covariance.uu) / (sigma * sigma);
        let best = (10..30).map(|i| 0.05 * f64::from(i)).min_by(|a, b| error(*a).total_cmp(&error(*b))).unwrap();
        assert!((best - ours).abs() < 0.051, "{distribution:?}: {best}");
    }
}

/// Two normal distributions make a third whose covariance is their sum, at any ratio of their widths.
#[test]
fn beckmann_lobes_of_normal_bumps_need_no_correction() {
    for ratio in [0.25, 0.5, 1.0, 2.0, 5.0, 20.0] {
        let base = SquaredAlpha::isotropic(Alpha(0.1));
        let covariance = Symmetric2::diagonal(0.01 * ratio * ratio, 0.01 * ratio * ratio);
        let moments = ShapedMoments::normal(Moments { mean: Offset::default(), covariance });
        let corrected = Distribution::Normal.correct(&moments, base, Family::Beckmann).covariance;
        let c = corrected.uu / covariance.uu;
        assert!((c - 1.0).abs() < 0.03, "{ratio}: {c}");
    }
}

/// A density that is symmetric in all octants, with stored samples.
struct Quarter {
    samples: Vec<([f64; 2], f64, f64)>,
}

impl Quarter {
    fn new(scale: f64, density: impl Fn([f64; 2]) -> f64) -> Self {
        let n = 32;
        let point = |k: i32| {
            let t = (f64::from(k) + 0.5) / f64::from(n);
            (scale * 2.0 * t / (1.0 - t), scale * 2.0 / (1.0 - t).powi(2) / f64::from(n))
        };
        let mut samples = Vec::new();
        for i in 0..n {
            for j in 0..=i {
                let ((x, dx), (y, dy)) = (point(i), point(j));
                let copies = if i == j { 4.0 } else { 8.0 };
                samples.push(([x, y], copies * dx * dy, density([x, y])));
            }
        }
        Self { samples }
    }

    fn distance(&self, other: impl Fn([f64; 2]) -> f64) -> f64 {
        0.5 * self.samples.iter().map(|(s, area, p)| area * (p - other(*s)).abs()).sum::<f64>()
    }
}

/// Computes the quantile of the standard normal distribution by bisection of its integral.
fn normal_quantile(p: f64) -> f64 {
    let cumulated = |x: f64| {
        let n = 400;
        let width = (x + 8.0) / f64::from(n);
        (0..n)
            .map(|i| {
                let t: f64 = -8.0 + (f64::from(i) + 0.5) * width;
                (-0.5 * t * t).exp() * width
            })
            .sum::<f64>()
            / std::f64::consts::TAU.sqrt()
    };
    let (mut low, mut high) = (-8.0, 8.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if cumulated(middle) < p {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The comparison without roots agrees with the comparison of roots for every float around 1.
#[test]
fn isotropic_exceeds_one_agrees_with_the_alpha() {
    for step in -64..64 {
        let determinant = f32::from_bits((1.0_f32.to_bits() as i32 + step) as u32);
        let lobe = SquaredAlpha(Symmetric2::diagonal(determinant, 1.0));
        assert_eq!(lobe.isotropic_exceeds_one(), lobe.closest_isotropic().0 > 1.0, "{determinant}");
    }
}
