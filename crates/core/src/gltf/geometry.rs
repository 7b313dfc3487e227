//! The layout of a material on its meshes: the lengths of p_u and p_v and the tangent rotation (paper, "The Local
//! Coordinate System").

use std::ops::RangeInclusive;

use super::material::Mapping;
use super::meshes::Meshes;
use super::triangles::{Accessors, Vertex, length, minus, tangents};
use crate::math::vector::{cross, dot};

/// The layout of texture coordinates on the triangles of a material, averaged over their area in mesh space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Mean of |p_u| and |p_v|: mesh units per repeat of the texture, across and up.
    pub units_per_repeat: [f32; 2],
    /// The tangent rotation: mean cosine and sine of the angle from e1 to the tangent, for the given main direction.
    pub tangent_rotation: [f32; 2],
    /// Root mean square deviation of single triangles from `tangent_rotation`: 0 if the angle is equal everywhere, and
    /// 1.4 if angles are arbitrary or texture coordinates are mirrored.
    pub rotation_deviation: f32,
}

/// Valid units per repeat. Outside this range, offsets in mesh units and their squares leave the range of floats.
const UNITS: RangeInclusive<f32> = 1e-9..=1e9;

/// Measures the triangles that use material `material`. `main_direction` is m, in mesh space. `buffer` returns the
/// bytes of a buffer. Returns `None` if no triangle has positions and the texture coordinates of `mapping`, if all
/// triangles are degenerate, or if a repeat is shorter than 1e-9 units or longer than 1e9.
pub fn layout<'a>(
    meshes: &Meshes<'_>,
    material: usize,
    mapping: &Mapping,
    main_direction: [f32; 3],
    buffer: &dyn Fn(usize) -> Option<&'a [u8]>,
) -> Option<Layout> {
    let mut sums = Sums::default();
    Accessors { meshes, buffer }.visit_material(material, mapping, |primitive, triangle| {
        sums.add(triangle, f64::from(primitive.times), main_direction.map(f64::from));
    });
    sums.layout()
}

#[derive(Default)]
struct Sums {
    area: f64,
    lengths: [f64; 2],
    /// Sums of cosine and sine of the tangent rotation, weighted by area.
    rotation: [f64; 2],
    rotation_area: f64,
}

impl Sums {
    fn add(&mut self, triangle: [Vertex; 3], times: f64, m: [f64; 3]) {
        let Some([p_u, p_v]) = tangents(triangle) else { return };
        let [a, b, c] = triangle.map(|v| v.position);
        let normal = cross(minus(b, a), minus(c, a));
        let area = 0.5 * length(normal);
        if area <= 0.0 {
            return;
        }
        let (u, v) = (length(p_u), length(p_v));
        if u <= 0.0 || v <= 0.0 || !(u + v).is_finite() {
            return;
        }
        let n = normal.map(|x| x / (2.0 * area));
        let area = times * area;
        self.area += area;
        self.lengths[0] += area * u;
        self.lengths[1] += area * v;

        let across = cross(m, n);
        let across_length = length(across);
        if across_length > 0.0 {
            let axis_1 = across.map(|x| x / across_length);
            let axis_2 = cross(n, axis_1);
            let (t, b) = (p_u.map(|x| x / u), p_v.map(|x| x / v));
            // The rotation closest to the frame (T, B) in (e1, e2). The parts of a mirrored frame cancel.
            self.rotation[0] += area * 0.5 * (dot(t, axis_1) + dot(b, axis_2));
            self.rotation[1] += area * 0.5 * (dot(t, axis_2) - dot(b, axis_1));
            self.rotation_area += area;
        }
    }

    fn layout(&self) -> Option<Layout> {
        if self.area <= 0.0 {
            return None;
        }
        let units_per_repeat = self.lengths.map(|l| (l / self.area) as f32);
        if !units_per_repeat.iter().all(|units| UNITS.contains(units)) {
            return None;
        }
        let [x, y] = self.rotation.map(|t| t / self.rotation_area.max(f64::MIN_POSITIVE));
        let mean = (x * x + y * y).sqrt();
        let tangent_rotation = if mean > 0.0 { [(x / mean) as f32, (y / mean) as f32] } else { [1.0, 0.0] };
        // The mean of |frame - rotation|^2 = 2 - 2 frame . rotation, for unit frames.
        let rotation_deviation = (2.0 - 2.0 * mean).max(0.0).sqrt() as f32;
        Some(Layout { units_per_repeat, tangent_rotation, rotation_deviation })
    }
}

#[cfg(test)]
mod tests;
