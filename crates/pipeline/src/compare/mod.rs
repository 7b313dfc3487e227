//! Comparison of error and cost: every model of ours and every peer on one material, scored by [`crate::metric`].
//!
//! The reference is level 0 of the material with unencoded normals. Our models are decoded baked textures. Peers read
//! the encoded normals of plain mips and use exact moments for everything else. [`compare`] takes materials as the
//! renderer reads them. [`compare_files`] bakes the materials of files for it, and writes charts and tables.

mod chart;
mod cost;
mod entry;
mod files;
mod labels;
mod ours;
mod page;
mod pictures;
mod report;
mod table;
#[cfg(test)]
mod tests;
mod units;
mod verdict;

use crate::lobe::{Family, SquaredAlpha};
use crate::math::symmetric::Symmetric2;
use crate::metric::{Lobe, Peer, Surface, mean_errors, oracle, sample_texels};
use crate::mip::level_sizes;
use crate::render::{Advance, Material};

pub use chart::Measure;
pub use chart::file as chart;
pub use cost::{Axis, Cost};
pub use entry::{Comparison, Entry, Kind};
pub use files::{Charts, CompareError, CompareOptions, FailedInput, compare_files};
pub use ours::Ours;
use ours::normals;
pub use page::page;
pub use pictures::MAX_PICTURE_WIDTH;
use pictures::picture_errors;
pub use report::{COMPARE_FORMAT, ComparisonReport};
pub use table::csv;

/// Number of our entries: three models, each baked in two qualities, and the choice of `--model auto`.
pub const OURS: usize = 7;
const PEERS: usize = Peer::ALL.len();
const ENTRIES: usize = OURS + PEERS + 1;
/// Last level that is scored. Coarser levels have footprints of more than 128 x 128 texels, which take long to score
/// and show little.
const LAST_LEVEL: usize = 7;
/// First level of the mean error, if the map has that many levels, as in docs/accuracy.md.
const MEAN_FROM: usize = 2;

/// The share of the work that is scoring of texels if pictures are drawn, as the bar of progress shows it.
const SCORING: f32 = 0.6;

/// Scores our models and the peers at `texels` sampled texels of each level up to 7, and on pictures that are
/// `picture_width` pixels wide. A width of 0 draws none.
///
/// The first of `ours` has plain mips. `truth` is the material with unencoded normals. `advance` receives the finished
/// share of the work. Returns `None` for a material without a normal map.
pub fn compare(
    name: &str,
    truth: &Material,
    ours: [Ours; OURS],
    texels: usize,
    picture_width: u32,
    advance: Advance<'_>,
) -> Option<Comparison> {
    let grid = normals(&ours[0].material)?;
    let surface = surface(truth)?;
    // Block encoding may have resampled the bumps to multiples of 4.
    let (width, height) = ours[0].material.finest_size();
    let mut sizes = level_sizes(width, height);
    sizes.truncate(LAST_LEVEL + 1);
    let mut by_level = Vec::with_capacity(sizes.len());
    for (level, size) in sizes.iter().copied().enumerate() {
        let chosen = sample_texels(size, texels);
        by_level.push(mean_errors(&surface, Family::Ggx, size, &chosen, |texel, footprint, reference| {
            let moments = footprint.moments();
            let normal = lobe(&ours[0].material, size, texel).normal();
            let peers = Peer::ALL.map(|peer| peer.lobe(Family::Ggx, &moments));
            let peers = peers.map(|peer| Lobe::new(Family::Ggx, normal, peer.squared_alpha()));
            let lobes: Vec<Lobe> = ours.iter().map(|o| lobe(&o.material, size, texel)).chain(peers).collect();
            let mut errors = [0.0; ENTRIES];
            for (error, lobe) in errors.iter_mut().zip(&lobes) {
                *error = reference.error(lobe);
            }
            errors[ENTRIES - 1] = oracle(reference, &lobes).1;
            errors
        }));
        let scoring = if picture_width > 0 { SCORING } else { 1.0 };
        advance(scoring * (level + 1) as f32 / sizes.len() as f32);
    }
    let drawn = |share: f32| advance(SCORING + (1.0 - SCORING) * share);
    let pictures = if picture_width > 0 { picture_errors(truth, &surface, &ours, picture_width, &drawn) } else { None };
    let plain = Cost::of_bake(&ours[0]);
    let finest = ours[0].material.textures().max_by_key(|texture| texture.size(0)).unwrap_or(grid);
    let ours = ours.iter().map(|o| (o.name.clone(), Kind::Ours, o.chosen, Cost::of_bake(o)));
    let peers = Peer::ALL.iter().map(|peer| {
        let cost = Cost::of_peer(*peer, grid, finest, truth.roughness.is_some(), &plain);
        (peer.name().to_owned(), Kind::Peer, false, cost)
    });
    let best = ("oracle".to_owned(), Kind::Oracle, false, Cost::default());
    let entries = ours.chain(peers).chain([best]).enumerate().map(|(i, (name, kind, chosen, cost))| {
        let level_errors: Vec<f64> = by_level.iter().map(|errors| errors[i]).collect();
        let averaged = level_errors.get(MEAN_FROM..).filter(|rest| !rest.is_empty()).unwrap_or(&level_errors);
        let error = averaged.iter().sum::<f64>() / averaged.len().max(1) as f64;
        let picture_error = pictures.as_ref().and_then(|pictures| pictures.errors.get(i).copied());
        Entry { name, kind, chosen, error, level_errors, picture_error, cost }
    });
    let entries = entries.collect();
    let picture_noise = pictures.map(|pictures| pictures.noise);
    Some(Comparison { material: name.to_owned(), verdict: None, picture_noise, entries })
}

fn lobe(material: &Material, size: (u32, u32), texel: (u32, u32)) -> Lobe {
    let point = material.point(&|texture| texture.linear_of_size(size, centre(size, texel)));
    Lobe::new(Family::Ggx, point.normal, point.squared_alpha)
}

fn centre(size: (u32, u32), (x, y): (u32, u32)) -> [f64; 2] {
    [(f64::from(x) + 0.5) / f64::from(size.0), (f64::from(y) + 0.5) / f64::from(size.1)]
}

/// Returns level 0 on the grid of the finest texture, on which samplers magnify the others.
fn surface(truth: &Material) -> Option<Surface> {
    let (width, height) = truth.finest_size();
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let (normals, base): (Vec<_>, Vec<_>) = texels
        .map(|texel| {
            let point = truth.point(&|texture| texture.linear_of_size((width, height), centre((width, height), texel)));
            let [uu, uv, vv] = point.squared_alpha.map(|a| a as f32);
            (point.normal, SquaredAlpha(Symmetric2 { uu, uv, vv }))
        })
        .unzip();
    Surface::new(width, height, &normals, &base)
}
