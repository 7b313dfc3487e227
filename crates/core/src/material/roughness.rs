//! The roughness texture: the roughness of the roughened lobes in green; red and blue as in the material's texture.

use crate::lobe::{Anisotropy, Roughness, SquaredAlpha};
use crate::material::product::Product;
use crate::material::roughening::Roughening;
use crate::math::symmetric::Symmetric2;
use crate::settings::Model;
use crate::simd::map_row;

/// The roughness texture of a roughened lobe.
pub struct RoughnessTexture<'r, 'a> {
    roughening: &'r Roughening<'a>,
    model: Model,
    reference_axis: [f32; 2],
}

impl<'r, 'a> RoughnessTexture<'r, 'a> {
    /// Describes the texture under `model`. [`Model::Anisotropic`] stores the roughness that belongs to the anisotropy
    /// texture; every other model stores the roughness of the closest isotropic lobe.
    pub fn new(roughening: &'r Roughening<'a>, model: Model) -> Self {
        Self { roughening, model, reference_axis: roughening.reference_axis() }
    }
}

impl Product for RoughnessTexture<'_, '_> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        self.roughening.sizes()
    }

    fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]) {
        let base = self.roughening.base();
        if self.roughening.lobes().are_base(level) && !self.roughening.is_anisotropic() {
            return base.level_0().isotropic_row(y, out);
        }
        let (mut red_blue, lobes) = (vec![[0.0; 2]; out.len()], self.roughening.roughened_row(level, y, out.len()));
        base.red_blue(level, y, &mut red_blue);
        let texels = red_blue.iter().zip(&lobes).map(|([red, blue], SquaredAlpha(a))| [*red, *blue, a.uu, a.uv, a.vv]);
        let lobe = |uu, uv, vv| SquaredAlpha(Symmetric2::new(uu, uv, vv));
        let store = |texel: &mut [f32; 4], [red, green, blue]: [f32; 3]| *texel = [red, green, blue, 1.0];
        // Square roots are taken in vectors: one by one they take as long as all the rest of the row.
        if self.model == Model::Anisotropic {
            let axis = self.reference_axis;
            let of =
                |[red, blue, uu, uv, vv]: [f32; 5]| [red, Anisotropy::of(lobe(uu, uv, vv), axis).roughness.0, blue];
            map_row(texels, out, of, store);
        } else {
            let of = |[red, blue, uu, uv, vv]: [f32; 5]| {
                [red, Roughness::from(lobe(uu, uv, vv).closest_isotropic()).0.min(1.0), blue]
            };
            map_row(texels, out, of, store);
        }
    }
}
