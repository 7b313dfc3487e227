//! The surfaces of scenes: a plane or a sphere with the map on it.

use std::f64::consts::{PI, TAU};

use super::camera::Camera;
use super::sampler::Footprint;
use crate::math::vector::{Vector, combine, dot};

/// A surface and its texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// The plane z = 0, with T along x and B along y.
    Plane {
        /// Repeats of the map per unit of length.
        repeats: f64,
    },
    /// The unit sphere about the origin, with T pointing east and B pointing north.
    Sphere {
        /// Repeats of the map around the equator, with half as many from pole to pole.
        repeats: f64,
    },
}

/// The point at which a ray meets the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The point.
    pub position: Vector,
    /// T, B and N: orthonormal.
    pub frame: [Vector; 3],
    /// Texture coordinates; v grows downwards in the image.
    pub uv: [f64; 2],
    /// Growth of u per unit along T, and of v per unit along -B.
    uv_per_unit: [f64; 2],
}

impl Shape {
    /// Returns the nearest point of the surface, seen from outside, on the ray from `eye` along the unit vector `ray`.
    pub fn hit(&self, eye: Vector, ray: Vector) -> Option<Hit> {
        match *self {
            Self::Plane { repeats } => {
                let t = -eye[2] / ray[2];
                if ray[2] >= 0.0 || !t.is_finite() {
                    return None;
                }
                let position = [eye[0] + t * ray[0], eye[1] + t * ray[1], 0.0];
                Some(Hit {
                    position,
                    frame: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                    uv: [position[0] * repeats, -position[1] * repeats],
                    uv_per_unit: [repeats; 2],
                })
            }
            Self::Sphere { repeats } => {
                let middle = -dot(eye, ray);
                let inside = 1.0 - (dot(eye, eye) - middle * middle);
                if inside < 0.0 || middle < inside.sqrt() {
                    return None;
                }
                let t = middle - inside.sqrt();
                let n = [0, 1, 2].map(|i| eye[i] + t * ray[i]);
                let ring = (n[0] * n[0] + n[1] * n[1]).sqrt().max(1e-6);
                // At the poles, where east is any direction, T points to +y.
                let [cos, sin] = if ring > 1e-6 { [n[0] / ring, n[1] / ring] } else { [1.0, 0.0] };
                let tangent = [-sin, cos, 0.0];
                Some(Hit {
                    position: n,
                    frame: [tangent, [-n[2] * cos, -n[2] * sin, ring], n],
                    uv: [libm::atan2(n[1], n[0]), libm::acos(n[2].clamp(-1.0, 1.0))].map(|angle| angle / TAU * repeats),
                    uv_per_unit: [repeats / (TAU * ring), 0.5 * repeats / PI],
                })
            }
        }
    }
}

impl Hit {
    /// Returns the footprint of the pixel about (`x`, `y`) of `camera` in texture coordinates. As in hardware, the
    /// footprint is the difference between neighbouring pixels, whose rays meet the tangent plane.
    pub fn footprint(&self, camera: &Camera, x: f64, y: f64) -> Footprint {
        let on_plane = |x: f64, y: f64| {
            let ray = camera.ray(x, y);
            let away = [0, 1, 2].map(|i| self.position[i] - camera.eye[i]);
            let normal = self.frame[2];
            // At the horizon a neighbour's ray may miss the plane. The limit gives it a distant point on the plane.
            let slope = dot(ray, normal).min(-1e-6);
            let t = dot(away, normal) / slope;
            let point = [0, 1, 2].map(|i| t * ray[i] - away[i]);
            [dot(point, self.frame[0]) * self.uv_per_unit[0], -dot(point, self.frame[1]) * self.uv_per_unit[1]]
        };
        let difference = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
        Footprint {
            across: difference(on_plane(x + 0.5, y), on_plane(x - 0.5, y)),
            down: difference(on_plane(x, y + 0.5), on_plane(x, y - 0.5)),
        }
    }

    /// Converts a direction from the world to (T, B, N).
    pub fn to_tangent(&self, v: Vector) -> Vector {
        self.frame.map(|axis| dot(axis, v))
    }

    /// Converts a direction from (T, B, N) to the world.
    pub fn to_world(&self, v: Vector) -> Vector {
        combine(v, self.frame)
    }
}

#[cfg(test)]
mod tests;
