//! The light of [`super::Surroundings::Studio`], in single precision and without branches, so that compilers vectorise
//! loops over directions.

/// The sine and the cosine of an angle in radians.
struct Turn {
    sine: f32,
    cosine: f32,
}

/// The elevation of the middles of the windows: 0.45.
const UP: Turn = Turn { sine: 0.434_965_55, cosine: 0.900_447_1 };

/// A window: how far east its middle is, half its width in radians, and its radiance.
struct Window {
    east: Turn,
    half_width: f32,
    radiance: f32,
}

/// The middles are at -0.4 and at 2.4.
const WINDOWS: [Window; 2] = [
    Window { east: Turn { sine: -0.389_418_34, cosine: 0.921_061 }, half_width: 0.45, radiance: 3.0 },
    Window { east: Turn { sine: 0.675_463_2, cosine: -0.737_393_7 }, half_width: 0.3, radiance: 1.8 },
];

/// Half the height of the windows in radians.
const HALF_HEIGHT: f32 = 0.35;

/// Half the width of the bars that divide a window into four panes.
const HALF_BAR: f32 = 0.03;

/// A sine of angles outside of all windows. [`arc_sine`] is accurate up to it.
const OUTSIDE: f32 = 0.5;

/// Returns the radiance from the direction `d`.
#[inline(always)]
pub fn radiance([x, y, z]: [f32; 3]) -> [f32; 3] {
    let wall = 0.10 + 0.08 * smooth_step(0.5 + 4.0 * z);
    let lamp = 2.5 * smooth_step((z - 0.94) / 0.03);
    let length = (x * x + y * y).sqrt();
    let up = arc_sine(z * UP.cosine - length * UP.sine);
    let mut light = lamp;
    for Window { east, half_width, radiance } in WINDOWS {
        let ahead = x * east.cosine + y * east.sine;
        let sine = (y * east.cosine - x * east.sine) / length.max(1e-9);
        let across = arc_sine(if ahead > 0.0 { sine } else { OUTSIDE });
        let panes = 1.0 - inside(across, HALF_BAR).max(inside(up, HALF_BAR));
        light += radiance * inside(across, half_width) * inside(up, HALF_HEIGHT) * panes;
    }
    [wall + light, wall + 0.97 * light, 1.1 * wall + 0.92 * light]
}

/// Returns 1 for angles in the middle of `half` on both sides of 0, and 0 outside, with smooth edges 0.04 wide.
#[inline(always)]
fn inside(angle: f32, half: f32) -> f32 {
    smooth_step((half - angle.abs()) / 0.04 + 0.5)
}

/// Returns 0 below 0, 1 above 1, and a smooth cubic between.
#[inline(always)]
fn smooth_step(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Returns the angle with this sine: the Taylor series up to the eleventh power, whose error is below 4e-6. Sines
/// beyond [`OUTSIDE`] count as `OUTSIDE`.
#[inline(always)]
fn arc_sine(sine: f32) -> f32 {
    let sine = sine.clamp(-OUTSIDE, OUTSIDE);
    let squared = sine * sine;
    let series = [945.0 / 42_240.0, 105.0 / 3456.0, 15.0 / 336.0, 3.0 / 40.0, 1.0 / 6.0, 1.0];
    let mut sum = 0.0;
    for term in series {
        sum = sum * squared + term;
    }
    sine * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the radiance by the angles of the direction, in double precision.
    fn exact(east: f64, up: f64) -> [f64; 3] {
        let smooth_step = |x: f64| {
            let x = x.clamp(0.0, 1.0);
            x * x * (3.0 - 2.0 * x)
        };
        let inside = |angle: f64, half: f64| smooth_step((half - angle.abs()) / 0.04 + 0.5);
        let window = |at: f64, half_width: f64| {
            let across = libm::remainder(east - at, std::f64::consts::TAU);
            let panes = 1.0 - inside(across, 0.03).max(inside(up - 0.45, 0.03));
            inside(across, half_width) * inside(up - 0.45, 0.35) * panes
        };
        let wall = 0.10 + 0.08 * smooth_step(0.5 + 4.0 * libm::sin(up));
        let lamp = 2.5 * smooth_step((libm::sin(up) - 0.94) / 0.03);
        let light = 3.0 * window(-0.4, 0.45) + 1.8 * window(2.4, 0.3) + lamp;
        [wall + light, wall + 0.97 * light, 1.1 * wall + 0.92 * light]
    }

    #[test]
    fn the_radiance_is_that_of_the_angles() {
        for i in -500..=500 {
            for j in -250..=250 {
                let (east, up) = (f64::from(i) * 0.006_28, f64::from(j) * 0.006_28);
                let [(sin_east, cos_east), (sin_up, cos_up)] = [libm::sincos(east), libm::sincos(up)];
                let d = [cos_up * cos_east, cos_up * sin_east, sin_up];
                let pairs = radiance(d.map(|c| c as f32)).into_iter().zip(exact(east, up));
                for (found, expected) in pairs {
                    // An error of 4e-6 in an angle changes the radiance 3 by at most 5e-4, and that of the lamp less.
                    assert!((f64::from(found) - expected).abs() < 1e-3, "{east} {up}: {found} {expected}");
                }
            }
        }
    }
}
