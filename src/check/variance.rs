//! The law of total variance over the levels of a pyramid (DESIGN, section 3): the mean of the offsets, and the mean of K
//! plus the covariance of the offsets, are the same at every level.

use super::extension::RoughnessModel;
use super::findings::{Code, Findings};
use crate::map::{Image, Rgba, Samples};
use crate::pyramid::Rows;
use crate::texture::ktx2::Ktx2;

/// Largest deviation, in steps of storage: those of offsets and roughness at both levels added up. Measured under UASTC
/// with D: 0.13 at every level of FlightHelmet, AnisotropyBarnLamp and the plastic chair, 0.41 of ridges that are one texel
/// wide.
pub const MAX_STEPS: f64 = 1.0;

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
    /// Steps of storage of offsets and roughness.
    step: f64,
}

/// Compares every level with the first that both textures have.
pub fn check_variance(levels: &Levels<'_>, place: &str, findings: &mut Findings) {
    let Levels { offset, roughness } = levels;
    // Roughness data may begin with a coarser level.
    let begins = |level: &u32| match roughness {
        None => true,
        Some((_, ranged)) => offset.file.level_size(*level) == ranged.file.level_size(0),
    };
    let Some(first) = (0..offset.file.level_count()).find(begins) else { return };
    let of_level = |level: u32| {
        let roughness = roughness.as_ref().map(|(model, ranged)| (*model, ranged, level - first));
        total(offset, level, roughness)
    };
    // What cannot be decoded is told by itself.
    let Some(reference) = of_level(first) else { return };
    for level in first + 1..offset.file.level_count() {
        let Some(found) = of_level(level) else { return };
        if let Some(message) = deviation(&reference, &found, first) {
            findings.add(Code::Variance, format!("{place}, level {level}"), message);
        }
    }
}

/// What is not conserved from `reference`, the level `first`, to `found`.
fn deviation(reference: &Total, found: &Total, first: u32) -> Option<String> {
    // Texels that storage moves by e, root mean square, move their mean by at most e, and the root of their mean square
    // likewise (triangle inequality); a covariance A A^T becomes B B^T, and differs by at most |A - B| (|A| + |B|).
    let limit = MAX_STEPS * (reference.step + found.step);
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
    let turned = (uu * uu + 2.0 * uv * uv + vv * vv).sqrt() > limit * (most + found_most);
    let is_off = if reference.is_full { turned } else { least - found_most > limit || found_least - most > limit };
    is_off.then(|| {
        format!(
            "expected slopes of standard deviation {least:.4} and of the covariance of level {first}, found \
             {found_most:.4}: storage explains {limit:.4}; bake again"
        )
    })
}

fn total(offset: &Ranged<'_>, level: u32, roughness: Option<(RoughnessModel, &Ranged<'_>, u32)>) -> Option<Total> {
    let (offsets, mut step) = offset.values::<2>(level)?;
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
            step += own;
            // K = D D^T
            for [d1, d2, d3] in &factors {
                covariance = [covariance[0] + d1 * d1 + d2 * d2, covariance[1] + d2 * d3, covariance[2] + d3 * d3];
            }
        }
        Some((RoughnessModel::StandardDeviation, ranged, level)) => {
            let (lambdas, own) = ranged.values::<1>(level)?;
            step += own;
            // The other eigenvalue is between 0 and lambda_1^2.
            let larger = lambdas.iter().map(|[lambda]| lambda * lambda).sum::<f64>() / count;
            open = [larger, 2.0 * larger];
        }
    }
    let covariance = covariance.map(|c| c / count);
    let deviation = open.map(|open| (covariance[0] + covariance[2] + open).max(0.0).sqrt());
    let is_full = matches!(roughness, Some((RoughnessModel::CovarianceFactor, ..)));
    Some(Total { mean, covariance, deviation, is_full, step })
}

impl Ranged<'_> {
    /// What the texels of a level stand for, and how much a step of storage is.
    fn values<const N: usize>(&self, level: u32) -> Option<(Vec<[f64; N]>, f64)> {
        let image = self.file.decode_level(level).ok()?;
        let (min, max): (&[f64; N], &[f64; N]) = (self.min.try_into().ok()?, self.max.try_into().ok()?);
        let mut values = Vec::with_capacity(image.width as usize * image.height as usize);
        let rows = Rgba(&image);
        let mut row = vec![[0.0; 4]; image.width as usize];
        for y in 0..image.height {
            rows.row(y, &mut row);
            let value = |texel: &[f32; 4]| std::array::from_fn(|c| min[c] + f64::from(texel[c]) * (max[c] - min[c]));
            values.extend(row.iter().map(value));
        }
        let step = step(&image, &values, min, max);
        Some((values, step))
    }
}

fn step<const N: usize>(image: &Image, values: &[[f64; N]], min: &[f64; N], max: &[f64; N]) -> f64 {
    match image.samples {
        // Half floats have 11 bits.
        Samples::F32(_) => values.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs())) / 2048.0,
        _ => (0..N).map(|c| (max[c] - min[c]).abs() / 255.0).fold(0.0, f64::max),
    }
}
