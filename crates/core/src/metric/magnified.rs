//! A surface as samplers magnify it: the truth between the centres of texels.

use crate::math::vector::{Vector, normalised};
use crate::metric::footprint::Surface;

/// Points of a texel along each axis, from its centre in texels: the nodes of the Gauss-Legendre rule with two points
/// on each half of the texel, at which interpolated values have the mean square of the whole texel.
const NODES: [f64; 4] = [-0.394_337_567_3, -0.105_662_432_7, 0.105_662_432_7, 0.394_337_567_3];

impl Surface {
    /// Returns a repeating surface of 4 x 4 points for each texel, interpolated linearly between the centres of texels:
    /// normals, which are normalised after that, and the fourth roots of squared alphas.
    pub fn magnified(&self) -> Self {
        let nodes = NODES.len() as u32;
        let (width, height) = (nodes * self.width, nodes * self.height);
        let points = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let (normals, base) =
            points.map(|(x, y)| self.point(neighbours(x, self.width), neighbours(y, self.height))).unzip();
        Self { width, height, normals, base }
    }

    fn point(&self, across: [(u32, f64); 2], down: [(u32, f64); 2]) -> (Vector, [f64; 3]) {
        let (mut normal, mut roots) = ([0.0; 3], [0.0; 3]);
        for (y, share_y) in down {
            for (x, share_x) in across {
                let (texel, share) = (y as usize * self.width as usize + x as usize, share_x * share_y);
                let [uu, uv, vv] = self.base[texel];
                normal.iter_mut().zip(self.normals[texel]).for_each(|(sum, c)| *sum += share * c);
                let of_texel = [uu.sqrt().sqrt(), uv, vv.sqrt().sqrt()];
                roots.iter_mut().zip(of_texel).for_each(|(sum, c)| *sum += share * c);
            }
        }
        let [u, uv, v] = roots;
        (normalised(normal), [u * u * u * u, uv, v * v * v * v])
    }
}

/// Returns the two texels of an axis around point `i`, with their shares.
fn neighbours(i: u32, size: u32) -> [(u32, f64); 2] {
    let nodes = NODES.len() as u32;
    let (texel, at) = (i / nodes, NODES[(i % nodes) as usize]);
    let other = if at < 0.0 { texel.checked_sub(1).unwrap_or(size - 1) } else { (texel + 1) % size };
    [(texel, 1.0 - at.abs()), (other, at.abs())]
}
