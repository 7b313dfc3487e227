//! How a material lies on its meshes: the lengths of p_u and p_v and the turn of the tangent (paper, "The Local
//! Coordinate System").

use std::ops::RangeInclusive;

use super::material::Mapping;
use super::meshes::Meshes;
use super::triangles::{Accessors, Vertex, cross, dot, length, minus, tangents};

/// How texture coordinates lie on the triangles of a material, averaged over their area in mesh space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Mean of |p_u| and |p_v|: mesh units per repeat of the texture, across and up.
    pub units_per_repeat: [f32; 2],
    /// Mean cosine and sine of the angle from e1 to the tangent, for the main direction asked for.
    pub turn: [f32; 2],
    /// Root mean square deviation of single triangles from `turn`: 0 where the angle is the same everywhere, and 1.4
    /// where it is arbitrary or texture coordinates are mirrored.
    pub rotation_deviation: f32,
}

/// Units per repeat that a layout may have. Beyond, offsets in mesh units and their squares leave the range of floats.
const UNITS: RangeInclusive<f32> = 1e-9..=1e9;

/// Measures the triangles that use material `material`. `main_direction` is m, in mesh space; `buffer` returns the
/// bytes of a buffer. `None` when no triangle has positions and the texture coordinates of `mapping`, when all are
/// degenerate, or when a repeat is shorter than 1e-9 units or longer than 1e9.
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
    /// cos and sin of the turn, and the mean square of what a triangle's frame has.
    turn: [f64; 2],
    turn_area: f64,
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
            // The rotation closest to the frame (T, B) in (e1, e2); for a mirrored one its parts cancel.
            self.turn[0] += area * 0.5 * (dot(t, axis_1) + dot(b, axis_2));
            self.turn[1] += area * 0.5 * (dot(t, axis_2) - dot(b, axis_1));
            self.turn_area += area;
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
        let [x, y] = self.turn.map(|t| t / self.turn_area.max(f64::MIN_POSITIVE));
        let mean = (x * x + y * y).sqrt();
        let turn = if mean > 0.0 { [(x / mean) as f32, (y / mean) as f32] } else { [1.0, 0.0] };
        // |frame - rotation|^2 = 2 - 2 frame . rotation for unit frames, averaged.
        let rotation_deviation = (2.0 - 2.0 * mean).max(0.0).sqrt() as f32;
        Some(Layout { units_per_repeat, turn, rotation_deviation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// A quad of 4 x 2 units in the plane z = 0, facing +z, its texture repeated twice across; u runs along +x, or
    /// turned by a quarter along +y.
    fn quad(turned: bool) -> (Value, Vec<u8>) {
        let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]];
        let mut bytes = Vec::new();
        for [x, y] in corners {
            let (x, y) = if turned { (-y, x) } else { (x, y) };
            for value in [x, y, 0.0] {
                bytes.extend_from_slice(&f32::to_le_bytes(value));
            }
        }
        for [x, y] in corners {
            for value in [x / 2.0, 1.0 - y / 2.0] {
                bytes.extend_from_slice(&f32::to_le_bytes(value));
            }
        }
        bytes.extend_from_slice(&[0, 1, 2, 0, 2, 3]);
        let root = json!({
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0 }] }],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
                { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" },
                { "bufferView": 2, "componentType": 5121, "count": 6, "type": "SCALAR" },
            ],
            "bufferViews": [
                { "buffer": 0, "byteLength": 48 },
                { "buffer": 0, "byteOffset": 48, "byteLength": 32 },
                { "buffer": 0, "byteOffset": 80, "byteLength": 6 },
            ],
        });
        (root, bytes)
    }

    fn measure(root: &Value, bytes: &[u8], mapping: &Mapping) -> Option<Layout> {
        layout(&Meshes::of(root), 0, mapping, [0.0, 1.0, 0.0], &|_| Some(bytes))
    }

    #[test]
    fn lengths_are_units_per_repeat() {
        let (root, bytes) = quad(false);
        let layout = measure(&root, &bytes, &Mapping::default()).unwrap();
        assert_eq!(layout.units_per_repeat, [2.0, 2.0]);
        // m = +y, n = +z: e1 = m x n = +x = T.
        assert_eq!(layout.turn, [1.0, 0.0]);
        assert!(layout.rotation_deviation < 1e-3);
    }

    #[test]
    fn texture_transforms_scale_repeats() {
        let (root, bytes) = quad(false);
        let transform = Some(json!({ "scale": [4.0, 0.5], "offset": [0.3, 0.1] }));
        let layout = measure(&root, &bytes, &Mapping { tex_coord: 0, transform }).unwrap();
        assert_eq!(layout.units_per_repeat, [0.5, 4.0]);
    }

    #[test]
    fn the_turn_is_from_e1_to_the_tangent() {
        let (root, bytes) = quad(true);
        let layout = measure(&root, &bytes, &Mapping::default()).unwrap();
        assert!((layout.turn[0]).abs() < 1e-6 && (layout.turn[1] - 1.0).abs() < 1e-6, "{layout:?}");
    }

    /// Vectors that overlap, numbers that are none, and lengths that leave no room for squares.
    #[test]
    fn what_makes_no_lengths_is_not_there() {
        let (root, bytes) = quad(false);
        for stride in [1, 2, 4, 10, 13] {
            let mut root = root.clone();
            root["bufferViews"][0]["byteStride"] = json!(stride);
            assert_eq!(measure(&root, &bytes, &Mapping::default()), None, "stride {stride}");
        }
        for x in [f32::NAN, f32::INFINITY, 3e38, 1e12] {
            let mut bytes = bytes.clone();
            for vertex in 0..4 {
                bytes[12 * vertex..12 * vertex + 4].copy_from_slice(&(x * vertex as f32).to_le_bytes());
            }
            assert_eq!(measure(&root, &bytes, &Mapping::default()), None, "{x}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_not_there() {
        let (root, bytes) = quad(false);
        let other = Mapping { tex_coord: 1, transform: None };
        assert_eq!(measure(&root, &bytes, &other), None);
        assert_eq!(measure(&root, &bytes[..40], &Mapping::default()), None);
        assert_eq!(measure(&json!({ "meshes": 3 }), &bytes, &Mapping::default()), None);
    }
}
