//! Step 4: an image becomes a bump map, whose texels are offsets, on the grid of the baked textures.

use crate::bake::group::BumpMapKind;
use crate::bump::{HeightMap, NormalLayout, NormalMap};
use crate::image::{Image, MapError};
use crate::material::{BumpMap, Bumps, GridError, grid, normal_scale};
use crate::mip::{Sampler, TexelRows};
use crate::settings::Settings;

/// A bump map with its offsets, and what all later steps need to know beside it.
pub struct MapOffsets<'a> {
    /// The bump map.
    pub bump_map: &'a BumpMap,
    /// Its offsets on the grid of the baked textures.
    pub bumps: Bumps<'a>,
    /// The settings of the bake.
    pub settings: &'a Settings,
    /// The modes of its sampler.
    pub sampler: Sampler,
    /// Divides the slopes of the normal texture.
    pub normal_scale: f32,
}

impl<'a> MapOffsets<'a> {
    /// Puts `bump_map` on its grid.
    pub fn new(bump_map: &'a BumpMap, settings: &'a Settings, sampler: Sampler) -> Result<Self, GridError> {
        let bumps = Bumps::new(bump_map, grid(settings, [size_of(bump_map)])?);
        Ok(Self { bump_map, bumps, settings, sampler, normal_scale: 1.0 })
    }

    /// Chooses the scale of the normal texture.
    pub fn scaling_normals(self) -> Self {
        Self { normal_scale: normal_scale(&self.bumps), ..self }
    }

    /// Returns whether lobes on a grid of `size` texels can decide the directions of the map's texels. `slope_scale`
    /// multiplies the offsets under them.
    pub fn can_be_decided_by(&self, size: (u32, u32), slope_scale: f32) -> bool {
        slope_scale != 0.0 && size == self.bumps.size()
    }
}

/// Returns the columns and rows of a bump map.
pub fn size_of(bump_map: &BumpMap) -> (u32, u32) {
    (bump_map.width(), bump_map.height())
}

/// Makes a bump map of an image.
pub fn bump_map_of(image: Image, kind: BumpMapKind) -> Result<BumpMap, MapError> {
    match kind {
        BumpMapKind::Normals => Ok(BumpMap::Normals(NormalMap::new(image, NormalLayout::Auto, false)?)),
        BumpMapKind::Heights { slope_per_repeat: [across, up], square_texels, wrap } => {
            let rows = if square_texels { image.width } else { image.height };
            let slope_per_step = [across * image.width as f32, up * rows as f32];
            Ok(BumpMap::Heights { map: HeightMap::new(image)?, slope_per_step, wrap })
        }
    }
}
