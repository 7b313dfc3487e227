//! Light from the surroundings: a procedural map, exact for rays, with levels of growing blur for filtered look-ups.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

use crate::math::vector::{Vector, combine, frame, normalised};

/// Radiance in red, green and blue.
pub type Radiance = [f64; 3];

/// The surroundings of a scene. Directions are unit vectors, and z points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Surroundings {
    /// A clear night: dark, brighter towards the horizon. The lower half mirrors the upper half, because rays that
    /// waves reflect downwards would hit the next wave.
    Night,
    /// Black and white winding stripes, as on a zebra.
    Stripes,
    /// A room with two bright windows and a lamp overhead.
    Studio,
    /// Constant radiance from all directions, in hundredths.
    Even(u8),
}

impl Surroundings {
    /// Returns the radiance from the direction `d`.
    pub fn radiance(self, d: Vector) -> Radiance {
        let grey = |value: f64| [value; 3];
        match self {
            Self::Night => {
                let height = d[2].abs();
                let glow = libm::exp(-6.0 * height);
                [0.008 + 0.022 * glow, 0.012 + 0.030 * glow, 0.024 + 0.040 * glow]
            }
            Self::Stripes => {
                let (east, up) = (libm::atan2(d[1], d[0]), libm::asin(d[2].abs().min(1.0)));
                let phase = 15.0 * east + 2.2 * libm::sin(9.0 * up + 3.0 * libm::sin(2.0 * east));
                let edge = 6.0 * libm::sin(phase);
                grey(0.03 + 0.94 * smooth_step(0.5 + 0.5 * edge))
            }
            Self::Studio => {
                let lamp = smooth_step((d[2] - 0.94) / 0.03);
                let wall = 0.10 + 0.08 * smooth_step(0.5 + 4.0 * d[2]);
                let room = |light: f64| [wall + light, wall + 0.97 * light, 1.1 * wall + 0.92 * light];
                // Most directions need no angles: they are below or above the windows, whose angles of elevation are
                // 0.08 to 0.82, or beside them. The windows end 0.47 and 0.32 beside their middles, which are at -0.4
                // and 2.4. The cosines of 0.47 and 0.32 are 0.8916 and 0.9492. The ones here leave a margin of 0.01.
                let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
                let is_toward = |x: f64, y: f64, cosine: f64| d[0] * x + d[1] * y >= cosine * length;
                let is_beside = !is_toward(0.92106, -0.38942, 0.88699) && !is_toward(-0.73739, 0.67546, 0.94604);
                if is_beside || !(0.0799..=0.7312).contains(&d[2]) {
                    return room(2.5 * lamp);
                }
                let (east, up) = (libm::atan2(d[1], d[0]), libm::asin(d[2]));
                let window = |at: f64, half_width: f64| {
                    let beside = east - at;
                    let across = if beside < -PI { beside + TAU } else { beside };
                    let inside = |x: f64, half: f64| smooth_step((half - x.abs()) / 0.04 + 0.5);
                    // A bar down and a bar across make four panes.
                    let panes = 1.0 - inside(across, 0.03).max(inside(up - 0.45, 0.03));
                    inside(across, half_width) * inside(up - 0.45, 0.35) * panes
                };
                room(3.0 * (window(-0.4, 0.45) + 0.6 * window(2.4, 0.3)) + 2.5 * lamp)
            }
            Self::Even(percent) => grey(f64::from(percent) / 100.0),
        }
    }
}

/// Returns 0 below 0, 1 above 1, and a smooth cubic between.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Columns of the finest level, whose texels are 0.7 degrees wide.
const WIDTH: usize = 512;

/// Surroundings with all levels of blur. Texels of level l are t = TAU / 512 2^l radians wide. A look-up with bilinear
/// interpolation blurs the radiance by a normal distribution of deviation t. Levels have twice the resolution of
/// box-filtered mips, since a blur of half a texel would depend on the position of a look-up between texels.
pub struct Environment {
    surroundings: Surroundings,
    levels: Vec<Panorama>,
}

/// Radiance on a grid of directions: columns go east from -pi, rows go down from the zenith.
struct Panorama {
    width: usize,
    height: usize,
    texels: Vec<Radiance>,
}

impl Environment {
    /// Computes all levels of `surroundings`.
    pub fn new(surroundings: Surroundings) -> Self {
        let first =
            Panorama::new(WIDTH, |d, texel| blurred(d, (5.0f64 / 6.0).sqrt() * texel, |d| surroundings.radiance(d)));
        let mut levels = vec![first];
        while let Some(finer) = levels.last().filter(|l| l.height > 4) {
            // The finer level already has a variance of 1/4 of a squared texel.
            let coarser = Panorama::new(finer.width / 2, |d, texel| {
                blurred(d, (5.0f64 / 6.0 - 0.25).sqrt() * texel, |d| finer.bilinear(angles(d)))
            });
            levels.push(coarser);
        }
        Self { surroundings, levels }
    }

    /// Returns the exact radiance from the direction `d`.
    pub fn radiance(&self, d: Vector) -> Radiance {
        self.surroundings.radiance(d)
    }

    /// Returns the radiance about the unit vector `d`, blurred by `deviation` (radians) in every direction, with
    /// trilinear interpolation.
    pub fn filtered(&self, d: Vector, deviation: f64) -> Radiance {
        let texel = TAU / WIDTH as f64;
        let level = libm::log2((deviation / texel).max(1e-9));
        let angles = angles(d);
        if level <= 0.0 {
            // Interpolates between the exact radiance and the finest level.
            let (exact, share) = (self.radiance(d), deviation / texel);
            return mix(exact, self.levels[0].bilinear(angles), share.clamp(0.0, 1.0));
        }
        let level = level.min((self.levels.len() - 1) as f64);
        let (fine, share) = (level as usize, level - level.floor());
        let value = self.levels[fine].bilinear(angles);
        match self.levels.get(fine + 1) {
            Some(coarse) if share > 0.0 => mix(value, coarse.bilinear(angles), share),
            _ => value,
        }
    }
}

/// Returns the angles of the unit vector `d` east of -pi, and down from the zenith.
fn angles(d: Vector) -> [f64; 2] {
    [libm::atan2(d[1], d[0]) + PI, libm::acos(d[2].clamp(-1.0, 1.0))]
}

fn mix(a: Radiance, b: Radiance, share: f64) -> Radiance {
    [0, 1, 2].map(|c| a[c] + share * (b[c] - a[c]))
}

/// Returns the mean of `radiance` over a normal distribution about `d`, by the product of two three-point Gauss-Hermite
/// rules, which is exact for polynomials of degree 5.
fn blurred(d: Vector, deviation: f64, radiance: impl Fn(Vector) -> Radiance) -> Radiance {
    let axes = frame(d);
    let mut sum = [0.0; 3];
    let nodes = [(-3f64.sqrt(), 1.0 / 6.0), (0.0, 2.0 / 3.0), (3f64.sqrt(), 1.0 / 6.0)];
    for (x, weight_x) in nodes {
        for (y, weight_y) in nodes {
            let value = radiance(normalised(combine([x * deviation, y * deviation, 1.0], axes)));
            sum = [0, 1, 2].map(|c| sum[c] + weight_x * weight_y * value[c]);
        }
    }
    sum
}

impl Panorama {
    /// Evaluates `radiance(direction, width of a texel in radians)` at the middle of each texel.
    fn new(width: usize, radiance: impl Fn(Vector, f64) -> Radiance + Sync) -> Self {
        let height = width / 2;
        let texel = TAU / width as f64;
        let direction = |i: usize| {
            let (sin_east, cos_east) = libm::sincos(((i % width) as f64 + 0.5) * texel - PI);
            let (sin_down, cos_down) = libm::sincos(((i / width) as f64 + 0.5) * texel);
            [sin_down * cos_east, sin_down * sin_east, cos_down]
        };
        let texels = (0..width * height).into_par_iter().map(|i| radiance(direction(i), texel)).collect();
        Self { width, height, texels }
    }

    /// Returns the radiance at the [`angles`] of a direction.
    fn bilinear(&self, angles: [f64; 2]) -> Radiance {
        let texel = TAU / self.width as f64;
        let [x, y] = angles.map(|angle| angle / texel - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let at = |dx: f64, dy: f64| {
            let column = (left + dx).rem_euclid(self.width as f64) as usize % self.width;
            // The rows at the poles are repeated.
            let row = (top + dy).clamp(0.0, self.height as f64 - 1.0) as usize;
            self.texels[row * self.width + column]
        };
        let upper = mix(at(0.0, 0.0), at(1.0, 0.0), x - left);
        let lower = mix(at(0.0, 1.0), at(1.0, 1.0), x - left);
        mix(upper, lower, y - top)
    }
}

#[cfg(test)]
mod tests;
