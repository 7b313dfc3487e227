//! Rotation maps: the tangent rotation of each texel, for meshes on which the rotation varies (paper, "The Local
//! Coordinate System", 3).

use super::material::Mapping;
use super::meshes::Meshes;
use super::triangles::{Accessors, Vertex, length, minus, tangents};
use crate::bump::FrameTransform;
use crate::math::vector::{cross, dot};

/// A frame transform for each texel of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct RotationMap {
    /// Columns.
    pub width: u32,
    /// Transforms from slopes along (T, B) to slopes along (e1, e2), rows top to bottom.
    pub transforms: Vec<FrameTransform>,
    /// Root mean square deviation between the triangles that share a texel. It is 0 if each part of the map is used
    /// once on the mesh, and up to 2 if parts are used several times in different directions.
    pub conflict: f32,
}

/// Most texels that triangles may cover together: four times a map of 16384^2.
const MAX_VISITS: f64 = (1u64 << 30) as f64;

/// Passes in which texels without a triangle take the mean of their neighbours: the usual width of a gutter.
const GUTTER: u32 = 16;

/// Returns the rotation map of `width` x `height` texels for material `material`. `main_direction` is m in mesh space.
/// Returns `None` if no triangle can be read, or if triangles repeat the map so often that a texel cannot have one
/// rotation.
pub fn rotation_map<'a>(
    meshes: &Meshes<'_>,
    material: usize,
    mapping: &Mapping,
    main_direction: [f32; 3],
    buffer: &dyn Fn(usize) -> Option<&'a [u8]>,
    [width, height]: [u32; 2],
) -> Option<RotationMap> {
    let mut raster = Raster {
        width: i64::from(width),
        height: i64::from(height),
        sums: vec![Sum::default(); width as usize * height as usize],
        visits: 0.0,
    };
    Accessors { meshes, buffer }.visit_material(material, mapping, |primitive, triangle| {
        raster.draw(triangle, primitive.times as f32, main_direction.map(f64::from));
    });
    let has_frame = raster.sums.iter().any(|sum| sum.count > 0.0);
    (has_frame && raster.visits <= MAX_VISITS).then(|| raster.finish())
}

/// Sum of the frames of a texel's triangles: T and B, each along e1 and e2.
#[derive(Clone, Copy, Default)]
struct Sum {
    frame: [f32; 4],
    count: f32,
}

impl Sum {
    fn add(&mut self, frame: [f32; 4], times: f32) {
        for (sum, part) in self.frame.iter_mut().zip(frame) {
            *sum += times * part;
        }
        self.count += times;
    }
}

struct Raster {
    width: i64,
    height: i64,
    sums: Vec<Sum>,
    visits: f64,
}

impl Raster {
    fn draw(&mut self, triangle: [Vertex; 3], times: f32, m: [f64; 3]) {
        let corners = triangle.map(|v| [v.uv[0] * self.width as f64, v.uv[1] * self.height as f64]);
        let bound = |axis: usize, pick: fn(f64, f64) -> f64| {
            pick(pick(corners[0][axis], corners[1][axis]), corners[2][axis]) - 0.5
        };
        let (left, right) = (bound(0, f64::min).ceil(), bound(0, f64::max).floor());
        let (top, bottom) = (bound(1, f64::min).ceil(), bound(1, f64::max).floor());
        let area = (right - left + 1.0).max(0.0) * (bottom - top + 1.0).max(0.0);
        let Some(tangents) = tangents(triangle) else { return };
        if area <= 0.0 {
            return;
        }
        self.visits += area;
        if self.visits.is_nan() || self.visits > MAX_VISITS {
            self.visits = f64::INFINITY;
            return;
        }
        for y in top as i64..=bottom as i64 {
            for x in left as i64..=right as i64 {
                let Some(weights) = barycentric(corners, [x as f64 + 0.5, y as f64 + 0.5]) else { continue };
                if let Some(frame) = frame(triangle, weights, tangents, m) {
                    let texel = y.rem_euclid(self.height) * self.width + x.rem_euclid(self.width);
                    self.sums[texel as usize].add(frame, times);
                }
            }
        }
    }

    fn finish(mut self) -> RotationMap {
        let covered = self.sums.iter().filter(|s| s.count > 0.0);
        let (mut squares, mut count) = (0.0, 0.0);
        for sum in covered {
            // The square is 2 - 2 |mean frame| / sqrt 2, since the norm of a frame is sqrt 2.
            let norm = (sum.frame.iter().map(|f| f * f).sum::<f32>() / 2.0).sqrt() / sum.count;
            squares += f64::from((2.0 - 2.0 * norm).max(0.0));
            count += 1.0;
        }
        let conflict = (squares / f64::max(count, 1.0)).sqrt() as f32;
        for _ in 0..GUTTER {
            if !self.fill_from_neighbours() {
                break;
            }
        }
        let transforms = self.sums.iter().map(|sum| nearest_frame(sum.frame)).collect();
        RotationMap { width: self.width as u32, transforms, conflict }
    }

    /// Gives texels without a frame the mean frame of their neighbours. Returns whether such a texel was left.
    fn fill_from_neighbours(&mut self) -> bool {
        let before = self.sums.clone();
        let mut has_empty = false;
        for (i, sum) in self.sums.iter_mut().enumerate().filter(|(_, sum)| sum.count == 0.0) {
            has_empty = true;
            let (x, y) = (i as i64 % self.width, i as i64 / self.width);
            for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
                let neighbour = (y + dy).rem_euclid(self.height) * self.width + (x + dx).rem_euclid(self.width);
                let neighbour = before[neighbour as usize];
                if neighbour.count > 0.0 {
                    sum.add(neighbour.frame.map(|f| f / neighbour.count), 1.0);
                }
            }
        }
        has_empty
    }
}

/// Returns the weights of the corners at `point`, or `None` outside the triangle.
fn barycentric([a, b, c]: [[f64; 2]; 3], point: [f64; 2]) -> Option<[f64; 3]> {
    let edge = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let area = edge(a, b, c);
    let weights = [edge(b, c, point) / area, edge(c, a, point) / area, edge(a, b, point) / area];
    weights.iter().all(|w| *w >= 0.0).then_some(weights)
}

/// Returns T and B along e1, then along e2, as glTF's shaders build them: T is made perpendicular to the normal, and
/// B = +- N x T.
fn frame(triangle: [Vertex; 3], weights: [f64; 3], [across, up]: [[f64; 3]; 2], m: [f64; 3]) -> Option<[f32; 4]> {
    let [a, b, c] = triangle;
    let normal = match (a.normal, b.normal, c.normal) {
        (Some(a), Some(b), Some(c)) => {
            std::array::from_fn(|i| a[i] * weights[0] + b[i] * weights[1] + c[i] * weights[2])
        }
        _ => cross(minus(b.position, a.position), minus(c.position, a.position)),
    };
    let n = unit(normal)?;
    let tilt = dot(across, n);
    let t = unit(std::array::from_fn(|i| across[i] - tilt * n[i]))?;
    let b = cross(n, t);
    let b = if dot(b, up) < 0.0 { b.map(|x| -x) } else { b };
    let e1 = unit(cross(m, n))?;
    let e2 = cross(n, e1);
    Some([dot(t, e1), dot(b, e1), dot(t, e2), dot(b, e2)].map(|x| x as f32))
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = length(v);
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}

/// Returns the rotation or reflection closest to the matrix [[a, b], [c, d]], or the identity for a texel without a
/// frame.
fn nearest_frame([a, b, c, d]: [f32; 4]) -> FrameTransform {
    let sign = if a * d - b * c < 0.0 { -1.0 } else { 1.0 };
    let (x, y) = (a + sign * d, c - sign * b);
    let length = (x * x + y * y).sqrt();
    if length <= 0.0 {
        return FrameTransform::IDENTITY;
    }
    let (cos, sin) = (x / length, y / length);
    FrameTransform { matrix: [[cos, -sign * sin], [sin, sign * cos]] }
}

#[cfg(test)]
mod tests;
