//! The part of the surface that one pixel shows. It finds where many rays meet the surface at a time, with the vectors
//! of the processor.
//!
//! Numbers are relative to the point p that the middle of the pixel shows, so that single precision suffices. A ray g
//! passes p at a vector a; it meets the unit sphere at q + e g with q = p + a and
//! e = (|q|^2 - 1) / (-q.g + sqrt((q.g)^2 - |g|^2 (|q|^2 - 1))), where |q|^2 - 1 = 2 p.a + |a|^2.

use super::camera::Camera;
use super::shape::{Hit, Shape};
use crate::math::vector::dot;
use crate::simd::map_row;

type Vector = [f32; 3];

/// A point of the surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct PatchPoint {
    /// The point.
    pub position: Vector,
    /// Texture coordinates modulo 1: 0 to 1.
    pub uv: [f32; 2],
    /// How the ray meets the surface.
    pub meeting: Meeting,
}

/// How a ray meets the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Meeting {
    /// The ray misses the surface.
    #[default]
    Miss,
    /// The ray meets the surface at the point.
    Hit,
    /// The point is too far from the middle of the pixel. [`Shape::hit`] finds it.
    Far,
}

/// The part of the surface that a pixel shows.
pub struct Patch {
    is_plane: bool,
    /// The point in the middle.
    position: Vector,
    /// From the eye to that point.
    ahead: Vector,
    /// Change of `ahead` from this pixel to the one on the right, and to the one below.
    steps: [Vector; 2],
    /// Texture coordinates of the middle, modulo 1.
    uv: [f32; 2],
    /// Repeats of the map per unit of the plane, or per radian of the sphere.
    repeats: f32,
}

impl Patch {
    /// Returns the patch of the pixel whose upper left corner is at (`x`, `y`), and whose middle shows the point
    /// `middle`.
    pub fn new(shape: Shape, camera: &Camera, [x, y]: [f64; 2], middle: &Hit) -> Self {
        let narrow = |v: [f64; 3]| v.map(|c| c as f32);
        let (is_plane, repeats) = match shape {
            Shape::Plane { repeats } => (true, repeats),
            Shape::Sphere { repeats } => (false, repeats / std::f64::consts::TAU),
        };
        let ahead = [0, 1, 2].map(|i| middle.position[i] - camera.eye[i]);
        let steps = camera.steps(x + 0.5, y + 0.5, dot(ahead, ahead).sqrt());
        Self {
            is_plane,
            position: narrow(middle.position),
            ahead: narrow(ahead),
            steps: steps.map(narrow),
            uv: middle.uv.map(|c| (c - c.floor()) as f32),
            repeats: repeats as f32,
        }
    }

    /// Finds the points at `places` in the pixel, from (0, 0) to (1, 1), and stores them in `out`, which has as many.
    pub fn trace(&self, places: impl Iterator<Item = [f32; 2]>, out: &mut [PatchPoint]) {
        // Compilers do not vectorise a loop that chooses between the shapes.
        if self.is_plane {
            trace_with(
                places,
                out,
                #[inline(always)]
                |place| self.on_plane(place),
            );
        } else {
            trace_with(
                places,
                out,
                #[inline(always)]
                |place| self.on_sphere(place),
            );
        }
    }

    /// Returns the vector from the middle of the pixel to a place in it, at the distance of the surface.
    #[inline(always)]
    fn beside(&self, [x, y]: [f32; 2]) -> Vector {
        let [right, down] = self.steps;
        let (x, y) = (x - 0.5, y - 0.5);
        [x * right[0] + y * down[0], x * right[1] + y * down[1], x * right[2] + y * down[2]]
    }

    #[inline(always)]
    fn on_plane(&self, place: [f32; 2]) -> [f32; 6] {
        let a = self.beside(place);
        let ray = add(self.ahead, a);
        let e = -a[2] / ray[2];
        let [x, y] = [a[0] + e * ray[0], a[1] + e * ray[1]];
        let [u, v] = [fraction(self.uv[0] + x * self.repeats), fraction(self.uv[1] - y * self.repeats)];
        let meeting = if ray[2] < 0.0 { HIT } else { MISS };
        [self.position[0] + x, self.position[1] + y, 0.0, u, v, meeting]
    }

    #[inline(always)]
    fn on_sphere(&self, place: [f32; 2]) -> [f32; 6] {
        let a = self.beside(place);
        let (from, ray) = (self.position, add(self.ahead, a));
        let q = add(from, a);
        let outside = 2.0 * dot(from, a) + dot(a, a);
        let toward = -dot(q, ray);
        let inside = toward * toward - dot(ray, ray) * outside;
        let e = outside / (toward + inside.max(0.0).sqrt());
        let offset = [a[0] + e * ray[0], a[1] + e * ray[1], a[2] + e * ray[2]];
        let to = add(from, offset);
        // The sine of the angle down from `from` and the tangent of the angle east, both without cancellation.
        let ring = (from[0] * from[0] + from[1] * from[1]).sqrt();
        let along = from[0] * offset[0] + from[1] * offset[1];
        let wider = 2.0 * along + offset[0] * offset[0] + offset[1] * offset[1];
        let growth = wider / ((to[0] * to[0] + to[1] * to[1]).sqrt() + ring);
        let sine = growth * from[2] - offset[2] * ring;
        let tangent = (from[0] * offset[1] - from[1] * offset[0]) / (ring * ring + along);
        // Taylor series of the arc tangent and the arc sine up to the seventh power. For numbers below 0.05 their error
        // is below 3e-13.
        let squared = tangent * tangent;
        let east = tangent * (1.0 - squared * (1.0 / 3.0 - squared * (1.0 / 5.0 - squared / 7.0)));
        let squared = sine * sine;
        let down = sine * (1.0 + squared * (1.0 / 6.0 + squared * (3.0 / 40.0 + squared * 15.0 / 336.0)));
        let [u, v] = [fraction(self.uv[0] + east * self.repeats), fraction(self.uv[1] + down * self.repeats)];
        // The comparisons are false if the numbers are NaN, as at a pole, so that such a point is far.
        let is_near = tangent.abs().max(sine.abs()) < 0.05 && ring * ring + along > 0.0;
        let met = if is_near { HIT } else { FAR };
        let meeting = if inside.min(toward) < 0.0 { MISS } else { met };
        [to[0], to[1], to[2], u, v, meeting]
    }
}

/// Stores in `out` the points that `meet` finds: position, texture coordinates, and the meeting as a number.
fn trace_with(places: impl Iterator<Item = [f32; 2]>, out: &mut [PatchPoint], meet: impl Fn([f32; 2]) -> [f32; 6]) {
    map_row(places, out, meet, |out, [x, y, z, u, v, meeting]| {
        let meeting = match meeting {
            HIT => Meeting::Hit,
            FAR => Meeting::Far,
            _ => Meeting::Miss,
        };
        *out = PatchPoint { position: [x, y, z], uv: [u, v], meeting };
    });
}

/// [`Meeting`] as a number in a vector of numbers.
const MISS: f32 = 0.0;
const HIT: f32 = 1.0;
const FAR: f32 = 2.0;

#[inline(always)]
fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Returns `x` modulo 1.
#[inline(always)]
fn fraction(x: f32) -> f32 {
    x - x.floor()
}

#[cfg(test)]
mod tests;
