//! Normals and lobes of level 0, computed once for all samples of a picture.

use rayon::prelude::*;

use super::material::{Material, Point};
use super::sampler::{Texture, texel_of};

/// The unfiltered level 0 of a material.
///
/// With a grid, a sample reads one place of memory instead of one for each texture, and decodes no texels.
pub struct Facets<'a> {
    material: &'a Material,
    grid: Option<Grid>,
}

/// A point for each texel of the finest texture.
struct Grid {
    size: (u32, u32),
    facets: Vec<Facet>,
}

/// A point of level 0 in single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Unit normal in the tangent frame.
    pub normal: [f32; 3],
    /// Squared alphas uu, uv, vv about the normal.
    pub squared_alpha: [f32; 3],
}

impl From<Point> for Facet {
    fn from(Point { normal, squared_alpha }: Point) -> Self {
        Self { normal: normal.map(|c| c as f32), squared_alpha: squared_alpha.map(|a| a as f32) }
    }
}

impl From<Facet> for Point {
    fn from(Facet { normal, squared_alpha }: Facet) -> Self {
        Self { normal: normal.map(f64::from), squared_alpha: squared_alpha.map(f64::from) }
    }
}

impl<'a> Facets<'a> {
    /// Prepares level 0 of `material` for about `samples` samples. There is no grid if it would have more points than
    /// samples, or if texels of one texture lie across texels of another.
    pub fn new(material: &'a Material, samples: u64) -> Self {
        let size = common_size(material).filter(|(width, height)| u64::from(*width) * u64::from(*height) <= samples);
        Self { material, grid: size.map(|size| Grid::new(material, size)) }
    }

    /// Returns the point at `uv`.
    pub fn at(&self, uv: [f64; 2]) -> Point {
        match &self.grid {
            Some(grid) => grid.facet(texel_of(uv, grid.size)).into(),
            None => self.material.point(&|texture: &Texture| texture.nearest(uv)),
        }
    }

    /// Returns the point at `uv` in single precision. `uv` is from 0 to 1.
    #[inline]
    pub fn within(&self, uv: [f32; 2]) -> Facet {
        match &self.grid {
            Some(grid) => grid.within(uv),
            None => self.at(uv.map(f64::from)).into(),
        }
    }
}

impl Grid {
    fn new(material: &Material, size: (u32, u32)) -> Self {
        let (width, height) = size;
        let point = |x: u32, y: u32| {
            let uv = [(f64::from(x) + 0.5) / f64::from(width), (f64::from(y) + 0.5) / f64::from(height)];
            material.point(&|texture: &Texture| texture.nearest(uv)).into()
        };
        let facets = (0..height).into_par_iter().flat_map_iter(|y| (0..width).map(move |x| point(x, y))).collect();
        Self { size, facets }
    }

    fn facet(&self, [x, y]: [usize; 2]) -> Facet {
        self.facets[y * self.size.0 as usize + x]
    }

    #[inline]
    fn within(&self, [u, v]: [f32; 2]) -> Facet {
        let (width, height) = self.size;
        let texel = |at: f32, size: u32| ((at * size as f32) as u32).min(size - 1) as usize;
        self.facet([texel(u, width), texel(v, height)])
    }
}

/// Returns the size of the finest texture, if each texel of its grid lies within one texel of every other texture.
fn common_size(material: &Material) -> Option<(u32, u32)> {
    let mut sizes = material.textures().map(|texture| texture.size(0));
    let finest = material.finest_size();
    let nests = |(width, height): (u32, u32)| finest.0.is_multiple_of(width) && finest.1.is_multiple_of(height);
    sizes.all(nests).then_some(finest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mip::Level;
    use crate::render::{Bumps, LostBumps};

    fn noise(width: u32, height: u32, seed: u32) -> Texture {
        let value = |i: u32| (i.wrapping_mul(2_654_435_761).wrapping_add(seed) >> 8) as f32 / (1 << 24) as f32;
        let texels = (0..width * height).map(|i| [0, 1, 2, 3].map(|c| value(4 * i + c))).collect();
        Texture::with_mips(Level { width, height, texels })
    }

    fn material(roughness: Texture) -> Material {
        Material {
            bumps: Bumps::Normals { texture: noise(8, 4, 1), scale: 1.0, has_z: true },
            roughness: Some(roughness),
            roughness_factor: 1.0,
            anisotropy: None,
            lost: LostBumps::RoughenedTextures,
        }
    }

    #[test]
    fn the_grid_has_the_points_of_the_textures() {
        for (roughness, is_grid) in [(noise(4, 4, 2), true), (noise(16, 8, 2), true), (noise(6, 4, 2), false)] {
            let material = material(roughness);
            let facets = Facets::new(&material, 1 << 10);
            assert_eq!(facets.grid.is_some(), is_grid);
            for i in 0..200 {
                let uv = [0.037 * f64::from(i) - 3.0, 0.071 * f64::from(i) - 5.0];
                let exact = material.point(&|texture: &Texture| texture.nearest(uv));
                let found = facets.at(uv);
                let pairs = found.normal.iter().zip(&exact.normal);
                let fraction = uv.map(|c| (c - c.floor()) as f32);
                assert_eq!(facets.within(fraction), Facet::from(facets.at(fraction.map(f64::from))));
                for (a, b) in pairs.chain(found.squared_alpha.iter().zip(&exact.squared_alpha)) {
                    assert!((a - b).abs() < 1e-6, "{uv:?}: {found:?} {exact:?}");
                }
            }
        }
    }

    #[test]
    fn the_last_texel_reaches_to_the_end_of_the_map() {
        let material = material(noise(4, 4, 2));
        let facets = Facets::new(&material, 1 << 10);
        assert_eq!(facets.within([1.0, 1.0]), facets.within([0.999, 0.999]));
    }

    #[test]
    fn few_samples_need_no_grid() {
        assert!(Facets::new(&material(noise(4, 4, 2)), 31).grid.is_none());
    }
}
