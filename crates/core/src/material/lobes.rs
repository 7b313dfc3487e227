//! The lobe of every texel of every level: the base lobe, widened by the bumps that the level has lost. GGX lobes are
//! merged from level to level; with a fixed distribution or another family, A' = A + 2 c K.

mod level_0;

use crate::bump::{Offset, slopes};
use crate::lobe::{Distribution, Family, OrientedLobe, ReflectingLobe, SquaredAlpha};
use crate::material::base::Base;
use crate::material::bumps::Bumps;
use crate::material::fit_levels::fit_levels;
use crate::mip::{MipTail, Sampler, TexelRows};
use crate::settings::Settings;
use crate::simd::map_row;

use level_0::{Level0, MagnifiedLobes, ReflectingRows};

/// Lobes of a material on the grid of its bumps.
pub struct Lobes<'a> {
    level_0: Level0<'a>,
    sampler: Sampler,
    tail: Tail,
}

/// Levels 1 and coarser.
enum Tail {
    /// Lobes alone. Parts of a merge counted by area.
    ByArea(MipTail<OrientedLobe>),
    /// Lobes and their reflectance, which varies. Parts of a merge counted by area x reflectance.
    ByReflectance(MipTail<ReflectingLobe>),
}

impl<'a> Lobes<'a> {
    /// Roughens `base` by `bumps` on one grid. `slope_scale` multiplies the offsets.
    ///
    /// Under the automatic distribution, GGX lobes are merged from level to level by likelihood, where texels count by
    /// area x reflectance, and coarse levels are then fitted to finer ones. Under a fixed distribution, and for
    /// Beckmann lobes, levels 1 and coarser are A + 2 c K with the distribution's correction factor c.
    pub fn new<'b: 'a>(
        base: &Base<'a>,
        bumps: &Bumps<'b>,
        slope_scale: f32,
        sampler: Sampler,
        settings: &Settings,
    ) -> Self {
        let level_0 = Level0 { base: base.level_0().clone(), bumps: bumps.rows, slope_scale };
        let points = MagnifiedLobes { level_0: &level_0, sampler };
        let roughened = || level_0.roughened(base, bumps, sampler, settings).into();
        let family = settings.lobe;
        let tail = match (settings.distribution, settings.quality) {
            (Distribution::Normal | Distribution::Uniform, _) => Tail::ByArea(roughened()),
            (Distribution::Auto, effort) if family == Family::Ggx && !level_0.base.is_reflectance_constant() => {
                let rows = ReflectingRows(points);
                let mut tail = MipTail::with_max_kept(&rows, MAX_KEPT_TEXELS);
                fit_levels(&rows, &mut tail, family, effort);
                Tail::ByReflectance(tail)
            }
            (Distribution::Auto, effort) => {
                let mut tail = match family {
                    Family::Ggx => MipTail::with_max_kept(&points, MAX_KEPT_TEXELS),
                    // Normal distributions are merged by likelihood when their moments are added.
                    Family::Beckmann => roughened(),
                };
                fit_levels(&points, &mut tail, family, effort);
                Tail::ByArea(tail)
            }
        };
        Self { level_0, sampler, tail }
    }

    /// Returns the factor that multiplies offsets.
    pub fn slope_scale(&self) -> f32 {
        self.level_0.slope_scale
    }

    /// Writes the lobes of row `y` of `level` to `out`.
    pub fn row(&self, level: usize, y: u32, out: &mut [OrientedLobe]) {
        if level == 0 {
            return self.level_0.row(y, out);
        }
        match &self.tail {
            Tail::ByArea(tail) => tail.row(&self.magnified(), level, y, out),
            Tail::ByReflectance(tail) => tail.with_row(&self.reflecting(), level, y, |texels| {
                out.iter_mut().zip(texels).for_each(|(lobe, texel)| *lobe = texel.lobe);
            }),
        }
    }

    /// Writes the lobes of row `first` of level 0 and of the rows below, as engines magnify them, to `out`. Coarser
    /// levels stand for these lobes.
    pub fn magnified_rows(&self, first: u32, out: &mut [OrientedLobe]) {
        self.magnified().rows(first, out);
    }

    /// Works like [`Self::magnified_rows`], with the reflectance of each texel.
    pub fn reflecting_rows(&self, first: u32, out: &mut [ReflectingLobe]) {
        self.reflecting().rows(first, out);
    }

    /// Returns whether all texels have the same reflectance.
    pub fn is_reflectance_constant(&self) -> bool {
        self.level_0.base.is_reflectance_constant()
    }

    /// Calls `read` with the lobes of row `y` of `level`, which has `width` texels.
    fn with_row(&self, level: usize, y: u32, width: usize, read: impl FnOnce(&[OrientedLobe])) {
        match &self.tail {
            Tail::ByArea(tail) if level > 0 => tail.with_row(&self.magnified(), level, y, read),
            _ => {
                let mut lobes = vec![OrientedLobe::default(); width];
                self.row(level, y, &mut lobes);
                read(&lobes);
            }
        }
    }

    fn magnified(&self) -> MagnifiedLobes<'_, 'a> {
        MagnifiedLobes { level_0: &self.level_0, sampler: self.sampler }
    }

    fn reflecting(&self) -> ReflectingRows<'_, 'a> {
        ReflectingRows(self.magnified())
    }

    /// Writes the squared alphas of row `y` of `level` to `out`.
    pub fn squared_alphas(&self, level: usize, y: u32, out: &mut [SquaredAlpha]) {
        self.with_row(level, y, out.len(), |lobes| {
            out.iter_mut().zip(lobes).for_each(|(a, lobe)| *a = lobe.squared_alpha);
        });
    }

    /// Returns whether the squared alphas of `level` are those of the base lobe. At level 0, bumps that are not
    /// resampled do not vary within a texel.
    pub fn are_base(&self, level: usize) -> bool {
        level == 0 && self.level_0.bumps.unchanged().is_some()
    }

    /// Writes the directions of the lobes of row `y` of `level` to `out`, as offsets (f_u, f_v) that are not multiplied
    /// by the slope scale: the offsets that a normal map should hold.
    pub fn offsets(&self, level: usize, y: u32, out: &mut [[f32; 2]]) {
        let scale = 1.0 / self.slope_scale();
        self.with_row(level, y, out.len(), |lobes| {
            map_row(
                lobes.iter().map(|lobe| lobe.normal),
                out,
                |normal| {
                    let Offset { u, v } = slopes(normal);
                    [u * scale, v * scale]
                },
                |offset, unscaled| *offset = unscaled,
            );
        });
    }

    /// Returns the only texel of the coarsest level.
    pub fn coarsest(&self) -> OrientedLobe {
        match &self.tail {
            Tail::ByArea(tail) => tail.coarsest(&self.magnified()),
            Tail::ByReflectance(tail) => tail.coarsest(&self.reflecting()).lobe,
        }
    }
}

/// Texels of the largest level of merged lobes that is kept in memory: level 1 of 8192 x 8192 or level 2 of 16384 x
/// 16384, which take 400 MB. Merging takes far longer than the other steps of a row: with kept levels, 8192 x 8192
/// bakes in 5.0 s instead of 7.1.
const MAX_KEPT_TEXELS: u64 = 1 << 24;

#[cfg(test)]
mod tests;
