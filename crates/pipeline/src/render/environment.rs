//! Light from the surroundings: a procedural map, exact for rays, with levels of growing blur for filtered look-ups.

mod studio;

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

use crate::math::vector::{Vector, combine, frame, normalised};
use crate::simd::map_row;

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
            Self::Studio => studio::radiance(d.map(|c| c as f32)).map(f64::from),
            Self::Even(percent) => grey(f64::from(percent) / 100.0),
        }
    }

    /// Stores in `out` the radiance from each of `directions`, of which there are as many.
    pub fn radiance_row(self, directions: impl Iterator<Item = [f32; 3]>, out: &mut [[f32; 3]]) {
        match self {
            Self::Studio => map_row(
                directions,
                out,
                #[inline(always)]
                |[x, y, z]| studio::radiance([x, y, z]),
                |out, radiance| *out = radiance,
            ),
            _ => out.iter_mut().zip(directions).for_each(|(out, d)| {
                *out = self.radiance(d.map(f64::from)).map(|value| value as f32);
            }),
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

    /// Returns the surroundings without blur.
    pub fn surroundings(&self) -> Surroundings {
        self.surroundings
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
        // A full turn begins again with the first column. The rows at the poles are repeated.
        let west = if left < 0.0 { self.width - 1 } else { (left as usize).min(self.width - 1) };
        let east = if west + 1 < self.width { west + 1 } else { 0 };
        let upper = (top.max(0.0) as usize).min(self.height - 1);
        let lower = ((top + 1.0) as usize).min(self.height - 1);
        let row = |row: usize| {
            let texels = &self.texels[row * self.width..];
            mix(texels[west], texels[east], x - left)
        };
        mix(row(upper), row(lower), y - top)
    }
}

#[cfg(test)]
mod tests;
