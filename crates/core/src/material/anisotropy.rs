//! The anisotropy texture: the direction of the roughened lobes in red and green, their strength in blue.

use crate::lobe::{Anisotropy, SquaredAlpha};
use crate::material::product::Product;
use crate::material::roughening::Roughening;
use crate::math::symmetric::Symmetric2;
use crate::simd::map_row;

/// The anisotropy texture of a roughened lobe.
pub struct AnisotropyTexture<'r, 'a> {
    roughening: &'r Roughening<'a>,
    reference_axis: [f32; 2],
}

impl<'r, 'a> AnisotropyTexture<'r, 'a> {
    /// Describes the texture.
    pub fn new(roughening: &'r Roughening<'a>) -> Self {
        Self { roughening, reference_axis: roughening.reference_axis() }
    }
}

impl Product for AnisotropyTexture<'_, '_> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        self.roughening.sizes()
    }

    fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]) {
        let (lobes, axis) = (self.roughening.roughened_row(level, y, out.len()), self.reference_axis);
        map_row(
            lobes.iter().map(|SquaredAlpha(a)| [a.uu, a.uv, a.vv]),
            out,
            |[uu, uv, vv]| {
                let lobe = SquaredAlpha(Symmetric2::new(uu, uv, vv));
                let Anisotropy { strength, direction: [u, v], .. } = Anisotropy::of(lobe, axis);
                [0.5 * u + 0.5, 0.5 * v + 0.5, strength]
            },
            |texel, [u, v, strength]| *texel = [u, v, strength, 1.0],
        );
    }
}
