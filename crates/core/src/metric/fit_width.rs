//! Fits the width of a lobe to lobes of nearly the same direction, by the lobe error.
//!
//! About one normal, the half-vectors of an isotropic GGX lobe of squared alpha a have the density a t / (a + t)^2 over
//! ln t, where t is the squared tangent of the angle to the normal. These densities all have one shape and differ in
//! its place, so that a sum over few places gives the error of a width.

use crate::lobe::{OrientedLobe, SquaredAlpha};
use crate::simd::dispatch;

/// Places of t at which densities are compared, [`PLACE_STEP`] apart: from 1/64 of the least squared alpha up to 64
/// times the largest.
const PLACES: usize = 64;
/// Ratio of the first place to the least squared alpha.
const FIRST_PLACE: f32 = 1.0 / 64.0;
/// Ratio of neighbouring places.
const PLACE_STEP: f32 = std::f32::consts::SQRT_2;
/// The least squared alpha.
const LEAST: f32 = 1e-6;
/// Ratios of the squared alphas that are tried beside the best one, one after the other: 2^(1/2), 2^(1/4), 2^(1/8) and
/// 2^(1/16).
const FINER_STEPS: [f32; 4] = [std::f32::consts::SQRT_2, 1.189_207_1, 1.090_507_7, 1.044_273_8];

/// Returns `start` with the width that has the least error for GGX lobes `parts` (weights that sum to 1, lobes), whose
/// normals are nearly that of `start`. The ratio of the alphas stays, and they are at most 1 in the mean. Widths
/// between those of the narrowest and of the widest part are tried: first by factors of 2, then by smaller ones about
/// the best.
pub fn fit_width(parts: &[(f32, OrientedLobe)], start: OrientedLobe) -> OrientedLobe {
    let squared = |lobe: &OrientedLobe| lobe.squared_alpha.0.determinant().max(0.0).sqrt().clamp(LEAST, 1.0);
    // A lobe beside the normal is as far from it as a wider lobe about it.
    let away = |lobe: &OrientedLobe| {
        let between = [0, 1, 2].map(|i| lobe.normal[i] - start.normal[i]);
        between[0] * between[0] + between[1] * between[1] + between[2] * between[2]
    };
    let width = |lobe: &OrientedLobe| (squared(lobe) + away(lobe)).min(1.0);
    let parts: Vec<(f32, f32)> = parts.iter().map(|(weight, lobe)| (*weight, width(lobe))).collect();
    let wanted = dispatch!(fearless_simd::Level::new(), _simd => best_width(&parts));
    OrientedLobe { squared_alpha: SquaredAlpha((wanted / squared(&start)) * start.squared_alpha.0), ..start }
}

/// Returns the squared alpha with the least error.
#[inline(always)]
fn best_width(parts: &[(f32, f32)]) -> f32 {
    let (least, most) = parts.iter().fold((1.0_f32, LEAST), |(least, most), (_, a)| (least.min(*a), most.max(*a)));
    let mut places = [least * FIRST_PLACE; PLACES];
    for i in 1..PLACES {
        places[i] = places[i - 1] * PLACE_STEP;
    }
    let mut wanted = [0.0; PLACES];
    for (weight, a) in parts {
        for (sum, density) in wanted.iter_mut().zip(densities(*a, &places)) {
            *sum += weight * density;
        }
    }
    let error = |a: f32| distance(&densities(a, &places), &wanted);
    let mut best = (error(most), most);
    let attempt = |a: f32, best: &mut (f32, f32)| {
        let error = error(a);
        if error < best.0 {
            *best = (error, a);
        }
    };
    let mut coarse = least;
    while coarse < most {
        attempt(coarse, &mut best);
        coarse *= 2.0;
    }
    for step in FINER_STEPS {
        let (_, middle) = best;
        attempt((middle * step).min(most), &mut best);
        attempt((middle / step).max(least), &mut best);
    }
    best.1
}

/// Returns the density over ln t of a lobe of squared alpha `a` at each place.
#[inline(always)]
fn densities(a: f32, places: &[f32; PLACES]) -> [f32; PLACES] {
    let mut densities = [0.0; PLACES];
    for i in 0..PLACES {
        let sum = a + places[i];
        densities[i] = a * places[i] / (sum * sum);
    }
    densities
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
    use crate::lobe::Family;
    use crate::lobe::test_lobes::isotropic_lobe as lobe;
    use crate::math::symmetric::Symmetric2;
    use crate::metric::{Footprint, Lobe, Part, Reference, oracle};

    #[test]
    fn equal_parts_have_their_own_width() {
        for alpha in [0.001, 0.03, 0.3, 1.0] {
            let fitted = fit_width(&[(0.25, lobe(alpha, 0.0)); 4], lobe(0.07, 0.0));
            let [u, v] = [fitted.squared_alpha.0.uu, fitted.squared_alpha.0.vv].map(f32::sqrt);
            assert!((u / alpha - 1.0).abs() < 1e-4 && (v / alpha - 1.0).abs() < 1e-4, "{u} {v} {alpha}");
        }
        let mirror = fit_width(&[(0.25, lobe(0.0, 0.0)); 4], lobe(0.0, 0.0)).squared_alpha.0;
        assert!(mirror.uu >= 0.0 && mirror.uu <= 1e-6 && mirror.vv <= 1e-6, "{mirror:?}");
    }

    #[test]
    fn the_axes_of_the_start_stay() {
        let mut start = lobe(0.1, 0.0);
        start.squared_alpha = SquaredAlpha(Symmetric2::new(0.04, 0.01, 0.02));
        let fitted = fit_width(&[(0.5, lobe(0.1, 0.0)), (0.5, lobe(0.3, 0.0))], start);
        let (a, b) = (fitted.squared_alpha.0, start.squared_alpha.0);
        assert!((a.uv / a.uu - b.uv / b.uu).abs() < 1e-5 && (a.vv / a.uu - b.vv / b.uu).abs() < 1e-5);
        assert_eq!(fitted.normal, start.normal);
    }

    /// The error is hardly larger than that of the best lobe that a long search finds.
    #[test]
    fn mixtures_get_nearly_the_best_lobe() {
        for (narrow, wide, share, apart) in [
            (0.1, 0.2, 0.5, 0.0),
            (0.1, 0.35, 0.3, 0.0),
            (0.1, 0.35, 0.7, 0.0),
            (0.03, 0.1, 0.75, 0.0),
            (0.1, 0.3, 0.25, 0.04),
            (0.02, 0.3, 0.6, 0.0),
            (0.001, 0.7, 0.03, 0.0),
            (0.005, 0.5, 0.06, 0.0),
            (0.01, 0.5, 0.95, 0.0),
        ] {
            let parts = [(share, lobe(narrow, apart)), (1.0 - share, lobe(wide, 0.0))];
            let part = |(weight, lobe): &(f32, OrientedLobe)| {
                let a = lobe.squared_alpha.0;
                let base = [a.uu, a.uv, a.vv].map(f64::from);
                Part { weight: f64::from(*weight), normal: lobe.normal.map(f64::from), base }
            };
            let footprint = Footprint::new(parts.iter().map(part).collect()).expect("positive weights");
            let reference = Reference::new(Family::Ggx, &footprint, 4096);
            let fitted = fit_width(&parts, lobe(0.15, 0.0));
            let a = f64::from(fitted.squared_alpha.0.uu);
            let fitted = Lobe::new(Family::Ggx, fitted.normal.map(f64::from), [a, 0.0, a]);
            let (error, best) = (reference.error(&fitted), oracle(&reference, &[fitted]).1);
            assert!(error < 1.05 * best + 0.002, "{narrow} {wide} {share} {apart}: {error} {best}");
        }
    }
}
