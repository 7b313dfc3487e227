//! The bumps of a relief on the grid of a texture.

use std::cell::OnceCell;

use crate::bump::Shaped;
use crate::lobe::SquaredAlpha;
use crate::material::bump_map::BumpMap;
use crate::material::pyramids::mean_correction;
use crate::mip::{Area, Pyramid, Rows, level_sizes};
use crate::settings::Settings;

/// Level 0 of a relief on a grid, and its moments when they are asked for.
pub struct Bumps<'a> {
    /// Level 0.
    pub rows: Area<&'a BumpMap>,
    moments: OnceCell<Pyramid<Area<&'a BumpMap>>>,
}

impl<'a> Bumps<'a> {
    /// `relief` on a grid of `width` x `height` texels.
    pub fn new(bump_map: &'a BumpMap, (width, height): (u32, u32)) -> Self {
        Self { rows: Area::new(bump_map, width, height), moments: OnceCell::new() }
    }

    /// Columns and rows of level 0.
    pub fn size(&self) -> (u32, u32) {
        (self.rows.width(), self.rows.height())
    }

    /// Sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.rows.width(), self.rows.height())
    }

    /// Means and covariances of all levels, made by the first call.
    pub fn moments(&self) -> &Pyramid<Area<&'a BumpMap>> {
        self.moments.get_or_init(|| Pyramid::new(self.rows))
    }

    /// c for a shader that has one for the whole map and multiplies offsets by `slope_scale`: what the levels' covariances
    /// want on average under a lobe of `own` squared alphas.
    pub fn correction(&self, slope_scale: f32, settings: &Settings, own: SquaredAlpha) -> f32 {
        // Offsets scaled by s widen a lobe as much as they do by themselves one that is narrower by s.
        let squared = (slope_scale * slope_scale).max(f32::MIN_POSITIVE);
        mean_correction(&Pyramid::new(Shaped(self.rows)), settings, SquaredAlpha((1.0 / squared) * own.0))
    }
}
