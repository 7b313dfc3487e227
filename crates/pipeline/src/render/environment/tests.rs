use super::*;

#[test]
fn blur_keeps_constant_radiance() {
    let environment = Environment::new(Surroundings::Even(100));
    for deviation in [0.0, 0.001, 0.02, 0.3, 9.0] {
        for d in [[0.0, 0.0, 1.0], [-1.0, 1e-9, 0.0], normalised([0.3, -0.4, -0.5])] {
            for channel in environment.filtered(d, deviation) {
                assert!((channel - 1.0).abs() < 1e-9);
            }
        }
    }
}

/// Compares the blurred windows of the studio, whose radiance is 3.2, with a sum over many samples of the normal
/// distribution.
#[test]
fn levels_have_the_blur_of_a_normal_distribution() {
    let environment = Environment::new(Surroundings::Studio);
    for deviation in [0.02, 0.05, 0.12, 0.3] {
        for east in [-0.9, -0.4, 0.05, 0.3] {
            let (sin, cos) = libm::sincos(east);
            let d = normalised([cos, sin, 0.45]);
            let (n, mut exact) = (64, 0.0);
            for i in 0..n * n {
                let point = [i % n, i / n].map(|i| (i as f32 + 0.5) / n as f32);
                let isotropic = crate::lobe::Factor { d1: 1.0, d2: 0.0, d3: 1.0 };
                let o = crate::lobe::Region::Normal.offset(isotropic, point);
                let offset = [f64::from(o.u) * deviation, f64::from(o.v) * deviation, 1.0];
                exact += Surroundings::Studio.radiance(normalised(combine(offset, frame(d))))[0] / (n * n) as f64;
            }
            let found = environment.filtered(d, deviation)[0];
            assert!((found - exact).abs() < 0.15, "{deviation} {east}: {found} {exact}");
        }
    }
}
