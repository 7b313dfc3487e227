//! A pinhole camera.

use crate::math::vector::{Vector, cross, dot, normalised};

/// An eye and its picture plane. The world is right-handed, and z points up.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The position at which rays start.
    pub eye: Vector,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    forward: Vector,
    /// From the middle of the picture to its right edge, one unit ahead.
    right: Vector,
    /// From the middle of the picture to its upper edge, one unit ahead.
    up: Vector,
}

impl Camera {
    /// Makes a camera that looks from `eye` at `target`, with pictures of `size` pixels. `half_height` is half the
    /// height of the picture one unit ahead: the tangent of half the vertical angle of view.
    pub fn new(eye: Vector, target: Vector, half_height: f64, size: [u32; 2]) -> Self {
        let forward = normalised([target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]]);
        // If the camera looks straight down, the top of the picture is +y.
        let up = if forward[0] == 0.0 && forward[1] == 0.0 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
        let right = normalised(cross(forward, up));
        let half_width = half_height * f64::from(size[0]) / f64::from(size[1]);
        Self {
            eye,
            size,
            forward,
            right: right.map(|c| c * half_width),
            up: cross(right, forward).map(|c| c * half_height),
        }
    }

    /// Returns the unit vector from the eye through column `x`, row `y`. Middles of pixels are at halves; row 0 is the
    /// top.
    pub fn ray(&self, x: f64, y: f64) -> Vector {
        let across = 2.0 * x / f64::from(self.size[0]) - 1.0;
        let down = 2.0 * y / f64::from(self.size[1]) - 1.0;
        normalised([0, 1, 2].map(|i| self.forward[i] + across * self.right[i] - down * self.up[i]))
    }

    /// Returns how the vector to a point at `distance` on the ray of (`x`, `y`) changes with one column and with one
    /// row, on the plane through the point that is parallel to the picture.
    pub fn steps(&self, x: f64, y: f64, distance: f64) -> [Vector; 2] {
        let ahead = distance * dot(self.ray(x, y), self.forward);
        let [width, height] = self.size.map(f64::from);
        [self.right.map(|c| 2.0 * c * ahead / width), self.up.map(|c| -2.0 * c * ahead / height)]
    }
}
