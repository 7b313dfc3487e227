//! Fits the width of a lobe to lobes of nearly the same direction, by the lobe error.
//!
//! About one normal, the half-vectors of an isotropic lobe of squared alpha a have a density over ln t, where t is the
//! squared tangent of the angle to the normal: a t / (a + t)^2 for GGX, and (t / a) exp(-t / a) for Beckmann lobes. In
//! each family these densities have one shape and differ in its place. So a sum over few places gives the error of a
//! width.

use crate::lobe::{Family, OrientedLobe, SquaredAlpha};
use crate::math::vector::dot;
use crate::metric::density::MIN_ALPHA;
use crate::metric::mixture::exp_of_minus;
use crate::simd::dispatch;

/// Places of t at which densities are compared, [`PLACE_STEP`] apart: from 1/64 of the least squared alpha up to at
/// least 45 times the largest, since squared alphas are from [`LEAST`] to 1.
const PLACES: usize = 64;
/// Ratio of the first place to the least squared alpha.
const FIRST_PLACE: f32 = 1.0 / 64.0;
/// Ratio of neighbouring places.
const PLACE_STEP: f32 = std::f32::consts::SQRT_2;
/// The least squared alpha.
const LEAST: f32 = (MIN_ALPHA * MIN_ALPHA) as f32;
/// Ratios of the squared alphas that are tried beside the best one, one after the other: 2^(1/2), 2^(1/4), 2^(1/8) and
/// 2^(1/16).
const FINER_STEPS: [f32; 4] = [std::f32::consts::SQRT_2, 1.189_207_1, 1.090_507_7, 1.044_273_8];

/// Returns `start` with the width that has the least error for the lobes `parts` of `family` (weights that sum to 1,
/// lobes), whose normals are nearly that of `start`. The ratio of the alphas stays. Widths between those of the
/// narrowest and of the widest part are tried: first by factors of 2, then by smaller ones about the best.
pub fn fit_width(family: Family, parts: &[(f32, OrientedLobe)], start: OrientedLobe) -> OrientedLobe {
    let squared = |lobe: &OrientedLobe| lobe.squared_alpha.0.determinant().sqrt().clamp(LEAST, 1.0);
    // A lobe beside the normal is as far from it as a wider lobe about it.
    let away = |lobe: &OrientedLobe| {
        let between = [0, 1, 2].map(|i| lobe.normal[i] - start.normal[i]);
        dot(between, between)
    };
    let width = |lobe: &OrientedLobe| (squared(lobe) + away(lobe)).min(1.0);
    let parts: Vec<(f32, f32)> = parts.iter().map(|(weight, lobe)| (*weight, width(lobe))).collect();
    let wanted = dispatch!(fearless_simd::Level::new(), _simd => match family {
        Family::Ggx => best_width(&parts, ggx),
        Family::Beckmann => best_width(&parts, beckmann),
    });
    OrientedLobe { squared_alpha: SquaredAlpha((wanted / squared(&start)) * start.squared_alpha.0), ..start }
}

/// Returns the density over ln t of a GGX lobe of squared alpha `a`.
#[inline(always)]
fn ggx(a: f32, t: f32) -> f32 {
    a * t / ((a + t) * (a + t))
}

/// Returns the density over ln t of a Beckmann lobe of squared alpha `a`.
#[inline(always)]
fn beckmann(a: f32, t: f32) -> f32 {
    t / a * exp_of_minus(t / a)
}

/// Returns the squared alpha with the least error for `parts` (weights, squared alphas) of the family with `density`.
#[inline(always)]
fn best_width(parts: &[(f32, f32)], density: impl Fn(f32, f32) -> f32) -> f32 {
    let (least, most) = parts.iter().fold((1.0_f32, LEAST), |(least, most), (_, a)| (least.min(*a), most.max(*a)));
    let mut places = [least * FIRST_PLACE; PLACES];
    for i in 1..PLACES {
        places[i] = places[i - 1] * PLACE_STEP;
    }
    let mut wanted = [0.0; PLACES];
    for (weight, a) in parts {
        for i in 0..PLACES {
            wanted[i] += weight * density(*a, places[i]);
        }
    }
    let error = |a: f32| {
        let mut densities = [0.0; PLACES];
        for i in 0..PLACES {
            densities[i] = density(a, places[i]);
        }
        distance(&densities, &wanted)
    };
    let better = |best: (f32, f32), a: f32| {
        let error = error(a);
        if error < best.0 { (error, a) } else { best }
    };
    let mut best = (error(most), most);
    let mut coarse = least;
    while coarse < most {
        best = better(best, coarse);
        coarse *= 2.0;
    }
    for step in FINER_STEPS {
        let (_, middle) = best;
        best = better(best, (middle * step).min(most));
        best = better(best, (middle / step).max(least));
    }
    best.1
}

/// Returns the sum of the differences between two rows of densities, added in a fixed order.
#[inline(always)]
fn distance(a: &[f32; PLACES], b: &[f32; PLACES]) -> f32 {
    let mut sums = [0.0; 8];
    for (a, b) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
        for i in 0..8 {
            sums[i] += (a[i] - b[i]).abs();
        }
    }
    (sums[0] + sums[4]) + (sums[1] + sums[5]) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::test_lobes::isotropic_lobe as lobe;
    use crate::math::symmetric::Symmetric2;
    use crate::metric::{Footprint, Lobe, Part, Reference, oracle};

    #[test]
    fn equal_parts_have_their_own_width() {
        for alpha in [0.001, 0.03, 0.3, 1.0] {
            let fitted = fit_width(Family::Ggx, &[(0.25, lobe(alpha, 0.0)); 4], lobe(0.07, 0.0));
            let [u, v] = [fitted.squared_alpha.0.uu, fitted.squared_alpha.0.vv].map(f32::sqrt);
            assert!((u / alpha - 1.0).abs() < 1e-4 && (v / alpha - 1.0).abs() < 1e-4, "{u} {v} {alpha}");
        }
        let mirror = fit_width(Family::Ggx, &[(0.25, lobe(0.0, 0.0)); 4], lobe(0.0, 0.0)).squared_alpha.0;
        assert!(mirror.uu >= 0.0 && mirror.uu <= 1e-6 && mirror.vv <= 1e-6, "{mirror:?}");
    }

    #[test]
    fn the_axes_of_the_start_stay() {
        let mut start = lobe(0.1, 0.0);
        start.squared_alpha = SquaredAlpha(Symmetric2::new(0.04, 0.01, 0.02));
        let fitted = fit_width(Family::Ggx, &[(0.5, lobe(0.1, 0.0)), (0.5, lobe(0.3, 0.0))], start);
        let (a, b) = (fitted.squared_alpha.0, start.squared_alpha.0);
        assert!((a.uv / a.uu - b.uv / b.uu).abs() < 1e-5 && (a.vv / a.uu - b.vv / b.uu).abs() < 1e-5);
        assert_eq!(fitted.normal, start.normal);
    }

    /// The error is hardly larger than that of the best lobe that a long search finds.
    #[test]
    fn mixtures_get_nearly_the_best_lobe() {
        let mixtures = [
            (0.1, 0.2, 0.5, 0.0),
            (0.1, 0.35, 0.3, 0.0),
            (0.1, 0.35, 0.7, 0.0),
            (0.03, 0.1, 0.75, 0.0),
            (0.1, 0.3, 0.25, 0.04),
            (0.02, 0.3, 0.6, 0.0),
            (0.001, 0.7, 0.03, 0.0),
            (0.005, 0.5, 0.06, 0.0),
            (0.01, 0.5, 0.95, 0.0),
        ];
        let mixtures = mixtures.into_iter().flat_map(|m| [Family::Ggx, Family::Beckmann].map(|family| (family, m)));
        for (family, (narrow, wide, share, apart)) in mixtures {
            let parts = [(share, lobe(narrow, apart)), (1.0 - share, lobe(wide, 0.0))];
            let part = |(weight, lobe): &(f32, OrientedLobe)| {
                let a = lobe.squared_alpha.0;
                let base = [a.uu, a.uv, a.vv].map(f64::from);
                Part { weight: f64::from(*weight), normal: lobe.normal.map(f64::from), base }
            };
            let footprint = Footprint::new(parts.iter().map(part).collect()).expect("positive weights");
            let reference = Reference::new(family, &footprint, 4096);
            let fitted = fit_width(family, &parts, lobe(0.15, 0.0));
            let a = f64::from(fitted.squared_alpha.0.uu);
            let fitted = Lobe::new(family, fitted.normal.map(f64::from), [a, 0.0, a]);
            let (error, best) = (reference.error(&fitted), oracle(&reference, &[fitted]).1);
            assert!(error < 1.05 * best + 0.002, "{family:?} {narrow} {wide} {share} {apart}: {error} {best}");
        }
    }
}
