//! What the user should know of a bump map and of what became of it; docs/stability.md tells of each.

use crate::bump::{MAX_SLOPE, Outliers};
use crate::image::Format;
use crate::material::bump_map::BumpMap;
use crate::material::roughening::Roughening;
use crate::math::symmetric::Symmetric2;
use crate::mip::Rows;
use crate::settings::Model;

/// Whether a file is a JPEG.
pub fn is_jpeg(file: &[u8]) -> bool {
    Format::detect(file, None) == Some(Format::Jpeg)
}

/// Of a map in a format that makes and loses bumps.
pub const JPEG: &str = "the bump map is a JPEG: bumps that its compression made or lost count as the surface's; a lossless \
                        source is better";

/// Share of texels with opposed neighbours from which on it is told: a map with one seam across 1024 texels has 0.3 %.
const OPPOSED: f32 = 0.001;

/// Lobe error that rounding makes from which on it is told.
const ROUNDED: f32 = 0.05;

/// Share of the variance from which on its loss in the filter is told: 5 % of alpha.
const FILTERED: f32 = 0.1;

/// Of a bump map that is baked on a grid of `grid` (columns, rows).
pub fn of_bump_map(bump_map: &BumpMap, grid: (u32, u32)) -> Vec<String> {
    let mut notes = Vec::new();
    let (width, height) = (bump_map.width(), bump_map.height());
    let texels = u64::from(width) * u64::from(height);
    let Outliers { steep, below } = bump_map.outliers();
    if steep > 0 {
        notes.push(format!("{steep} of {texels} texels are steeper than {MAX_SLOPE}: taken as that steep"));
    }
    if below > 0 {
        notes.push(format!(
            "{below} of {texels} normals point along the surface or below it: taken as slopes of {MAX_SLOPE}"
        ));
    }
    if grid != (width, height) {
        notes.push(format!(
            "the map of {width} x {height} texels was resampled to {} x {}: block formats want multiples of 4",
            grid.0, grid.1
        ));
    }
    notes
}

/// Of D, filtered as samplers do, of which `loss` is lost ([`crate::material::pyramids::filter_loss`]).
pub fn of_factor(loss: f32) -> Option<String> {
    (loss > FILTERED).then(|| {
        format!(
            "halfway between texels, filtering D loses up to {:.0} % of the variance that filtering K would keep: \
             neighbours differ that much",
            100.0 * loss
        )
    })
}

/// Of bumps folded into a lobe; `noise` is the covariance of slopes that rounding alone makes.
pub fn of_roughening(roughening: &Roughening<'_>, model: Model, noise: Symmetric2) -> Vec<String> {
    let mut notes = Vec::new();
    let too_wide = roughening.texels_above_one(model);
    if too_wide > 0 {
        notes.push(format!(
            "about {too_wide} texels over all levels are rougher than an engine can show: alpha is clamped to 1"
        ));
    }
    let noise = roughening.noise_loss(noise);
    if noise > ROUNDED {
        notes.push(format!(
            "the depth of the bump map is too small for so smooth a surface: rounding alone moves its lobes by {noise:.3}; \
             a map of more bits is better"
        ));
    }
    if model == Model::Anisotropic {
        let opposed = roughening.opposed_share();
        if opposed > OPPOSED {
            notes.push(format!(
                "{:.1} % of the directions of anisotropy point away from a neighbour's, as where axes turn all the way \
                 round and no choice of signs agrees: filtering loses the direction there",
                100.0 * opposed
            ));
        }
    }
    notes
}

#[cfg(test)]
mod tests;
