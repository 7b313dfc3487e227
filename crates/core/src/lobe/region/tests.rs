use super::*;
use crate::math::symmetric::Symmetric2;

#[test]
fn samples_reproduce_the_covariance() {
    let n = 200;
    for factor in [
        Factor { d1: 0.3, d2: -0.2, d3: 0.1 },
        Factor { d1: 0.0, d2: 0.2, d3: 0.1 },
        Factor { d1: 0.2, d2: 0.0, d3: 0.0 },
        Factor::default(),
    ] {
        for region in [Region::Normal, Region::Ellipse] {
            let (mut k, mut mean) = (Symmetric2::ZERO, [0.0; 2]);
            let share = 1.0 / (n * n) as f32;
            for i in 0..n * n {
                let point = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|c| c / n as f32);
                let o = region.offset(factor, point);
                k = k + share * Symmetric2::outer([o.u, o.v]);
                mean = [mean[0] + share * o.u, mean[1] + share * o.v];
            }
            let exact = factor.covariance();
            // The midpoint rule loses 0.4 % of the normal distribution's unbounded tail.
            let bound = 0.006 * exact.trace();
            for (found, exact) in [(k.uu, exact.uu), (k.uv, exact.uv), (k.vv, exact.vv)] {
                assert!((found - exact).abs() <= bound, "{region:?} {factor:?}: {found} {exact}");
            }
            assert!(mean[0].abs() < 1e-4 && mean[1].abs() < 1e-4, "{mean:?}");
        }
    }
}

#[test]
fn the_ellipse_is_bounded_and_full() {
    // With D = 1 the region is the disc of radius 2.
    let unit = Factor { d1: 1.0, d2: 0.0, d3: 1.0 };
    let border = Region::Ellipse.offset(unit, [1.0, 0.125]);
    assert!((border.u - 2f32.sqrt()).abs() < 1e-6 && (border.v - 2f32.sqrt()).abs() < 1e-6);
    assert_eq!(Region::Ellipse.offset(unit, [0.0, 0.3]), Offset::default());
    for hostile in [f32::INFINITY, -1.0, 2.0] {
        let far = Region::Normal.offset(unit, [hostile, hostile]);
        assert!(far.u.abs() < 5.9 && far.v.abs() < 5.9, "{far:?}");
    }
}
