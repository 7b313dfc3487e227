use super::*;

#[test]
fn the_factor_squares_to_k() {
    // Hand-computed: K = [[5, 2], [2, 4]] gives d3 = 2, d2 = 1, d1 = 2.
    let d = Factor::of(Symmetric2::new(5.0, 2.0, 4.0));
    assert_eq!(d, Factor { d1: 2.0, d2: 1.0, d3: 2.0 });
    assert_eq!(d.covariance(), Symmetric2::new(5.0, 2.0, 4.0));
}

#[test]
fn rank_0_and_1_have_a_factor() {
    assert_eq!(Factor::of(Symmetric2::ZERO), Factor::default());
    for v in [[3.0, 0.0], [0.0, 3.0], [1.0, -2.0], [1e-4, 3.0], [3.0, 1e-4], [1e-20, 1e-20]] {
        let k = Symmetric2::outer(v);
        let back = Factor::of(k).covariance();
        let bound = 1e-6 * k.trace();
        assert!((back.uu - k.uu).abs() <= bound, "{v:?}");
        assert!((back.uv - k.uv).abs() <= bound, "{v:?}");
        assert!((back.vv - k.vv).abs() <= bound, "{v:?}");
        assert!((lambda_1(k) - (v[0] * v[0] + v[1] * v[1]).sqrt()).abs() <= 1e-6 * lambda_1(k).max(1e-12));
    }
}

/// The paper's erratum 1: x^T K^-1 x = 1 holds 1 - 1/sqrt(e) = 39.3 % of a normal distribution, not 63 %, which is
/// what x^T K^-1 x = 2 holds.
#[test]
fn erratum_1_the_ellipse_holds_39_percent() {
    // In the eigenframe, q = x^T K^-1 x of a 2-D normal is exponential with mean 2: integrate its density.
    let share = |limit: f64| {
        let steps = 100_000;
        let width = limit / f64::from(steps);
        (0..steps).map(|i| 0.5 * (-(f64::from(i) + 0.5) * width / 2.0).exp() * width).sum::<f64>()
    };
    assert!((share(1.0) - 0.393).abs() < 1e-3);
    assert!((share(2.0) - 0.632).abs() < 1e-3);
}

/// The paper's erratum 2: the axes 2a/sqrt 3 belong to a rectangle with half-edges a: its standard deviation is
/// a/sqrt 3 and the ellipse's full axis twice that.
#[test]
fn erratum_2_the_axes_belong_to_half_edges() {
    let (a, n) = (0.7, 10_001);
    let offsets = (0..n).map(|i| a * (2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0));
    let variance = offsets.map(|x| x * x).sum::<f64>() / f64::from(n);
    let full_axis = 2.0 * variance.sqrt();
    assert!((full_axis - 2.0 * a / 3f64.sqrt()).abs() < 1e-6);
}
