//! The notes to the user on a bump map and its bake, and the thresholds above which they are made.

use crate::bump::Outliers;
use crate::material::bump_map::BumpMap;
use crate::material::lossy_format::lossy_format;
use crate::material::roughening::Roughening;
use crate::math::symmetric::Symmetric2;
use crate::mip::TexelRows;
use crate::note::{self, Note};
use crate::settings::Model;

/// Smallest share of texels with opposed neighbours that is reported. A map with one seam across 1024 texels has 0.3 %.
const MIN_OPPOSED: f32 = 0.001;

/// Smallest lobe error by rounding that is reported.
const MIN_ROUNDING: f32 = 0.05;

/// Smallest share of the variance lost by filtering that is reported: 5 % of alpha.
const MIN_FILTER_LOSS: f32 = 0.1;

/// Returns the note of the file of a bump map whose format changes the bumps.
pub fn of_file(file: &[u8]) -> Option<Note> {
    lossy_format(file).map(note::lossy_source)
}

/// Returns the notes of a bump map that is baked on a grid of `grid` (columns, rows).
pub fn of_bump_map(bump_map: &BumpMap, grid: (u32, u32)) -> Vec<Note> {
    let mut notes = Vec::new();
    let (width, height) = (bump_map.width(), bump_map.height());
    let texels = u64::from(width) * u64::from(height);
    let Outliers { steep, below, unused } = bump_map.outliers();
    if steep > 0 {
        notes.push(note::steep_slopes(steep, texels));
    }
    if below > 0 {
        notes.push(note::normals_below_surface(below, texels));
    }
    if unused > 0 {
        notes.push(note::unused_texels(unused, texels));
    }
    if grid != (width, height) {
        notes.push(note::resampled((width, height), grid));
    }
    notes
}

/// Returns the note of a texture of D that loses the share `loss` of the variance under bilinear filtering
/// ([`crate::material::filter_loss()`]).
pub fn of_factor(loss: f32) -> Option<Note> {
    (loss > MIN_FILTER_LOSS).then(|| note::filter_loss(loss))
}

/// Returns the notes of a lobe that is roughened and stored under `model`. `noise` is the covariance of slopes that
/// rounding of the bump map alone makes.
pub fn of_roughening(roughening: &Roughening<'_>, model: Model, noise: Symmetric2) -> Vec<Note> {
    let mut notes = Vec::new();
    let too_wide = roughening.texels_above_one(model);
    if too_wide > 0 {
        notes.push(note::alpha_above_one(too_wide));
    }
    let noise = roughening.noise_loss(noise);
    if noise > MIN_ROUNDING {
        notes.push(note::small_depth(noise));
    }
    if model == Model::Anisotropic {
        let opposed = roughening.opposed_share();
        if opposed > MIN_OPPOSED {
            notes.push(note::opposed_directions(opposed));
        }
    }
    notes
}

#[cfg(test)]
mod tests;
