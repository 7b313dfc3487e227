use super::*;
use crate::bump::Offset;
use crate::lobe::Alpha;
use crate::metric::{Footprint, Lobe, Part, Reference, SAMPLES, oracle};

const EFFORT: FitEffort =
    FitEffort { half_vectors: 512, search: Search { descents: 2, rounds: 8 }, likelihood_steps: 4 };

/// Returns 1024 parts: `share` of them wide and spread by `steep`, the others narrow and spread by `flat`.
fn two_populations(share: u32, alphas: [f32; 2], spreads: [f32; 2]) -> Vec<(f32, OrientedLobe)> {
    let mut state = 1_u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / (1 << 24) as f32 - 0.5
    };
    let mut part = |i: u32| {
        let wide = usize::from(i % 100 < share);
        let offset = Offset { u: spreads[wide] * next(), v: spreads[wide] * next() };
        (1.0 / 1024.0, OrientedLobe::new(offset, SquaredAlpha::isotropic(Alpha(alphas[wide]))))
    };
    (0..1024).map(&mut part).collect()
}

fn reference(family: Family, parts: &[(f32, OrientedLobe)]) -> Reference {
    let parts = parts.iter().map(|(weight, lobe)| Part::of(f64::from(*weight), lobe)).collect();
    Reference::new(family, &Footprint::new(parts).unwrap(), SAMPLES)
}

fn metric_lobe(family: Family, lobe: &OrientedLobe) -> Lobe {
    let a = lobe.squared_alpha.0;
    Lobe::new(family, lobe.normal.map(f64::from), [a.uu, a.uv, a.vv].map(f64::from))
}

/// A fit in single precision is nearly as good as the best lobe of a long search in double precision, also where two
/// populations meet and the start stands for the wrong one.
#[test]
fn fits_are_close_to_the_best_lobe() {
    let starts = [OrientedLobe::new(Offset { u: 0.0, v: 0.0 }, SquaredAlpha::isotropic(Alpha(0.3)))];
    for family in [Family::Ggx, Family::Beckmann] {
        for (share, alphas, spreads) in
            [(30, [0.01, 0.5], [0.02, 0.8]), (0, [0.1, 0.1], [0.5, 0.5]), (2, [0.1, 0.1], [0.2, 20.0])]
        {
            let parts = two_populations(share, alphas, spreads);
            let reference = reference(family, &parts);
            let (_, best) = oracle(&reference, &[]);
            for start in starts {
                let fitted = fit(family, &parts, start, EFFORT, 0);
                let error = reference.error(&metric_lobe(family, &fitted));
                assert!(error < 1.03 * best + 0.006, "{family:?} {alphas:?}: {error} {best}");
            }
        }
    }
}

/// One lobe is its own best fit.
#[test]
fn a_lobe_is_its_own_fit() {
    let lobe = OrientedLobe::new(Offset { u: 0.2, v: -0.1 }, SquaredAlpha(Symmetric2::new(0.04, 0.01, 0.01)));
    let fitted = fit(Family::Ggx, &[(1.0, lobe)], lobe, EFFORT, 0);
    let error = reference(Family::Ggx, &[(1.0, lobe)]).error(&metric_lobe(Family::Ggx, &fitted));
    assert!(error < 0.002, "{error}");
}

/// Alphas stay within [0.001, 1] and normals above the surface, whatever the parts are.
#[test]
fn fits_stay_in_range() {
    let steep = OrientedLobe { normal: [0.999, 0.0, 0.0447], squared_alpha: SquaredAlpha::isotropic(Alpha(3.0)) };
    let narrow = OrientedLobe { normal: [0.0, 0.0, 1.0], squared_alpha: SquaredAlpha(Symmetric2::ZERO) };
    for parts in [vec![(1.0, steep)], vec![(1.0, narrow)], vec![(0.5, steep), (0.5, narrow)]] {
        for start in [steep, narrow] {
            let fitted = fit(Family::Ggx, &parts, start, EFFORT, 7);
            let eigen = fitted.squared_alpha.0.eigen();
            assert!(eigen.major <= 1.001 && eigen.minor >= 0.9e-6, "{fitted:?}");
            assert!(fitted.normal.iter().all(|c| c.is_finite()), "{fitted:?}");
        }
    }
}

/// The parts of a fit in single precision are evaluated as in double precision.
#[test]
fn errors_agree_with_double_precision() {
    let parts = two_populations(30, [0.05, 0.5], [0.1, 0.8]);
    let target = Target::new(Family::Ggx, &parts, 4096, 0);
    let reference = reference(Family::Ggx, &parts);
    for alpha in [0.02, 0.1, 0.5] {
        let lobe = OrientedLobe::new(Offset { u: 0.05, v: 0.0 }, SquaredAlpha::isotropic(Alpha(alpha)));
        let (found, wanted) = (target.error(&Candidate::of(&lobe)), reference.error(&metric_lobe(Family::Ggx, &lobe)));
        assert!((f64::from(found) - wanted).abs() < 0.01, "{alpha}: {found} {wanted}");
    }
}
