//! A bump map on the grid of the baked textures.

use std::cell::OnceCell;

use crate::bump::Shaped;
use crate::lobe::SquaredAlpha;
use crate::material::bump_map::BumpMap;
use crate::material::correction::corrected_variance;
use crate::mip::{AreaResampled, Pyramid, TexelRows, level_sizes};
use crate::settings::Settings;

/// Level 0 of a bump map on a grid, and the moments of all levels once something needs them.
pub struct Bumps<'a> {
    /// Level 0.
    pub rows: AreaResampled<&'a BumpMap>,
    moments: OnceCell<Pyramid<AreaResampled<&'a BumpMap>>>,
}

impl<'a> Bumps<'a> {
    /// Puts `bump_map` on a grid of `width` x `height` texels.
    pub fn new(bump_map: &'a BumpMap, (width, height): (u32, u32)) -> Self {
        Self { rows: AreaResampled::new(bump_map, width, height), moments: OnceCell::new() }
    }

    /// Returns the columns and rows of level 0.
    pub fn size(&self) -> (u32, u32) {
        (self.rows.width(), self.rows.height())
    }

    /// Returns the sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.rows.width(), self.rows.height())
    }

    /// Returns means and covariances of all levels. The first call computes them.
    pub fn moments(&self) -> &Pyramid<AreaResampled<&'a BumpMap>> {
        self.moments.get_or_init(|| Pyramid::new(self.rows))
    }

    /// Returns the sum over levels 1 and coarser of the mean trace of c K that the lobe `base_lobe` needs, for offsets
    /// that are not multiplied by the slope scale. `slope_scale` multiplies the offsets that the lobe is roughened by.
    pub fn corrected_variance(&self, slope_scale: f32, settings: &Settings, base_lobe: SquaredAlpha) -> f64 {
        // c depends on the ratio of the lobe's width to the bumps, so the width is divided by the slope scale.
        let squared = (slope_scale * slope_scale).max(f32::MIN_POSITIVE);
        corrected_variance(&Pyramid::new(Shaped(self.rows)), settings, SquaredAlpha((1.0 / squared) * base_lobe.0))
    }
}
