//! The texels of the pyramid profile, level by level: directions of lobes with the bumps that the level has lost, or
//! means and covariances of offsets where no lobes are known.

use rayon::prelude::*;

use crate::bump::{FrameTransform, Moments, Offset};
use crate::lobe::{SquaredAlpha, lambda_1};
use crate::material::bump_map::BumpMap;
use crate::material::bumps::Bumps;
use crate::material::roughening::{PyramidBase, Roughening};
use crate::math::symmetric::{MohrCircle, Symmetric2};
use crate::mip::{AreaResampled, Level, Pyramid, TexelRows, level_sizes};

/// What the pyramid profile stores of a texel. Offsets are not multiplied by the slope scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PyramidTexel {
    /// The direction of the lobe, or the mean offset.
    pub offset: Offset,
    /// K: a plugin adds 2 c K to the squared alphas of the base lobe. Positive semidefinite.
    pub covariance: Symmetric2,
    /// The variance that takes the place of both eigenvalues of K where the lobe must be isotropic: lambda_1^2.
    pub isotropic: f32,
}

/// All levels of texels of the pyramid profile.
pub trait PyramidLevels: Sync {
    /// Returns the sizes of all levels, level 0 first.
    fn sizes(&self) -> Vec<(u32, u32)>;

    /// Writes row `y` of `level` to `out`.
    fn row(&self, level: usize, y: u32, out: &mut [PyramidTexel]);
}

/// Means and covariances, without the correction that a lobe needs.
impl<R: TexelRows<Texel = Moments>> PyramidLevels for Pyramid<R> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        Pyramid::sizes(self)
    }

    fn row(&self, level: usize, y: u32, out: &mut [PyramidTexel]) {
        let mut moments = vec![Moments::default(); out.len()];
        Pyramid::row(self, level, y, &mut moments);
        for (texel, Moments { mean, covariance }) in out.iter_mut().zip(moments) {
            let deviation = lambda_1(covariance);
            *texel = PyramidTexel { offset: mean, covariance, isotropic: deviation * deviation };
        }
    }
}

/// Levels made of lobes: K is half of what the lost bumps add to the squared alphas, K = (A' - A) / 2, so that a plugin
/// with a correction factor of 1 shows the lobes of the portable profile. A few steep texels, which are most of the
/// variance of a footprint, hardly widen such a K.
pub struct LobeLevels<'a> {
    level_0: AreaResampled<&'a BumpMap>,
    /// Levels 1 and coarser.
    tail: Vec<Level<PyramidTexel>>,
}

impl<'a> LobeLevels<'a> {
    /// Copies the lobes of `roughening`, which are on the grid of `bumps`, so that the lobes need not stay in memory.
    pub fn new(bumps: &Bumps<'a>, roughening: &Roughening<'_>) -> Self {
        let level = |(level, &(width, height)): (usize, &(u32, u32))| {
            let mut texels = vec![PyramidTexel::default(); width as usize * height as usize];
            texels.par_chunks_exact_mut(width as usize).enumerate().for_each(|(y, row)| {
                roughening_row(roughening, level, y as u32, row);
            });
            Level { width, height, texels }
        };
        let tail = bumps.sizes().iter().enumerate().skip(1).map(level).collect();
        Self { level_0: bumps.rows, tail }
    }

    /// Keeps the base lobe at `levels`, which are coarser than level 0: K is 0 there.
    pub fn with_base_levels(mut self, levels: &[usize]) -> Self {
        for level in levels.iter().filter_map(|level| level.checked_sub(1)) {
            for texel in self.tail.get_mut(level).into_iter().flat_map(|level| &mut level.texels) {
                *texel = PyramidTexel { offset: texel.offset, ..PyramidTexel::default() };
            }
        }
        self
    }
}

impl PyramidLevels for LobeLevels<'_> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.level_0.width(), self.level_0.height())
    }

    fn row(&self, level: usize, y: u32, out: &mut [PyramidTexel]) {
        if let Some(level) = level.checked_sub(1).and_then(|coarser| self.tail.get(coarser)) {
            let width = level.width as usize;
            return out.copy_from_slice(&level.texels[y as usize * width..][..width]);
        }
        // At level 0 only resampled texels have lost bumps, and few of them: K is much smaller than A. The closest
        // isotropic lobe then has the mean of the eigenvalues.
        let mut moments = vec![Moments::default(); out.len()];
        self.level_0.row(y, &mut moments);
        for (texel, Moments { mean, covariance }) in out.iter_mut().zip(moments) {
            *texel = PyramidTexel { offset: mean, covariance, isotropic: 0.5 * covariance.trace() };
        }
    }
}

/// Writes the directions of the lobes of a row, and K of the bumps that roughen them.
fn roughening_row(roughening: &Roughening<'_>, level: usize, y: u32, out: &mut [PyramidTexel]) {
    let lobes = roughening.lobes();
    let inverse = 1.0 / (lobes.slope_scale() * lobes.slope_scale()).max(f32::MIN_POSITIVE);
    let mut offsets = vec![[0.0; 2]; out.len()];
    lobes.offsets(level, y, &mut offsets);
    let roughened = roughening.roughened_row(level, y, out.len());
    let base = roughening.pyramid_base_row(level, y, &roughened);
    for (((texel, [u, v]), roughened), base) in out.iter_mut().zip(offsets).zip(roughened).zip(base) {
        let PyramidBase { lobe, most_variance } = base;
        let covariance = added_covariance(lobe, roughened);
        let trace = covariance.trace();
        let share = if trace > most_variance { most_variance / trace } else { 1.0 };
        let isotropic = added_isotropic_variance(lobe, roughened).min(0.5 * most_variance);
        *texel = PyramidTexel {
            offset: Offset { u, v },
            covariance: inverse * share * covariance,
            isotropic: inverse * isotropic,
        };
    }
}

/// Returns K of A' = A + 2 K for the base lobe A and the roughened lobe A'. Alphas of A' above 1, which no engine
/// shows, count as 1. Where A' is narrower than A, K is 0 along that axis.
fn added_covariance(SquaredAlpha(base): SquaredAlpha, SquaredAlpha(roughened): SquaredAlpha) -> Symmetric2 {
    let e = roughened.eigen();
    let shown =
        if e.major > 1.0 { Symmetric2::from_axes(e.major.min(1.0), e.minor.min(1.0), e.axis) } else { roughened };
    let added = shown + -1.0 * base;
    let is_semidefinite = added.uu >= 0.0 && added.vv >= 0.0 && added.uu * added.vv >= added.uv * added.uv;
    if is_semidefinite {
        return 0.5 * added;
    }
    let e = added.eigen();
    0.5 * Symmetric2::from_axes(e.major.max(0.0), e.minor, e.axis)
}

/// Returns the variance v for which the isotropic part of the lobe A + 2 v 1 is the closest isotropic lobe of A': both
/// have the determinant of A' ([`SquaredAlpha::closest_isotropic`]). For an isotropic A, v = (sqrt|A'| - A) / 2.
fn added_isotropic_variance(SquaredAlpha(base): SquaredAlpha, SquaredAlpha(roughened): SquaredAlpha) -> f32 {
    let MohrCircle { mean, radius, .. } = MohrCircle::new([base.uu, base.uv, base.vv]);
    // (mean + x)^2 - radius^2 = |A'|
    let x = (radius * radius + roughened.determinant().min(1.0)).sqrt() - mean;
    (0.5 * x).max(0.0)
}

/// Levels in a frame that is rotated against the tangent frame by one angle.
pub struct Rotated<'l> {
    /// The levels in the tangent frame.
    pub levels: &'l dyn PyramidLevels,
    /// The rotation.
    pub transform: FrameTransform,
}

impl PyramidLevels for Rotated<'_> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        self.levels.sizes()
    }

    fn row(&self, level: usize, y: u32, out: &mut [PyramidTexel]) {
        self.levels.row(level, y, out);
        for texel in out {
            let moments = Moments { mean: texel.offset, covariance: texel.covariance };
            let Moments { mean, covariance } = self.transform.apply(moments);
            *texel = PyramidTexel { offset: mean, covariance, ..*texel };
        }
    }
}

/// Returns the sum over levels 1 and coarser of the mean trace of K.
pub fn lost_variance(levels: &dyn PyramidLevels) -> f64 {
    sum_over_levels(&levels.sizes(), |level, y, row| levels.row(level, y, row))
}

/// Returns [`lost_variance`] of [`LobeLevels`] of `roughening`, without a copy of the lobes.
pub fn lost_variance_of_lobes(roughening: &Roughening<'_>) -> f64 {
    sum_over_levels(&roughening.sizes(), |level, y, row| roughening_row(roughening, level, y, row))
}

/// Returns the correction factor c of a layer whose lobes need `needed` of the variance ([`lost_variance`]) that a
/// texture holds: a shader has one c for the whole map. It is 1 for the layer whose lobes the texture is made of.
pub fn correction_factor(needed: f64, held: f64) -> f32 {
    if held > 0.0 { (needed / held) as f32 } else { 1.0 }
}

fn sum_over_levels(sizes: &[(u32, u32)], row: impl Fn(usize, u32, &mut [PyramidTexel]) + Sync) -> f64 {
    let mean_trace = |(level, &(width, height)): (usize, &(u32, u32))| {
        let of_row = |texels: &mut Vec<PyramidTexel>, y| {
            row(level, y, texels);
            texels.iter().map(|texel| f64::from(texel.covariance.trace())).sum::<f64>()
        };
        let empty = || vec![PyramidTexel::default(); width as usize];
        // Rows are added in order, so that the sum does not depend on the number of threads.
        let rows: Vec<f64> = (0..height).into_par_iter().map_init(empty, of_row).collect();
        rows.iter().sum::<f64>() / (f64::from(width) * f64::from(height))
    };
    sizes.iter().enumerate().skip(1).map(mean_trace).sum()
}

#[cfg(test)]
mod tests;
