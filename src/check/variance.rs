//! The law of total variance over the levels of a pyramid (DESIGN, section 3): the mean of the offsets, and the mean of K
//! plus the covariance of the offsets, are the same at every level.

use std::f64::consts::SQRT_2;

use super::extension::RoughnessModel;
use super::storage::Storage;
use super::texels::{extents, norm};
use crate::ktx2::Ktx2;

/// A texture of the extension and what its texels stand for.
pub struct Ranged<'a> {
    /// The file.
    pub file: Ktx2<'a>,
    /// Values of a texel of 0.
    pub min: &'a [f64],
    /// Values of a texel of 1.
    pub max: &'a [f64],
}

/// Offsets and, where there is one, roughness.
pub struct Levels<'a> {
    /// (f_u, f_v).
    pub offset: Ranged<'a>,
    /// D or lambda_1.
    pub roughness: Option<(RoughnessModel, Ranged<'a>)>,
}

/// Mean and covariance of all slopes under a level.
#[derive(Clone, Copy, Debug)]
struct Total {
    mean: [f64; 2],
    /// uu, uv, vv; without K where only lambda_1 is known.
    covariance: [f64; 3],
    /// Least and largest standard deviation along both axes together that what is stored allows.
    deviation: [f64; 2],
    /// Whether K is known, and not only lambda_1.
    is_full: bool,
    /// What storage makes of offsets, and of offsets and roughness together: root mean square.
    errors: [f64; 2],
}

/// Compares every level with the first that both textures have; returns which levels do not conserve what, in words.
pub fn check_variance(levels: &Levels<'_>) -> Vec<(u32, String)> {
    let Levels { offset, roughness } = levels;
    // Roughness data may begin with a coarser level.
    let begins = |level: &u32| match roughness {
        None => true,
        Some((_, ranged)) => offset.file.level_size(*level) == ranged.file.level_size(0),
    };
    let Some(first) = (0..offset.file.level_count()).find(begins) else { return Vec::new() };
    let of_level = |level: u32| {
        let roughness = roughness.as_ref().map(|(model, ranged)| (*model, ranged, level - first));
        total(offset, level, roughness)
    };
    // What cannot be decoded is told by itself.
    let Some(reference) = of_level(first) else { return Vec::new() };
    let others = (first + 1..offset.file.level_count()).map_while(|level| Some((level, of_level(level)?)));
    others.filter_map(|(level, found)| Some((level, deviation(&reference, &found, first)?))).collect()
}

/// Tells what is not conserved from `reference`, the level `first`, to `found`.
///
/// Storage moves texels by e, root mean square ([`Storage`]). Their mean then moves by at most e, and the root of their mean
/// square likewise (triangle inequality). With offsets and columns of D as the columns of A, all of them over the root of
/// their number, the covariance A A^T becomes B B^T, and differs by at most |A - B| (|A| + |B|), where |A - B| is at most e.
/// Both levels have an error, and the two add up.
fn deviation(reference: &Total, found: &Total, first: u32) -> Option<String> {
    let [limit, joint] = [0, 1].map(|i| reference.errors[i] + found.errors[i]);
    let [du, dv] = [0, 1].map(|i| found.mean[i] - reference.mean[i]);
    if du.hypot(dv) > limit {
        let text = |[u, v]: [f64; 2]| format!("({u:.4}, {v:.4})");
        let means = (text(reference.mean), text(found.mean));
        return Some(format!(
            "expected offsets of mean {}, as at level {first}, found {}: storage explains {limit:.4}; bake again",
            means.0, means.1
        ));
    }
    let ([least, most], [found_least, found_most]) = (reference.deviation, found.deviation);
    let [uu, uv, vv] = [0, 1, 2].map(|i| found.covariance[i] - reference.covariance[i]);
    let turned = (uu * uu + 2.0 * uv * uv + vv * vv).sqrt() > joint * (most + found_most);
    let is_off = if reference.is_full { turned } else { least - found_most > joint || found_least - most > joint };
    is_off.then(|| {
        format!(
            "expected slopes of standard deviation {least:.4} and of the covariance of level {first}, found \
             {found_most:.4}: storage explains {joint:.4}; bake again"
        )
    })
}

fn total(offset: &Ranged<'_>, level: u32, roughness: Option<(RoughnessModel, &Ranged<'_>, u32)>) -> Option<Total> {
    let (offsets, error) = offset.values::<2>(level)?;
    let mut errors = [error; 2];
    let count = offsets.len().max(1) as f64;
    let mean = [0, 1].map(|c| offsets.iter().map(|o| o[c]).sum::<f64>() / count);
    let mut covariance = [0.0; 3];
    for [u, v] in &offsets {
        let [du, dv] = [u - mean[0], v - mean[1]];
        covariance = [covariance[0] + du * du, covariance[1] + du * dv, covariance[2] + dv * dv];
    }
    // The trace of K that is not known: between these.
    let mut open = [0.0; 2];
    match roughness {
        // Nothing of K is known.
        None => open[1] = f64::INFINITY,
        Some((RoughnessModel::CovarianceFactor, ranged, level)) => {
            let (factors, own) = ranged.values::<3>(level)?;
            errors[1] = error.hypot(own);
            // K = D D^T
            for [d1, d2, d3] in &factors {
                covariance = [covariance[0] + d1 * d1 + d2 * d2, covariance[1] + d2 * d3, covariance[2] + d3 * d3];
            }
        }
        Some((RoughnessModel::StandardDeviation, ranged, level)) => {
            let (lambdas, own) = ranged.values::<1>(level)?;
            // Both eigenvalues may be off.
            errors[1] = error.hypot(own * SQRT_2);
            // The other eigenvalue is between 0 and lambda_1^2.
            let larger = lambdas.iter().map(|[lambda]| lambda * lambda).sum::<f64>() / count;
            open = [larger, 2.0 * larger];
        }
    }
    let covariance = covariance.map(|c| c / count);
    let deviation = open.map(|open| (covariance[0] + covariance[2] + open).max(0.0).sqrt());
    let is_full = matches!(roughness, Some((RoughnessModel::CovarianceFactor, ..)));
    Some(Total { mean, covariance, deviation, is_full, errors })
}

impl Ranged<'_> {
    /// What the texels of a level stand for, block by block, and how far storage moves them, root mean square.
    fn values<const N: usize>(&self, level: u32) -> Option<(Vec<[f64; N]>, f64)> {
        let storage = Storage::of(&self.file, level).ok()?;
        let (min, max): (&[f64; N], &[f64; N]) = (self.min.try_into().ok()?, self.max.try_into().ok()?);
        let span: [f64; N] = std::array::from_fn(|c| max[c] - min[c]);
        let scaled = |texel: [f64; N]| -> [f64; N] { std::array::from_fn(|c| texel[c] * span[c].abs()) };
        let mut values = Vec::with_capacity(storage.image().width as usize * storage.image().height as usize);
        let mut squares = 0.0;
        storage.visit::<N>(|texels, rounding| {
            let error = norm(scaled(rounding)) + storage.residual(scaled(extents(texels)));
            squares += error * error * texels.len() as f64;
            values.extend(texels.iter().map(|texel| std::array::from_fn(|c| min[c] + texel[c] * span[c])));
        });
        let error = (squares / values.len().max(1) as f64).sqrt();
        Some((values, error))
    }
}
