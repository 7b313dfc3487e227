//! The levels of a pyramid against its first level: a coarser level can neither turn its lobes further from the mean,
//! nor widen them more, than the bumps of the first level explain.
//!
//! Let m and K be mean and covariance of the first level's offsets under a texel. Lobes of the largest likelihood are
//! off the mean, and narrower than K, where few texels are steep, so that m and K themselves need not be stored. But
//! they have bounds. A GGX lobe of the largest likelihood has A = 4 E[s^2 / (1 + s^2 / A)] along an axis. This is
//! concave in s^2, so that A is at most 3 E[s^2], and the stored K at most 1.5 times the covariance. A lobe about one
//! of two groups of slopes, with a share p of the texels, is off the mean by sqrt((1 - p) / p) deviations: by 2 for
//! p = 0.2. There is no bound below: where the base lobe varies, a roughened lobe may be narrower than its mean.

use super::decoded_levels::{extents, norm};
use super::storage::Storage;
use crate::bump::{Moments, Offset};
use crate::gltf::roughness_pyramid::RoughnessModel;
use crate::image::Rgba;
use crate::ktx2::Ktx2;
use crate::lobe::Factor;
use crate::material::slopes_of_texel;
use crate::math::symmetric::Symmetric2;
use crate::mip::{Level, Pyramid, TexelRows};

/// The offset texture.
pub struct OffsetFile<'a> {
    /// The file.
    pub file: Ktx2<'a>,
    /// Whether z is stored.
    pub has_z: bool,
    /// What multiplies the slopes of the stored normals.
    pub scale: [f64; 2],
}

/// The roughness texture and the range of its values.
pub struct RoughnessFile<'a> {
    /// The file.
    pub file: Ktx2<'a>,
    /// What it holds.
    pub model: RoughnessModel,
    /// Value of a texel of 0, channel by channel.
    pub min: &'a [f64],
    /// Value of a texel of 1, channel by channel.
    pub max: &'a [f64],
}

/// The largest distance of a lobe from the mean, in standard deviations.
const MAX_SHIFT: f64 = 2.0;

/// The largest ratio of the stored K to the covariance. lambda_1 may have twice the trace of K, and fits by lobe error
/// may be wider than those of the largest likelihood.
const MAX_WIDENING: f64 = 2.0;

/// Compares every level with the first level that both textures have. Returns a message for each level that the first
/// level does not explain.
pub fn check_pyramid_levels(offset: &OffsetFile<'_>, roughness: Option<&RoughnessFile<'_>>) -> Vec<(u32, String)> {
    // The roughness texture may begin with a coarser level than the offset texture.
    let begins = |level: &u32| match roughness {
        None => true,
        Some(roughness) => offset.file.level_size(*level) == roughness.file.level_size(0),
    };
    let Some(first) = (0..offset.file.level_count()).find(begins) else { return Vec::new() };
    // RC1401 reports levels that cannot be decoded.
    let Some(explained) = Explained::new(offset, roughness, first) else { return Vec::new() };
    let coarser = (first + 1..offset.file.level_count()).zip(1..);
    let message = |(level, below): (u32, usize)| {
        let turned = offset.level(level).and_then(|found| explained.offsets(&found, below));
        let widened = || {
            let found = roughness?.level(level - first)?;
            explained.variance(&found, below)
        };
        Some((level, turned.or_else(widened)?))
    };
    coarser.filter_map(message).collect()
}

/// A decoded level of offsets, in the order of its rows.
struct OffsetLevel {
    width: u32,
    height: u32,
    offsets: Vec<[f64; 2]>,
    /// Root mean square storage error.
    error: f64,
}

/// A decoded level of D or lambda_1, in the order of its rows.
struct RoughnessLevel {
    covariances: Vec<Symmetric2>,
    /// Root mean square storage error of the columns of D.
    error: f64,
}

/// What the first level explains of coarser levels. Storage moves texels by e, root mean square ([`Storage`]). By the
/// triangle inequality, the root of the mean square of a level moves by at most e.
struct Explained {
    /// Means and covariances of the offsets, K of the first level included.
    moments: Pyramid<Level<Moments>>,
    /// Root mean square storage error.
    error: f64,
}

impl Explained {
    fn new(offset: &OffsetFile<'_>, roughness: Option<&RoughnessFile<'_>>, first: u32) -> Option<Self> {
        let OffsetLevel { width, height, offsets, error } = offset.level(first)?;
        let roughness = match roughness {
            Some(roughness) => Some(roughness.level(0)?),
            None => None,
        };
        let flat = |[u, v]: [f64; 2]| Moments::flat(Offset { u: u as f32, v: v as f32 });
        let mut texels: Vec<Moments> = offsets.into_iter().map(flat).collect();
        let lost = roughness.iter().flat_map(|roughness| &roughness.covariances);
        texels.iter_mut().zip(lost).for_each(|(moments, lost)| moments.covariance = *lost);
        let error = error.hypot(roughness.map_or(0.0, |roughness| roughness.error));
        Some(Self { moments: Pyramid::new(Level { width, height, texels }), error })
    }

    /// Returns a message if the offsets of a level, `below` levels below the first, are further from the means along an
    /// axis than bumps and storage explain.
    fn offsets(&self, found: &OffsetLevel, below: usize) -> Option<String> {
        let (mut distances, mut variances) = ([0.0; 2], [0.0; 2]);
        let mut row = vec![Moments::default(); found.width as usize];
        for (y, offsets) in (0..found.height).zip(found.offsets.chunks_exact(found.width as usize)) {
            self.moments.row(below, y, &mut row);
            for ([u, v], Moments { mean, covariance }) in offsets.iter().zip(&row) {
                let off = [u - f64::from(mean.u), v - f64::from(mean.v)];
                let variance = [covariance.uu, covariance.vv].map(f64::from);
                for axis in 0..2 {
                    distances[axis] += off[axis] * off[axis];
                    variances[axis] += variance[axis];
                }
            }
        }
        let count = found.offsets.len().max(1) as f64;
        let storage = found.error + (1.0 + MAX_SHIFT) * self.error;
        let root = |sums: [f64; 2], axis: usize| (sums[axis] / count).sqrt();
        let of_axis = |axis| {
            let (distance, limit) = (root(distances, axis), MAX_SHIFT * root(variances, axis) + storage);
            (distance > limit).then(|| {
                format!(
                    "expected offsets f_{} within {limit:.4} of the means of the first level, found {distance:.4}, root \
                     mean square: storage explains {storage:.4}; bake again",
                    ["u", "v"][axis]
                )
            })
        };
        (0..2).find_map(of_axis)
    }

    /// Returns a message if the lobes of a level, `below` levels below the first, are wider than bumps and storage
    /// explain.
    fn variance(&self, found: &RoughnessLevel, below: usize) -> Option<String> {
        let count = found.covariances.len().max(1) as f64;
        let lost = found.covariances.iter().map(|k| f64::from(k.trace())).sum::<f64>() / count;
        let &(width, height) = self.moments.sizes().get(below)?;
        let mut row = vec![Moments::default(); width as usize];
        let mut variance = 0.0;
        for y in 0..height {
            self.moments.row(below, y, &mut row);
            variance += row.iter().map(|m| f64::from(m.covariance.trace())).sum::<f64>();
        }
        let deviation = (variance / (f64::from(width) * f64::from(height))).sqrt();
        let storage = found.error + MAX_WIDENING.sqrt() * self.error;
        let limit = MAX_WIDENING.sqrt() * deviation + storage;
        (lost.sqrt() > limit).then(|| {
            format!(
                "expected lost bumps of a standard deviation of at most {limit:.4}, found {:.4}: the bumps of the first \
                 level have {deviation:.4}, and storage explains {storage:.4}; bake again",
                lost.sqrt()
            )
        })
    }
}

impl OffsetFile<'_> {
    fn level(&self, level: u32) -> Option<OffsetLevel> {
        let storage = Storage::decode(&self.file, level).ok()?;
        let error = if self.has_z { self.error::<3>(&storage) } else { self.error::<2>(&storage) };
        let (width, height) = (storage.image().width, storage.image().height);
        let offsets = texels(&storage).map(|texel| {
            let [u, v] = slopes_of_texel(self.normal(texel));
            [u * self.scale[0], v * self.scale[1]]
        });
        Some(OffsetLevel { width, height, offsets: offsets.collect(), error })
    }

    /// Returns a texel with the z that a reader rebuilds if there is none.
    fn normal(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        if self.has_z {
            return [x, y, z];
        }
        let [nx, ny] = [x, y].map(|c| 2.0 * c - 1.0);
        [x, y, 0.5 + 0.5 * (1.0 - nx * nx - ny * ny).max(0.0).sqrt()]
    }

    /// Returns the root mean square storage error of offsets. A direction of slope g that moves by d changes g by
    /// (1 + g^2) d, and by more if z is rebuilt from x and y.
    fn error<const N: usize>(&self, storage: &Storage) -> f64 {
        let scale = self.scale[0].abs().max(self.scale[1].abs());
        let (mut squares, mut count) = (0.0, 0.0);
        storage.visit::<N>(|texels, rounding| {
            let error = 2.0 * (norm(rounding) + storage.residual(extents(texels)));
            for texel in texels {
                let texel = std::array::from_fn(|c| texel.get(c).copied().unwrap_or(0.0));
                let [u, v] = slopes_of_texel(self.normal(texel));
                let steepness = 1.0 + u * u + v * v;
                let change = if self.has_z { steepness } else { steepness.powf(1.5) };
                squares += (scale * change * error).powi(2);
                count += 1.0;
            }
        });
        (squares / f64::max(count, 1.0)).sqrt()
    }
}

impl RoughnessFile<'_> {
    fn level(&self, level: u32) -> Option<RoughnessLevel> {
        let storage = Storage::decode(&self.file, level).ok()?;
        let channel = |texel: [f64; 3], c: usize| match (self.min.get(c), self.max.get(c)) {
            (Some(min), Some(max)) => (min + texel[c] * (max - min)) as f32,
            _ => 0.0,
        };
        let covariances = texels(&storage).map(|texel| {
            let [d1, d2, d3] = [0, 1, 2].map(|c| channel(texel, c));
            match self.model {
                RoughnessModel::CovarianceFactor => Factor { d1, d2, d3 }.covariance(),
                RoughnessModel::StandardDeviation => Symmetric2::diagonal(d1 * d1, d1 * d1),
            }
        });
        let covariances = covariances.collect();
        let error = match self.model {
            RoughnessModel::CovarianceFactor => self.error::<3>(&storage),
            // Both eigenvalues have this error.
            RoughnessModel::StandardDeviation => std::f64::consts::SQRT_2 * self.error::<1>(&storage),
        };
        Some(RoughnessLevel { covariances, error })
    }

    fn error<const N: usize>(&self, storage: &Storage) -> f64 {
        let span = |c: usize| self.max.get(c).zip(self.min.get(c)).map_or(0.0, |(max, min)| (max - min).abs());
        let scaled = |texel: [f64; N]| -> [f64; N] { std::array::from_fn(|c| texel[c] * span(c)) };
        let (mut squares, mut count) = (0.0, 0.0);
        storage.visit::<N>(|texels, rounding| {
            let error = norm(scaled(rounding)) + storage.residual(scaled(extents(texels)));
            squares += error * error * texels.len() as f64;
            count += texels.len() as f64;
        });
        (squares / f64::max(count, 1.0)).sqrt()
    }
}

/// Returns the first three channels of all texels, in the order of the rows.
fn texels(storage: &Storage) -> impl Iterator<Item = [f64; 3]> + Clone {
    let rows = Rgba(storage.image());
    (0..rows.height()).flat_map(move |y| {
        let mut row = vec![[0.0; 4]; rows.width() as usize];
        rows.row(y, &mut row);
        row.into_iter().map(|[r, g, b, _]| [r, g, b].map(f64::from))
    })
}
