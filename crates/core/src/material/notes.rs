//! Notes to the user about a bump map and its bake. docs/stability.md explains each of them.

use crate::bump::{MAX_SLOPE, Outliers};
use crate::image::FileFormat;
use crate::material::bump_map::BumpMap;
use crate::material::roughening::Roughening;
use crate::math::symmetric::Symmetric2;
use crate::mip::TexelRows;
use crate::settings::Model;

/// Returns whether a file is a JPEG.
pub fn is_jpeg(file: &[u8]) -> bool {
    FileFormat::detect(file, None) == Some(FileFormat::Jpeg)
}

/// The note of a bump map that is a JPEG.
pub const JPEG: &str = "the bump map is a JPEG: its compression adds and removes bumps, which the bake takes for the \
                        surface's; use a lossless source";

/// Share of texels with opposed neighbours from which on a note says so. A map with one seam across 1024 texels has 0.3
/// %.
const MIN_OPPOSED: f32 = 0.001;

/// Lobe error by rounding from which on a note says so.
const MIN_ROUNDING: f32 = 0.05;

/// Share of the variance that filtering loses from which on a note says so: 5 % of alpha.
const MIN_FILTER_LOSS: f32 = 0.1;

/// Returns the notes of a bump map that is baked on a grid of `grid` (columns, rows).
pub fn of_bump_map(bump_map: &BumpMap, grid: (u32, u32)) -> Vec<String> {
    let mut notes = Vec::new();
    let (width, height) = (bump_map.width(), bump_map.height());
    let texels = u64::from(width) * u64::from(height);
    let Outliers { steep, below } = bump_map.outliers();
    if steep > 0 {
        notes.push(format!("{steep} of {texels} texels are steeper than {MAX_SLOPE}: they are baked with that slope"));
    }
    if below > 0 {
        notes.push(format!(
            "{below} of {texels} normals point along the surface or below it: they are baked with a slope of {MAX_SLOPE}"
        ));
    }
    if grid != (width, height) {
        notes.push(format!(
            "the map of {width} x {height} texels was resampled to {} x {}: block formats need multiples of 4",
            grid.0, grid.1
        ));
    }
    notes
}

/// Returns the note of a texture of D that loses the share `loss` of the variance under bilinear filtering
/// ([`crate::material::filter_loss()`]).
pub fn of_factor(loss: f32) -> Option<String> {
    (loss > MIN_FILTER_LOSS).then(|| {
        format!(
            "halfway between texels, filtering D loses up to {:.0} % of the variance that filtering K would keep: \
             neighbours differ that much",
            100.0 * loss
        )
    })
}

/// Returns the notes of a lobe that is roughened and stored under `model`. `noise` is the covariance of slopes that
/// rounding of the bump map alone makes.
pub fn of_roughening(roughening: &Roughening<'_>, model: Model, noise: Symmetric2) -> Vec<String> {
    let mut notes = Vec::new();
    let too_wide = roughening.texels_above_one(model);
    if too_wide > 0 {
        notes.push(format!(
            "about {too_wide} texels over all levels are rougher than an engine can show: alpha is clamped to 1"
        ));
    }
    let noise = roughening.noise_loss(noise);
    if noise > MIN_ROUNDING {
        notes.push(format!(
            "the depth of the bump map is too small for so smooth a surface: rounding alone moves its lobes by {noise:.3}; \
             use a map with more bits"
        ));
    }
    if model == Model::Anisotropic {
        let opposed = roughening.opposed_share();
        if opposed > MIN_OPPOSED {
            notes.push(format!(
                "{:.1} % of the directions of anisotropy point away from a neighbour's, as around the centre of circular \
                 grooves: filtering loses the direction there",
                100.0 * opposed
            ));
        }
    }
    notes
}

#[cfg(test)]
mod tests;
