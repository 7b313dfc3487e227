//! The roughness texture of the pyramid profile: the roughness of the lobes that a plugin adds K to in green; red and
//! blue as in the material's texture, but for metalness, which counts by base colour.

use crate::lobe::Roughness;
use crate::material::product::Product;
use crate::material::roughening::Roughening;

/// The texture of the lobes that K is added to.
pub struct BaseRoughnessTexture<'r, 'a>(pub &'r Roughening<'a>);

impl Product for BaseRoughnessTexture<'_, '_> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        self.0.sizes()
    }

    fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]) {
        let base = self.0.base();
        if level == 0 {
            return base.level_0().isotropic_row(y, out);
        }
        let mut red_blue = vec![[0.0; 2]; out.len()];
        base.red_blue(level, y, &mut red_blue);
        let lobes = self.0.pyramid_base_row(level, y, &self.0.roughened_row(level, y, out.len()));
        for ((texel, [red, blue]), base) in out.iter_mut().zip(red_blue).zip(lobes) {
            // These lobes are isotropic.
            let Roughness(green) = base.lobe.closest_isotropic().into();
            *texel = [red, green.min(1.0), blue, 1.0];
        }
    }
}

#[cfg(test)]
mod tests;
