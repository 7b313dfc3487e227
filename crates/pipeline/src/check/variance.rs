//! The law of total variance over the levels of a pyramid: the mean of the offsets, and the mean of K plus the
//! covariance of the offsets, are the same at every level.

use std::f64::consts::SQRT_2;

use super::decoded_levels::{extents, norm};
use super::storage::Storage;
use crate::gltf::roughness_pyramid::RoughnessModel;
use crate::ktx2::Ktx2;

/// A texture of the extension and the range of its values.
pub struct RangedTexture<'a> {
    /// The file.
    pub file: Ktx2<'a>,
    /// Value of a texel of 0, channel by channel.
    pub min: &'a [f64],
    /// Value of a texel of 1, channel by channel.
    pub max: &'a [f64],
}

/// The offset texture and, if present, the roughness texture.
pub struct Levels<'a> {
    /// (f_u, f_v).
    pub offset: RangedTexture<'a>,
    /// D or lambda_1.
    pub roughness: Option<(RoughnessModel, RangedTexture<'a>)>,
}

/// Mean and covariance of all slopes that a level stores.
#[derive(Clone, Copy, Debug)]
struct Total {
    mean: [f64; 2],
    /// uu, uv, vv; without K if only lambda_1 is stored.
    covariance: [f64; 3],
    /// Smallest and largest standard deviation along both axes together that the stored values allow.
    deviation: [f64; 2],
    /// Whether K is stored, and not only lambda_1.
    is_full: bool,
    /// Root mean square storage error of offsets, and of offsets and roughness together.
    errors: [f64; 2],
}

/// Compares every level with the first level that both textures have. Returns a message for each level that does not
/// conserve mean or covariance.
pub fn check_variance(levels: &Levels<'_>) -> Vec<(u32, String)> {
    let Levels { offset, roughness } = levels;
    // The roughness texture may begin with a coarser level than the offset texture.
    let begins = |level: &u32| match roughness {
        None => true,
        Some((_, ranged)) => offset.file.level_size(*level) == ranged.file.level_size(0),
    };
    let Some(first) = (0..offset.file.level_count()).find(begins) else { return Vec::new() };
    let of_level = |level: u32| {
        let roughness = roughness.as_ref().map(|(model, ranged)| (*model, ranged, level - first));
        total(offset, level, roughness)
    };
    // RC1401 reports levels that cannot be decoded.
    let Some(reference) = of_level(first) else { return Vec::new() };
    let coarser = (first + 1..offset.file.level_count()).map_while(|level| Some((level, of_level(level)?)));
    coarser.filter_map(|(level, found)| Some((level, deviation(&reference, &found, first)?))).collect()
}

/// Returns a message if `found` does not conserve mean or covariance of `reference`, which is the level `first`.
///
/// Storage moves texels by e, root mean square ([`Storage`]). By the triangle inequality their mean moves by at most e,
/// and so does the root of their mean square. Let the columns of A be the offsets and the columns of D, each divided by
/// the root of their number. Storage turns the covariance A A^T into B B^T. The two differ by at most
/// |A - B| (|A| + |B|), where |A - B| is at most e. Both levels have an error, and the errors add up.
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
    let differs = (uu * uu + 2.0 * uv * uv + vv * vv).sqrt() > joint * (most + found_most);
    let is_off = if reference.is_full { differs } else { least - found_most > joint || found_least - most > joint };
    is_off.then(|| {
        format!(
            "expected slopes of standard deviation {least:.4} and of the covariance of level {first}, found \
             {found_most:.4}: storage explains {joint:.4}; bake again"
        )
    })
}

/// Returns mean, covariance and storage errors of `level`, or `None` if the level cannot be decoded.
fn total(
    offset: &RangedTexture<'_>,
    level: u32,
    roughness: Option<(RoughnessModel, &RangedTexture<'_>, u32)>,
) -> Option<Total> {
    let (offsets, error) = offset.values::<2>(level)?;
    let mut errors = [error; 2];
    let count = offsets.len().max(1) as f64;
    let mean = [0, 1].map(|c| offsets.iter().map(|o| o[c]).sum::<f64>() / count);
    let mut covariance = [0.0; 3];
    for [u, v] in &offsets {
        let [du, dv] = [u - mean[0], v - mean[1]];
        covariance = [covariance[0] + du * du, covariance[1] + du * dv, covariance[2] + dv * dv];
    }
    // Bounds of the part of the trace of K that is not stored.
    let mut open = [0.0; 2];
    match roughness {
        // Without a roughness texture nothing of K is known.
        None => open[1] = f64::INFINITY,
        Some((RoughnessModel::CovarianceFactor, ranged, level)) => {
            let (factors, roughness_error) = ranged.values::<3>(level)?;
            errors[1] = error.hypot(roughness_error);
            // K = D D^T
            for [d1, d2, d3] in &factors {
                covariance = [covariance[0] + d1 * d1 + d2 * d2, covariance[1] + d2 * d3, covariance[2] + d3 * d3];
            }
        }
        Some((RoughnessModel::StandardDeviation, ranged, level)) => {
            let (lambdas, roughness_error) = ranged.values::<1>(level)?;
            // Both eigenvalues may have this error.
            errors[1] = error.hypot(roughness_error * SQRT_2);
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

impl RangedTexture<'_> {
    /// Returns the values of a level, block by block, and their root mean square storage error.
    fn values<const N: usize>(&self, level: u32) -> Option<(Vec<[f64; N]>, f64)> {
        let storage = Storage::decode(&self.file, level).ok()?;
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
