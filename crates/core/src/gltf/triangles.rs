//! The triangles of a material. Every index is checked, and triangles that cannot be read are not visited.

use std::sync::atomic::Ordering;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use super::material::Mapping;
use super::meshes::{Meshes, Primitive};
use crate::math::vector::dot;

/// The accessors of a document.
pub struct Accessors<'r, 'a> {
    /// The document's meshes.
    pub meshes: &'r Meshes<'r>,
    /// Returns the bytes of a buffer.
    pub buffer: &'r dyn Fn(usize) -> Option<&'a [u8]>,
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Position in mesh space.
    pub position: [f64; 3],
    /// Texture coordinates, v down the image.
    pub uv: [f64; 2],
    /// The normal, if the mesh has normals.
    pub normal: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: usize,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    #[serde(default)]
    normalized: bool,
    count: usize,
    /// Replaces elements. Sparse accessors are not read.
    sparse: Option<IgnoredAny>,
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
    normalized: bool,
    count: usize,
}

impl<'a> Accessors<'_, 'a> {
    /// Calls `visit` for each triangle that uses material `material` and has the texture coordinates of `mapping`,
    /// together with its primitive. Returns whether all such triangles could be read.
    pub fn visit_material(
        &self,
        material: usize,
        mapping: &Mapping,
        mut visit: impl FnMut(&Primitive<'_>, [Vertex; 3]),
    ) -> bool {
        let transform = mapping.uv();
        let mut remaining = self.meshes.remaining.load(Ordering::Relaxed);
        let mut is_complete = true;
        for primitive in self.meshes.primitives(material) {
            let read = self.visit_primitive(primitive.value, transform.tex_coord, &mut remaining, |triangle| {
                visit(primitive, triangle.map(|v| Vertex { uv: transform.apply(v.uv), ..v }));
            });
            is_complete &= read.is_some();
        }
        self.meshes.remaining.store(remaining, Ordering::Relaxed);
        is_complete
    }

    /// Visits the triangles of a primitive. Returns `None` if the primitive, or a part of it, cannot be read.
    fn visit_primitive(
        &self,
        primitive: &Value,
        tex_coord: u64,
        remaining: &mut usize,
        mut visit: impl FnMut([Vertex; 3]),
    ) -> Option<()> {
        let attribute = |name: &str| primitive.get("attributes")?.get(name)?.as_u64();
        let (Some(positions), Some(uvs)) = (attribute("POSITION"), attribute(&format!("TEXCOORD_{tex_coord}"))) else {
            // Without texture coordinates no texture is shown.
            return Some(());
        };
        let (positions, uvs) = (self.elements(positions, 3)?, self.elements(uvs, 2)?);
        let normals = attribute("NORMAL").and_then(|accessor| self.elements(accessor, 3));
        let indices = match primitive.get("indices").and_then(Value::as_u64) {
            None => None,
            Some(accessor) => Some(self.elements(accessor, 1)?),
        };
        let corners = indices.as_ref().map_or(positions.count, |i| i.count);
        let read = |corner: usize| {
            let vertex = indices.as_ref().map_or(Some(corner), |i| i.index(corner))?;
            let normal = normals.as_ref().and_then(|n| n.vector(vertex));
            Some(Vertex { position: positions.vector(vertex)?, uv: uvs.vector(vertex)?, normal })
        };
        let mode = primitive.get("mode").and_then(Value::as_u64).unwrap_or(TRIANGLES);
        let count = triangle_count(mode, corners);
        let mut is_complete = count <= *remaining;
        for triangle in 0..count.min(*remaining) {
            match triangle_corners(mode, triangle).map(read) {
                [Some(a), Some(b), Some(c)] => visit([a, b, c]),
                _ => is_complete = false,
            }
        }
        *remaining -= count.min(*remaining);
        is_complete.then_some(())
    }

    fn elements(&self, accessor: u64, components: usize) -> Option<Elements<'a>> {
        let object = |array: &str, index: u64| self.meshes.root.get(array)?.get(usize::try_from(index).ok()?);
        let accessor = Accessor::deserialize(object("accessors", accessor)?).ok()?;
        let view = BufferView::deserialize(object("bufferViews", accessor.buffer_view as u64)?).ok()?;
        let bytes = (self.buffer)(view.buffer)?;
        let bytes = bytes.get(view.byte_offset..)?.get(..view.byte_length)?.get(accessor.byte_offset..)?;
        let component = component_bytes(accessor.component_type)?;
        let element = components * component;
        let stride = view.byte_stride.unwrap_or(element);
        // Elements that overlap, and components that are not aligned, are invalid (glTF 2.0, section 3.6.2.4). Counts
        // beyond the bytes would make small files take long.
        if stride < element
            || !stride.is_multiple_of(component)
            || accessor.count > bytes.len() / stride + 1
            || accessor.sparse.is_some()
        {
            return None;
        }
        let Accessor { component_type, normalized, count, .. } = accessor;
        Some(Elements { bytes, stride, component_type, normalized, count })
    }
}

impl Elements<'_> {
    fn component(&self, index: usize, component: usize) -> Option<&[u8]> {
        if index >= self.count {
            return None;
        }
        let size = component_bytes(self.component_type)?;
        let start = index.checked_mul(self.stride)?.checked_add(component * size)?;
        self.bytes.get(start..start.checked_add(size)?)
    }

    fn vector<const N: usize>(&self, index: usize) -> Option<[f64; N]> {
        let mut vector = [0.0; N];
        for (i, value) in vector.iter_mut().enumerate() {
            *value = match (self.component_type, self.component(index, i)?) {
                (5126, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
                // glTF 2.0, section 3.11: f = max(c / 127, -1), and accordingly for the other types.
                (5120, &[a]) => self.scaled(f64::from(i8::from_le_bytes([a])), 127.0),
                (5121, &[a]) => self.scaled(f64::from(a), 255.0),
                (5122, &[a, b]) => self.scaled(f64::from(i16::from_le_bytes([a, b])), 32767.0),
                (5123, &[a, b]) => self.scaled(f64::from(u16::from_le_bytes([a, b])), 65535.0),
                _ => return None,
            };
        }
        vector.iter().all(|value: &f64| value.is_finite()).then_some(vector)
    }

    fn scaled(&self, integer: f64, one: f64) -> f64 {
        if self.normalized { (integer / one).max(-1.0) } else { integer }
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

/// The primitive modes with triangles (glTF 2.0, section 3.7.2.1). The other modes are points and lines.
const TRIANGLES: u64 = 4;
const TRIANGLE_STRIP: u64 = 5;
const TRIANGLE_FAN: u64 = 6;

fn triangle_count(mode: u64, corners: usize) -> usize {
    match mode {
        TRIANGLES => corners / 3,
        TRIANGLE_STRIP | TRIANGLE_FAN => corners.saturating_sub(2),
        _ => 0,
    }
}

fn triangle_corners(mode: u64, i: usize) -> [usize; 3] {
    match mode {
        TRIANGLE_STRIP => [i, i + 1 + i % 2, i + 2 - i % 2],
        TRIANGLE_FAN => [i + 1, i + 2, 0],
        _ => [3 * i, 3 * i + 1, 3 * i + 2],
    }
}

/// Returns the bytes of a component (glTF 2.0, section 3.6.2.2).
fn component_bytes(component_type: u32) -> Option<usize> {
    match component_type {
        5120 | 5121 => Some(1),
        5122 | 5123 => Some(2),
        5125 | 5126 => Some(4),
        _ => None,
    }
}

/// Returns p_u and -p_v (up the image) of a triangle, or `None` if its texture coordinates are degenerate.
pub fn tangents([a, b, c]: [Vertex; 3]) -> Option<[[f64; 3]; 2]> {
    let (e1, e2) = (minus(b.position, a.position), minus(c.position, a.position));
    let (du1, dv1) = (b.uv[0] - a.uv[0], b.uv[1] - a.uv[1]);
    let (du2, dv2) = (c.uv[0] - a.uv[0], c.uv[1] - a.uv[1]);
    let det = du1 * dv2 - du2 * dv1;
    if det == 0.0 || !det.is_finite() {
        return None;
    }
    let across = std::array::from_fn(|i| (e1[i] * dv2 - e2[i] * dv1) / det);
    let up = std::array::from_fn(|i| (e1[i] * du2 - e2[i] * du1) / det);
    Some([across, up])
}

/// Returns a - b.
pub fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns |a|.
pub fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
