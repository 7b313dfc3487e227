//! Shading of many samples of GGX lobes at a time, with the vectors of the processor.
//!
//! The equations are those of [`super::shade`], in single precision and without branches. *Local* coordinates are those
//! in the frame of a bump's normal, and *tangent* coordinates those in the frame (T, B, N) of the surface.

use super::facets::Facet;
use super::scene::{Light, Scene};
use super::shade::MIN_FACING;
use super::shape::Shape;
use crate::math::vector::{cross, dot};
use crate::metric::MIN_ALPHA;
use crate::simd::map_row;

type Vector = [f32; 3];

/// One sample of a point of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The point.
    pub position: Vector,
    /// The bump, tangent.
    pub bump: Facet,
    /// The point of the unit square that samples a facet of the lobe.
    pub at: [f32; 2],
}

/// A shaded sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShadedSample {
    /// The direction in the world from which the facet reflects light to the eye.
    pub from: Vector,
    /// Weight of the radiance from there; 0 if the facet reflects none.
    pub weight: f32,
    /// The radiance that the point reflects from the light of the scene.
    pub of_light: f32,
    /// The projected area of the bump ([`super::View::visible_area`]).
    pub area: f32,
}

/// What all samples of a scene have in common.
pub struct SampleShader {
    is_plane: bool,
    eye: Vector,
    /// The vector to the light is `source` minus `nearness` times the position: 1 for a light at a point, 0 for
    /// parallel rays.
    source: Vector,
    nearness: f32,
    /// Irradiance at distance 1.
    intensity: f32,
    /// Reflectance at normal incidence.
    f0: f32,
}

impl SampleShader {
    /// Returns the shader of `scene` for the reflectance `f0` at normal incidence.
    pub fn new(scene: &Scene, f0: f64) -> Self {
        let (source, nearness, intensity) = match scene.light {
            None => ([0.0, 0.0, 1.0], 0.0, 0.0),
            Some(Light::Directional { toward, irradiance, .. }) => (toward, 0.0, irradiance),
            Some(Light::Point { position, intensity }) => (position, 1.0, intensity),
        };
        Self {
            is_plane: matches!(scene.shape, Shape::Plane { .. }),
            eye: scene.camera.eye.map(|c| c as f32),
            source: source.map(|c| c as f32),
            nearness,
            intensity: intensity as f32,
            f0: f0 as f32,
        }
    }

    /// Shades each of `samples`, and stores the results in `out`, which is as long.
    pub fn shade(&self, samples: &[Sample], out: &mut [ShadedSample]) {
        let numbers = samples.iter().map(|sample| {
            let Sample { position: [x, y, z], bump, at: [radial, azimuth] } = *sample;
            let Facet { normal: [nx, ny, nz], squared_alpha: [uu, uv, vv] } = bump;
            [x, y, z, nx, ny, nz, uu, uv, vv, radial, azimuth]
        });
        map_row(
            numbers,
            out,
            #[inline(always)]
            |numbers| self.shade_one(numbers),
            |out, [x, y, z, weight, of_light, area]| *out = ShadedSample { from: [x, y, z], weight, of_light, area },
        );
    }

    #[inline(always)]
    fn shade_one(&self, [x, y, z, nx, ny, nz, uu, uv, vv, radial, azimuth]: [f32; 11]) -> [f32; 6] {
        let position = [x, y, z];
        let frame = self.frame(position);
        let view = unit([self.eye[0] - x, self.eye[1] - y, self.eye[2] - z]);
        let point = LocalPoint::new([nx, ny, nz], [uu, uv, vv], to_frame(view, frame));
        let facet = point.sample_visible_facet(radial, azimuth);
        let (from, weight) = point.reflect(facet, self.f0);
        let from = from_frame(from, frame);
        let s = self.nearness;
        let to_light = [self.source[0] - s * x, self.source[1] - s * y, self.source[2] - s * z];
        let irradiance = self.intensity / dot(to_light, to_light).max(1e-12);
        let of_light = irradiance * point.brdf(to_frame(unit(to_light), frame), self.f0);
        [from[0], from[1], from[2], weight, of_light, point.visible_area()]
    }

    /// Returns T, B and N of the surface. No position is a pole of the sphere.
    #[inline(always)]
    fn frame(&self, [x, y, z]: Vector) -> [Vector; 3] {
        if self.is_plane {
            return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        }
        let ring = (x * x + y * y).sqrt();
        let scale = 1.0 / ring;
        let [cos, sin] = [scale * x, scale * y];
        [[-sin, cos, 0.0], [-z * cos, -z * sin, ring], [x, y, z]]
    }
}

/// Converts a vector to its coordinates in `frame`.
#[inline(always)]
fn to_frame(v: Vector, [x, y, z]: [Vector; 3]) -> Vector {
    [dot(x, v), dot(y, v), dot(z, v)]
}

/// Converts a vector from its coordinates in `frame`.
#[inline(always)]
fn from_frame([x, y, z]: Vector, [t, b, n]: [Vector; 3]) -> Vector {
    [x * t[0] + y * b[0] + z * n[0], x * t[1] + y * b[1] + z * n[1], x * t[2] + y * b[2] + z * n[2]]
}

/// A point with its lobe, as seen from one direction, in local coordinates.
struct LocalPoint {
    /// T, B and N of the bump, tangent.
    axes: [Vector; 3],
    /// Unit vector to the eye. Its z is n.v.
    view: Vector,
    /// The squared alphas.
    a: [f32; 3],
    /// Lambda of the direction to the eye.
    hidden: f32,
}

impl LocalPoint {
    #[inline(always)]
    fn new(normal: Vector, [uu, uv, vv]: [f32; 3], view: Vector) -> Self {
        let missing = (MIN_FACING as f32 - dot(normal, view)).max(0.0);
        let [nx, ny, nz] = normal;
        let normal = unit([nx + missing * view[0], ny + missing * view[1], nz + missing * view[2]]);
        let [t, b] = tangents(normal);
        let view = [dot(t, view), dot(b, view), dot(normal, view).max(1e-6)];
        // The smaller eigenvalue of A is at least the squared smallest alpha.
        let (mean, half) = (0.5 * (uu + vv), 0.5 * (uu - vv));
        let lack = (MIN_ALPHA * MIN_ALPHA) as f32 - (mean - (half * half + uv * uv).sqrt());
        let lack = lack.max(0.0);
        let a = [uu + lack, uv, vv + lack];
        Self { axes: [t, b, normal], view, a, hidden: lambda(a, view) }
    }

    #[inline(always)]
    fn visible_area(&self) -> f32 {
        self.view[2] / self.axes[2][2].max(MIN_FACING as f32)
    }

    /// Works like [`super::shade::VisibleFacets`].
    #[inline(always)]
    fn sample_visible_facet(&self, radial: f32, azimuth: f32) -> Vector {
        let [uu, uv, vv] = self.a;
        let l = uu.sqrt();
        let (m, r) = (uv / l, (vv - uv * uv / uu).max(0.0).sqrt());
        let [x, y, z] = self.view;
        let eye = unit([l * x + m * y, r * y, z]);
        let length = (eye[0] * eye[0] + eye[1] * eye[1]).sqrt();
        let is_upright = length < 1e-12;
        let scale = 1.0 / length.max(1e-12);
        let first = [if is_upright { 1.0 } else { -scale * eye[1] }, scale * eye[0], 0.0];
        let second = cross(eye, first);
        let [sin, cos] = sin_cos(azimuth);
        let radius = radial.sqrt();
        let (p, q) = (radius * cos, radius * sin);
        let share = 0.5 * (1.0 + eye[2]);
        let q = (1.0 - share) * (1.0 - p * p).max(0.0).sqrt() + share * q;
        let up = (1.0 - p * p - q * q).max(0.0).sqrt();
        let [x, y, z] = from_frame([p, q, up], [first, second, eye]);
        unit([l * x, m * x + r * y, z.max(1e-6)])
    }

    /// Returns the tangent direction from which `facet` reflects light to the eye, and the weight of that light.
    #[inline(always)]
    fn reflect(&self, facet: Vector, f0: f32) -> (Vector, f32) {
        let seen = dot(self.view, facet);
        let [x, y, z] = self.view;
        let from = [2.0 * seen * facet[0] - x, 2.0 * seen * facet[1] - y, 2.0 * seen * facet[2] - z];
        let weight = fresnel(seen, f0) * (1.0 + self.hidden) / (1.0 + self.hidden + lambda(self.a, from));
        let weight = if seen.min(from[2]) > 0.0 { weight } else { 0.0 };
        (from_frame(from, self.axes), weight)
    }

    /// Returns the BRDF for the tangent unit vector `light` to the light, times the cosine.
    #[inline(always)]
    fn brdf(&self, light: Vector, f0: f32) -> f32 {
        let light = to_frame(light, self.axes);
        let [x, y, z] = unit([self.view[0] + light[0], self.view[1] + light[1], self.view[2] + light[2]]);
        let [uu, uv, vv] = self.a;
        let determinant = uu * vv - uv * uv;
        // q is |A| times the sum in GGX, so that D = |A|^(3/2) / (pi q^2). D, G and 4 (n.v) share one division.
        let q = vv * x * x - 2.0 * uv * x * y + uu * y * y + determinant * z * z;
        let hidden = 1.0 + self.hidden + lambda(self.a, light);
        let seen = dot(self.view, [x, y, z]);
        let share = determinant * determinant.sqrt() * fresnel(seen, f0)
            / (4.0 * std::f32::consts::PI * q * q * hidden * self.view[2]);
        if light[2] > 0.0 { share } else { 0.0 }
    }
}

/// Returns Lambda of the local direction `d`: how much of the surface other bumps hide from there.
#[inline(always)]
fn lambda([uu, uv, vv]: [f32; 3], [x, y, z]: Vector) -> f32 {
    let squared = (uu * x * x + 2.0 * uv * x * y + vv * y * y) / (z * z);
    0.5 * ((1.0 + squared).sqrt() - 1.0)
}

#[inline(always)]
fn fresnel(seen: f32, f0: f32) -> f32 {
    let x = (1.0 - seen).clamp(0.0, 1.0);
    f0 + (1.0 - f0) * (x * x) * (x * x) * x
}

#[inline(always)]
fn unit(v: Vector) -> Vector {
    let scale = 1.0 / dot(v, v).sqrt();
    [v[0] * scale, v[1] * scale, v[2] * scale]
}

/// Returns T and B of the frame of a unit normal, as `math::vector::frame` does.
#[inline(always)]
fn tangents([x, y, z]: Vector) -> [Vector; 2] {
    // 1 - x^2 without cancellation.
    let squared = y * y + z * z;
    let is_along_t = squared < 1e-12;
    let length = squared.max(1e-12).sqrt();
    let scale = x / length;
    let t = [length, -scale * y, if is_along_t { -1.0 } else { -scale * z }];
    [t, cross([x, y, z], t)]
}

/// Returns sine and cosine of `turns` full turns, from 0 to 1.
#[inline(always)]
fn sin_cos(turns: f32) -> [f32; 2] {
    let (s, c) = (turns - 0.5, turns - 0.25);
    // Both functions are minus the sine of an angle, which is mirrored into the quarter turns on both sides of 0.
    [-sine_near_0(s.max(-0.5 - s).min(0.5 - s)), -sine_near_0(c.min(0.5 - c))]
}

/// Returns the sine of `turns` full turns, from -1/4 to 1/4: the Taylor series up to the eleventh power, whose error is
/// below 6e-8.
#[inline(always)]
fn sine_near_0(turns: f32) -> f32 {
    let x = std::f32::consts::TAU * turns;
    let squared = x * x;
    let series = [-1.0 / 39_916_800.0, 1.0 / 362_880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0, 1.0];
    let mut sum = 0.0;
    for term in series {
        sum = sum * squared + term;
    }
    x * sum
}

#[cfg(test)]
mod tests;
