//! How a material lies on its meshes: the lengths of p_u and p_v and the turn of the tangent (paper, "The Local
//! Coordinate System").

use serde::Deserialize;
use serde_json::Value;

use super::material::Mapping;

/// How texture coordinates lie on the triangles of a material, averaged over their area in mesh space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Mean of |p_u| and |p_v|: scene units per repeat of the texture, across and up.
    pub units_per_repeat: [f32; 2],
    /// Mean cosine and sine of the angle from e1 to the tangent, for the main direction asked for.
    pub turn: [f32; 2],
    /// Root mean square deviation of single triangles from `turn`: 0 where the angle is the same everywhere, and 1.4
    /// where it is arbitrary or texture coordinates are mirrored.
    pub turn_deviation: f32,
}

/// Measures the triangles that use material `material`. `main_direction` is m, in mesh space; `buffer` returns the bytes
/// of a buffer. `None` when no triangle has positions and the texture coordinates of `mapping`, or all are degenerate.
pub fn layout<'a>(
    root: &Value,
    material: usize,
    mapping: &Mapping,
    main_direction: [f32; 3],
    buffer: &dyn Fn(usize) -> Option<&'a [u8]>,
) -> Option<Layout> {
    let reader = Accessors { root, buffer };
    let transform = UvTransform::of(mapping);
    let mut sums = Sums::default();
    let meshes = root.get("meshes").and_then(Value::as_array);
    for primitive in meshes.into_iter().flatten().filter_map(|m| m.get("primitives")?.as_array()).flatten() {
        let is_used = primitive.get("material").and_then(Value::as_u64) == Some(material as u64);
        let is_triangles = primitive.get("mode").and_then(Value::as_u64).unwrap_or(4) == 4;
        if is_used && is_triangles {
            reader.visit_triangles(primitive, mapping.tex_coord, |positions, uvs| {
                sums.add(positions, uvs.map(|uv| transform.apply(uv)), main_direction.map(f64::from));
            });
        }
    }
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
    fn add(&mut self, [p0, p1, p2]: [[f64; 3]; 3], [t0, t1, t2]: [[f64; 2]; 3], m: [f64; 3]) {
        let (e1, e2) = (minus(p1, p0), minus(p2, p0));
        let (du1, dv1, du2, dv2) = (t1[0] - t0[0], t1[1] - t0[1], t2[0] - t0[0], t2[1] - t0[1]);
        let det = du1 * dv2 - du2 * dv1;
        let normal = cross(e1, e2);
        let area = 0.5 * length(normal);
        if area <= 0.0 || det == 0.0 || !det.is_finite() {
            return;
        }
        // v runs down the image, B up.
        let p_u: [f64; 3] = std::array::from_fn(|i| (e1[i] * dv2 - e2[i] * dv1) / det);
        let p_v: [f64; 3] = std::array::from_fn(|i| (e1[i] * du2 - e2[i] * du1) / det);
        let (u, v) = (length(p_u), length(p_v));
        if u <= 0.0 || v <= 0.0 || !(u + v).is_finite() {
            return;
        }
        self.area += area;
        self.lengths[0] += area * u;
        self.lengths[1] += area * v;

        let n = normal.map(|x| x / (2.0 * area));
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
        let [x, y] = self.turn.map(|t| t / self.turn_area.max(f64::MIN_POSITIVE));
        let mean = (x * x + y * y).sqrt();
        let turn = if mean > 0.0 { [(x / mean) as f32, (y / mean) as f32] } else { [1.0, 0.0] };
        // |frame - rotation|^2 = 2 - 2 frame . rotation for unit frames, averaged.
        let turn_deviation = (2.0 - 2.0 * mean).max(0.0).sqrt() as f32;
        Some(Layout { units_per_repeat, turn, turn_deviation })
    }
}

/// `KHR_texture_transform` as a matrix.
struct UvTransform([[f64; 3]; 2]);

impl UvTransform {
    fn of(mapping: &Mapping) -> Self {
        #[derive(Default, Deserialize)]
        #[serde(default)]
        struct Raw {
            offset: [f64; 2],
            rotation: f64,
            scale: Option<[f64; 2]>,
        }
        let raw = mapping.transform.as_ref().and_then(|t| Raw::deserialize(t).ok()).unwrap_or_default();
        let [su, sv] = raw.scale.unwrap_or([1.0; 2]);
        let (sin, cos) = (libm::sin(raw.rotation), libm::cos(raw.rotation));
        Self([[cos * su, sin * sv, raw.offset[0]], [-sin * su, cos * sv, raw.offset[1]]])
    }

    fn apply(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        self.0.map(|[a, b, c]| a * u + b * v + c)
    }
}

/// Reads accessors with every index checked; what is not there is not visited.
struct Accessors<'r, 'a> {
    root: &'r Value,
    buffer: &'r dyn Fn(usize) -> Option<&'a [u8]>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: usize,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    count: usize,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct BufferView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

/// Elements of an accessor in its buffer.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    component_type: u32,
    count: usize,
}

impl<'a> Accessors<'_, 'a> {
    fn visit_triangles(
        &self,
        primitive: &Value,
        tex_coord: u64,
        mut visit: impl FnMut([[f64; 3]; 3], [[f64; 2]; 3]),
    ) -> Option<()> {
        let attribute = |name: &str| primitive.get("attributes")?.get(name)?.as_u64();
        let positions = self.elements(attribute("POSITION")?, 3)?;
        let uvs = self.elements(attribute(&format!("TEXCOORD_{tex_coord}"))?, 2)?;
        let indices = match primitive.get("indices").and_then(Value::as_u64) {
            None => None,
            Some(accessor) => Some(self.elements(accessor, 1)?),
        };
        let corners = indices.as_ref().map_or(positions.count, |i| i.count);
        for first in (0..corners / 3).map(|t| 3 * t) {
            let vertex = |corner: usize| match &indices {
                None => Some(corner),
                Some(indices) => indices.index(corner),
            };
            let read = |corner: usize| {
                let vertex = vertex(corner)?;
                Some((positions.vector::<3>(vertex)?, uvs.vector::<2>(vertex)?))
            };
            if let (Some(a), Some(b), Some(c)) = (read(first), read(first + 1), read(first + 2)) {
                visit([a.0, b.0, c.0], [a.1, b.1, c.1]);
            }
        }
        Some(())
    }

    fn elements(&self, accessor: u64, components: usize) -> Option<Elements<'a>> {
        let object = |array: &str, index: u64| self.root.get(array)?.get(usize::try_from(index).ok()?);
        let accessor = Accessor::deserialize(object("accessors", accessor)?).ok()?;
        let view = BufferView::deserialize(object("bufferViews", accessor.buffer_view as u64)?).ok()?;
        let bytes = (self.buffer)(view.buffer)?;
        let bytes = bytes.get(view.byte_offset..)?.get(..view.byte_length)?.get(accessor.byte_offset..)?;
        let stride = view.byte_stride.unwrap_or(components * component_bytes(accessor.component_type)?);
        Some(Elements { bytes, stride, component_type: accessor.component_type, count: accessor.count })
    }
}

impl Elements<'_> {
    fn component(&self, index: usize, component: usize) -> Option<&[u8]> {
        let size = component_bytes(self.component_type)?;
        let start = index.checked_mul(self.stride)?.checked_add(component * size)?;
        self.bytes.get(start..start.checked_add(size)?)
    }

    fn vector<const N: usize>(&self, index: usize) -> Option<[f64; N]> {
        let mut vector = [0.0; N];
        for (i, value) in vector.iter_mut().enumerate() {
            *value = match (self.component_type, self.component(index, i)?) {
                (5126, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
                (5121, &[a]) => f64::from(a) / 255.0,
                (5123, &[a, b]) => f64::from(u16::from_le_bytes([a, b])) / 65535.0,
                _ => return None,
            };
        }
        Some(vector)
    }

    fn index(&self, corner: usize) -> Option<usize> {
        match (self.component_type, self.component(corner, 0)?) {
            (5121, &[a]) => Some(usize::from(a)),
            (5123, &[a, b]) => Some(usize::from(u16::from_le_bytes([a, b]))),
            (5125, &[a, b, c, d]) => usize::try_from(u32::from_le_bytes([a, b, c, d])).ok(),
            _ => None,
        }
    }
}

/// glTF 2.0, section 3.6.2.2.
fn component_bytes(component_type: u32) -> Option<usize> {
    match component_type {
        5120 | 5121 => Some(1),
        5122 | 5123 => Some(2),
        5125 | 5126 => Some(4),
        _ => None,
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

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
        layout(root, 0, mapping, [0.0, 1.0, 0.0], &|_| Some(bytes))
    }

    #[test]
    fn lengths_are_units_per_repeat() {
        let (root, bytes) = quad(false);
        let layout = measure(&root, &bytes, &Mapping::default()).unwrap();
        assert_eq!(layout.units_per_repeat, [2.0, 2.0]);
        // m = +y, n = +z: e1 = m x n = +x = T.
        assert_eq!(layout.turn, [1.0, 0.0]);
        assert!(layout.turn_deviation < 1e-3);
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

    #[test]
    fn what_cannot_be_read_is_not_there() {
        let (root, bytes) = quad(false);
        let other = Mapping { tex_coord: 1, transform: None };
        assert_eq!(measure(&root, &bytes, &other), None);
        assert_eq!(measure(&root, &bytes[..40], &Mapping::default()), None);
        assert_eq!(measure(&json!({ "meshes": 3 }), &bytes, &Mapping::default()), None);
    }
}
