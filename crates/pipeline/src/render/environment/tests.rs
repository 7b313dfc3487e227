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

/// The radiance of most directions is found without angles. If such a direction showed a window, light would end
/// suddenly there.
#[test]
fn windows_of_the_studio_end_smoothly() {
    let radiance = |east: f64, up: f64| {
        let [(sin_east, cos_east), (sin_up, cos_up)] = [libm::sincos(east), libm::sincos(up)];
        Surroundings::Studio.radiance([cos_up * cos_east, cos_up * sin_east, sin_up])[0]
    };
    // A smooth step has slopes up to 1.5, edges of windows are 0.04 wide, and the brightest window has the radiance 3.
    let step = 1e-4;
    let most = 1.05 * 3.0 * 1.5 * step / 0.04;
    for i in -32_000..32_000 {
        let at = f64::from(i) * step;
        // Once around at an elevation without a bar, and up through each window beside its bar.
        for [a, b] in [[(at, 0.3), (at + step, 0.3)], [(-0.2, at), (-0.2, at + step)], [(2.5, at), (2.5, at + step)]] {
            // Above 0.9 the light of the lamp would grow.
            if a.1.abs() < 0.9 {
                let [here, beside] = [a, b].map(|(east, up)| radiance(east, up));
                assert!((beside - here).abs() < most, "{a:?}: {here} {beside}");
            }
        }
    }
}
