//! Texture density: the size of a texel on the surfaces of the scenes, in scene units.

use super::material::Mapping;
use super::meshes::{Meshes, Primitive};
use super::scene::{BadNode, Metric, Placement, Unsteady, product};
use super::triangles::{Accessors, Vertex, length, minus, tangents};
use crate::math::symmetric::{MohrCircle, determinant};
use crate::math::vector::cross;

/// Why the size of a material's texels is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoDensity {
    /// A node that cannot be read.
    #[error(transparent)]
    Node(#[from] BadNode),
    /// No triangle with texture coordinates shows the material.
    #[error("no triangle of the document shows the material")]
    NoTriangles,
    /// A mesh that no scene of the document draws. Something else may put it into a scene.
    #[error("mesh {mesh}, which shows the material, is in no scene")]
    InNoScene {
        /// Index into `meshes`.
        mesh: usize,
    },
    /// A mesh whose size changes.
    #[error("the size of mesh {mesh}, which shows the material, is not known: {reason}")]
    Unsteady {
        /// Index into `meshes`.
        mesh: usize,
        /// Why the size changes.
        reason: Unsteady,
    },
    /// An animation changes the texture coordinates.
    #[error("an animation changes the material's texture coordinates")]
    MovingCoordinates,
    /// Triangles that are compressed.
    #[error("meshes that show the material are compressed by {0}, which the bake does not read")]
    Compressed(&'static str),
    /// Triangles that are sparse or damaged, or too many.
    #[error("some triangles that show the material cannot be read")]
    Unreadable,
}

/// Sizes of the texels of a map on the surfaces of the scenes, in scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    /// Length of a texel where the map is most magnified: on the worst triangle, along the direction of its largest
    /// stretch, as far as anisotropic filtering follows.
    pub longest: f64,
    /// Side of a square with the mean area of a texel.
    pub typical: f64,
}

/// Returns the density of a map of `size` (columns, rows) on the triangles that show material `material`. Triangles
/// without area, on the surface or on the map, do not count. `placements` has the sizes of meshes. `buffer` returns the
/// bytes of a buffer.
///
/// # Errors
/// [`NoDensity`] if a triangle may be larger than the document says.
pub fn density<'a>(
    meshes: &Meshes<'_>,
    placements: &[Placement],
    material: usize,
    mapping: &Mapping,
    size: (u32, u32),
    buffer: &dyn Fn(usize) -> Option<&'a [u8]>,
) -> Result<Density, NoDensity> {
    if meshes.has_moving_coordinates(material) {
        return Err(NoDensity::MovingCoordinates);
    }
    let (mut sums, mut failure) = (Sums::default(), None);
    let is_complete = Accessors { meshes, buffer }.visit_material(material, mapping, |primitive, triangle| {
        let Primitive { mesh, times, .. } = *primitive;
        match placements.get(mesh) {
            None | Some(Placement::Absent) => failure = failure.or(Some(NoDensity::InNoScene { mesh })),
            Some(Placement::Unsteady(reason)) => {
                failure = failure.or(Some(NoDensity::Unsteady { mesh, reason: *reason }));
            }
            Some(Placement::At(metrics)) => {
                metrics.iter().for_each(|metric| sums.add(triangle, f64::from(times), *metric, size));
            }
        }
    });
    match failure {
        Some(failure) => Err(failure),
        None if !is_complete => Err(meshes.compression(material).map_or(NoDensity::Unreadable, NoDensity::Compressed)),
        None => sums.density(),
    }
}

#[derive(Default)]
struct Sums {
    longest_squared: f64,
    area: f64,
    texels: f64,
}

impl Sums {
    fn add(&mut self, triangle: [Vertex; 3], times: f64, metric: Metric, size: (u32, u32)) {
        let Some([a, b]) = texel_sides(triangle, size) else { return };
        let sides = Sides { aa: product(a, metric, a), ab: product(a, metric, b), bb: product(b, metric, b) };
        let stretch = sides.stretch_squared();
        // NaN has no bound.
        self.longest_squared = if stretch.is_nan() { f64::INFINITY } else { self.longest_squared.max(stretch) };
        let texels = times * texels_under(triangle, size);
        self.area += texels * sides.area();
        self.texels += texels;
    }

    fn density(&self) -> Result<Density, NoDensity> {
        match self.longest_squared {
            0.0 => Err(NoDensity::NoTriangles),
            f64::INFINITY => Err(NoDensity::Unreadable),
            square => Ok(Density { longest: square.sqrt(), typical: (self.area / self.texels).sqrt() }),
        }
    }
}

/// Returns the sides of a texel on the triangle's mesh, or `None` for a triangle without area.
fn texel_sides(triangle: [Vertex; 3], (width, height): (u32, u32)) -> Option<[[f64; 3]; 2]> {
    let [a, b, c] = triangle.map(|v| v.position);
    if length(cross(minus(b, a), minus(c, a))) == 0.0 {
        return None;
    }
    let [p_u, p_v] = tangents(triangle)?;
    Some([p_u.map(|x| x / f64::from(width)), p_v.map(|x| x / f64::from(height))])
}

/// Square of the largest anisotropy that samplers follow. 16 is the most that any API offers. Samplers may take the
/// longer of a footprint's two sides for its major axis, which is up to sqrt 2 longer (Vulkan 1.3, "Scale Factor
/// Operation").
const MAX_ANISOTROPY_SQUARED: f64 = 16.0 * 16.0 * 2.0;

/// Returns the number of texels of the map that lie on the triangle.
fn texels_under([a, b, c]: [Vertex; 3], (width, height): (u32, u32)) -> f64 {
    let det = (b.uv[0] - a.uv[0]) * (c.uv[1] - a.uv[1]) - (c.uv[0] - a.uv[0]) * (b.uv[1] - a.uv[1]);
    0.5 * det.abs() * f64::from(width) * f64::from(height)
}

/// Scalar products of the sides of a texel on the surface.
struct Sides {
    aa: f64,
    ab: f64,
    bb: f64,
}

impl Sides {
    /// Returns the square of the length that decides which level is sampled.
    ///
    /// A texel's inscribed circle becomes an ellipse with semi-axes s1 >= s2 on the surface. A pixel of length p is p /
    /// s2 by p / s1 texels. The level is log2 of the shorter length, but at least of the longer length over the largest
    /// anisotropy (Vulkan 1.3, "LOD Operation"): log2(p / min(s1, 16 s2)).
    fn stretch_squared(&self) -> f64 {
        let circle = MohrCircle::from([self.aa, self.ab, self.bb]);
        let [major, minor] = circle.eigenvalues();
        // The minor axis is no less than the rounding error of the difference.
        let minor = minor.max(4.0 * f64::EPSILON * circle.mean);
        let bound = MAX_ANISOTROPY_SQUARED * minor;
        // f64::min would drop NaN.
        if bound < major { bound } else { major }
    }

    /// Returns the area of the texel.
    fn area(&self) -> f64 {
        determinant([self.aa, self.ab, self.bb]).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests;
