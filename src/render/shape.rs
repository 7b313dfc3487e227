//! What is looked at: a plane, or a sphere, with the map on it.

use std::f64::consts::{PI, TAU};

use super::camera::Camera;
use super::sampler::Footprint;
use crate::math::vector::{Vector, combine, dot};

/// A surface and how the map lies on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// z = 0, with T along x and B along y, `repeats` of the map per unit.
    Plane {
        /// Repeats of the map per unit of length.
        repeats: f64,
    },
    /// The unit sphere about the origin, with T to the east and B to the north.
    Sphere {
        /// Repeats of the map around the equator; half as many from pole to pole.
        repeats: f64,
    },
}

/// Where a ray meets the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The point.
    pub position: Vector,
    /// T, B and N: orthonormal.
    pub frame: [Vector; 3],
    /// Texture coordinates, v down the image.
    pub uv: [f64; 2],
    /// Growth of u per unit along T, and of v per unit along -B.
    uv_per_unit: [f64; 2],
}

impl Shape {
    /// The nearest point of the surface on the ray from `eye` along the unit vector `ray`, seen from outside.
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
                let (east, ring) = (libm::atan2(n[1], n[0]), (n[0] * n[0] + n[1] * n[1]).sqrt().max(1e-6));
                let (sin, cos) = libm::sincos(east);
                let tangent = [-sin, cos, 0.0];
                Some(Hit {
                    position: n,
                    frame: [tangent, [-n[2] * cos, -n[2] * sin, ring], n],
                    uv: [east / TAU * repeats, libm::acos(n[2].clamp(-1.0, 1.0)) / PI * 0.5 * repeats],
                    uv_per_unit: [repeats / (TAU * ring), 0.5 * repeats / PI],
                })
            }
        }
    }
}

impl Hit {
    /// Texture coordinates covered by the pixel about (`x`, `y`) of `camera`, as hardware takes them from neighbouring
    /// pixels: where their rays meet the tangent plane.
    pub fn footprint(&self, camera: &Camera, x: f64, y: f64) -> Footprint {
        let on_plane = |x: f64, y: f64| {
            let ray = camera.ray(x, y);
            let away = [0, 1, 2].map(|i| self.position[i] - camera.eye[i]);
            let normal = self.frame[2];
            // At the horizon a neighbour's ray may miss the plane: as far away as the grazing ray that does not.
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

    /// A direction of the world in (T, B, N).
    pub fn to_tangent(&self, v: Vector) -> Vector {
        self.frame.map(|axis| dot(axis, v))
    }

    /// A direction in (T, B, N) in the world.
    pub fn to_world(&self, v: Vector) -> Vector {
        combine(v, self.frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vector::{cross, normalised};

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        let eye = [3.0, -2.0, 1.5];
        let ray = normalised([-0.95, 0.7, -0.4]);
        for shape in [Shape::Plane { repeats: 2.0 }, Shape::Sphere { repeats: 8.0 }] {
            let hit = shape.hit(eye, ray).expect("a hit");
            let [t, b, n] = hit.frame;
            let side = cross(t, b);
            assert!((dot(side, n) - 1.0).abs() < 1e-9 && dot(t, b).abs() < 1e-9, "{shape:?}");
            assert!(dot(ray, n) < 0.0);
        }
        assert_eq!(Shape::Plane { repeats: 1.0 }.hit(eye, [0.0, 1.0, 0.0]), None);
        assert_eq!(Shape::Sphere { repeats: 1.0 }.hit(eye, [0.0, 0.0, 1.0]), None);
    }

    /// From straight above at height 1, a picture 2 wide with 100 pixels has pixels 0.02 wide.
    #[test]
    fn footprints_of_known_size() {
        let camera = Camera::new([0.0, 0.0, 1.0], [0.0; 3], 1.0, [100, 100]);
        let hit = Shape::Plane { repeats: 3.0 }.hit(camera.eye, camera.ray(50.0, 50.0)).expect("a hit");
        let Footprint { across, down } = hit.footprint(&camera, 50.0, 50.0);
        assert!((across[0] - 0.06).abs() < 1e-9 && across[1].abs() < 1e-9, "{across:?}");
        assert!((down[1] - 0.06).abs() < 1e-9 && down[0].abs() < 1e-9, "{down:?}");
        // The equator of a sphere with 8 repeats around, from afar: 8 / tau repeats per unit.
        let camera = Camera::new([0.0, -1001.0, 0.0], [0.0; 3], 0.001, [100, 100]);
        let hit = Shape::Sphere { repeats: 8.0 }.hit(camera.eye, camera.ray(50.0, 50.0)).expect("a hit");
        let Footprint { across, down } = hit.footprint(&camera, 50.0, 50.0);
        assert!((across[0] - 0.02 * 8.0 / TAU).abs() < 1e-6, "{across:?}");
        assert!((down[1] - 0.02 * 4.0 / PI).abs() < 1e-6, "{down:?}");
    }
}
