//! The lobe of every texel of every level: the base lobe, widened by the bumps that the level has lost. GGX lobes are
//! merged from level to level; with a fixed distribution or another family, A' = A + 2 c K.

use rayon::prelude::*;

use crate::bump::{Moments, Offset, Shaped, ShapedMoments, normal_from_offset, slopes};
use crate::lobe::{Distribution, Family, OrientedLobe, ReflectingLobe, SquaredAlpha};
use crate::material::base::{Base, BaseRows, BaseTexel, base_lobe};
use crate::material::bump_map::BumpMap;
use crate::material::bumps::Bumps;
use crate::material::fit_levels::fit_levels;
use crate::material::magnified::Magnified;
use crate::material::magnified_bumps::MagnifiedBumps;
use crate::math::symmetric::Symmetric2;
use crate::mip::{AreaResampled, Level, Magnification, MipTail, Pyramid, Sampler, TexelRows};
use crate::settings::Settings;
use crate::simd::map_row;

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
    /// area x reflectance, and coarse levels are then fitted to level 0. Under a fixed distribution, and for Beckmann
    /// lobes, levels 1 and coarser are A + 2 c K with the distribution's correction factor c.
    pub fn new<'b: 'a>(
        base: &Base<'a>,
        bumps: &Bumps<'b>,
        slope_scale: f32,
        sampler: Sampler,
        settings: &Settings,
    ) -> Self {
        let level_0 = Level0 { base: base.level_0().clone(), bumps: bumps.rows, slope_scale };
        let roughened = || level_0.roughened(base, bumps, sampler, settings).into();
        let family = settings.lobe;
        let tail = match (settings.distribution, settings.quality) {
            (Distribution::Normal | Distribution::Uniform, _) => Tail::ByArea(roughened()),
            (Distribution::Auto, effort) if family == Family::Ggx && !level_0.base.is_reflectance_constant() => {
                let points = level_0.magnified(sampler);
                let rows = ReflectingRows { points: &points, base: &level_0.base };
                let mut tail = MipTail::with_max_kept(&rows, MAX_KEPT_TEXELS);
                fit_levels(&rows, &mut tail, family, effort);
                Tail::ByReflectance(tail)
            }
            (Distribution::Auto, effort) => {
                let points = level_0.magnified(sampler);
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
        let points = self.magnified();
        match &self.tail {
            Tail::ByArea(tail) => tail.row(&points, level, y, out),
            Tail::ByReflectance(tail) => tail.with_row(&self.reflecting(&points), level, y, |texels| {
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
        self.reflecting(&self.magnified()).rows(first, out);
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

    fn magnified(&self) -> Magnified<'_, Level0<'a>> {
        self.level_0.magnified(self.sampler)
    }

    fn reflecting<'r>(&'r self, points: &'r Magnified<'r, Level0<'a>>) -> ReflectingRows<'r, 'a> {
        ReflectingRows { points, base: &self.level_0.base }
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
        let points = self.magnified();
        match &self.tail {
            Tail::ByArea(tail) => tail.coarsest(&points),
            Tail::ByReflectance(tail) => tail.coarsest(&self.reflecting(&points)).lobe,
        }
    }
}

/// Texels of the largest level of merged lobes that is kept in memory: level 1 of 8192 x 8192 or level 2 of 16384 x
/// 16384, which take 400 MB. Merging takes far longer than the other steps of a row: with kept levels, 8192 x 8192
/// bakes in 5.0 s instead of 7.1.
const MAX_KEPT_TEXELS: u64 = 1 << 24;

/// The lobes of level 0.
struct Level0<'a> {
    base: BaseRows<'a>,
    bumps: AreaResampled<&'a BumpMap>,
    slope_scale: f32,
}

impl<'a> Level0<'a> {
    /// Returns the points of this level that count in coarser levels.
    fn magnified(&self, Sampler { wrap, magnification }: Sampler) -> Magnified<'_, Self> {
        // Resampled texels are no texels of the texture that engines magnify.
        let is_linear = magnification == Magnification::Linear && self.bumps.unchanged().is_some();
        Magnified { source: self, wrap: is_linear.then_some(wrap), is_isotropic: !self.base.is_anisotropic() }
    }

    /// Returns the unit normal of an offset of the bumps.
    #[inline(always)]
    fn normal(&self, [u, v]: [f32; 2]) -> [f32; 3] {
        normal_from_offset(Offset { u: u * self.slope_scale, v: v * self.slope_scale })
    }

    /// Writes a row of isotropic lobes over `bump_map`, whose texels are those of level 0: bumps do not vary within a
    /// texel.
    fn isotropic_row(&self, bump_map: &BumpMap, y: u32, out: &mut [OrientedLobe]) {
        let mut green = vec![0.0; out.len()];
        self.base.green_row(y, &mut green);
        bump_map.map_offsets(
            y,
            green.iter().copied(),
            out,
            |Offset { u, v }, green| {
                let [x, y, z] = self.normal([u, v]);
                [x, y, z, self.base.squared_alpha(green)]
            },
            |lobe, [x, y, z, squared_alpha]| {
                lobe.normal = [x, y, z];
                lobe.squared_alpha = SquaredAlpha(Symmetric2::diagonal(squared_alpha, squared_alpha));
            },
        );
    }

    /// Returns levels 1 and coarser as A + 2 c K.
    fn roughened(
        &self,
        base: &Base<'_>,
        bumps: &Bumps<'_>,
        sampler: Sampler,
        settings: &Settings,
    ) -> Vec<Level<OrientedLobe>> {
        let rows = MagnifiedBumps { rows: bumps.rows, sampler };
        let levels = bumps.sizes().into_iter().enumerate().skip(1);
        match settings.distribution {
            Distribution::Auto => {
                let moments = Pyramid::new(Shaped(rows));
                let row = |level, y, out: &mut [ShapedMoments]| moments.row(level, y, out);
                levels.map(|(level, size)| self.roughened_level(level, size, base, row, settings)).collect()
            }
            Distribution::Normal | Distribution::Uniform => {
                let moments = Pyramid::new(rows);
                let row = |level, y, out: &mut [ShapedMoments]| {
                    let mut plain = vec![Moments::default(); out.len()];
                    moments.row(level, y, &mut plain);
                    out.iter_mut().zip(plain).for_each(|(shaped, m)| *shaped = ShapedMoments::normal(m));
                };
                levels.map(|(level, size)| self.roughened_level(level, size, base, row, settings)).collect()
            }
        }
    }

    fn roughened_level(
        &self,
        level: usize,
        (width, height): (u32, u32),
        base: &Base<'_>,
        bumps: impl Fn(usize, u32, &mut [ShapedMoments]) + Sync,
        settings: &Settings,
    ) -> Level<OrientedLobe> {
        let squared_scale = (self.slope_scale * self.slope_scale).max(f32::MIN_POSITIVE);
        let mut texels = vec![OrientedLobe::default(); width as usize * height as usize];
        texels.par_chunks_mut(width as usize).enumerate().for_each(|(y, out)| {
            let (mut texels, mut row) =
                (vec![BaseTexel::default(); out.len()], vec![ShapedMoments::default(); out.len()]);
            base.row(level, y as u32, &mut texels);
            bumps(level, y as u32, &mut row);
            for ((lobe, texel), m) in out.iter_mut().zip(&texels).zip(&row) {
                // The correction depends on the ratio of the lobe's width to the bumps. It is cheaper to divide the
                // width by the slope scale than to multiply four orders of moments.
                let base_lobe = base_lobe(texel);
                let unscaled = SquaredAlpha((1.0 / squared_scale) * base_lobe.0);
                let corrected = settings.distribution.correct(m, unscaled, settings.lobe);
                let Offset { u, v } = corrected.centre;
                let centre = Offset { u: u * self.slope_scale, v: v * self.slope_scale };
                *lobe = OrientedLobe::new(centre, base_lobe.roughen(squared_scale * corrected.covariance));
            }
        });
        Level { width, height, texels }
    }
}

impl TexelRows for Level0<'_> {
    type Texel = OrientedLobe;

    fn width(&self) -> u32 {
        self.bumps.width()
    }

    fn height(&self) -> u32 {
        self.bumps.height()
    }

    fn row(&self, y: u32, out: &mut [OrientedLobe]) {
        let bump_map = self.bumps.unchanged();
        if let Some(bump_map) = bump_map.filter(|_| !self.base.is_anisotropic()) {
            return self.isotropic_row(bump_map, y, out);
        }
        let point = |offsets: &[[f32; 2]], out: &mut [OrientedLobe]| {
            let normal = |offset| self.normal(offset);
            map_row(offsets.iter().copied(), out, normal, |lobe, normal| lobe.normal = normal);
        };
        let (mut texels, mut offsets) = (vec![BaseTexel::default(); out.len()], vec![[0.0; 2]; out.len()]);
        self.base.row(y, &mut texels);
        if let Some(bump_map) = bump_map {
            bump_map.offsets(y, &mut offsets);
            point(&offsets, out);
            out.iter_mut().zip(&texels).for_each(|(lobe, texel)| lobe.squared_alpha = base_lobe(texel));
            return;
        }
        let mut bumps = vec![Moments::default(); out.len()];
        self.bumps.row(y, &mut bumps);
        offsets.iter_mut().zip(&bumps).for_each(|(offset, m)| *offset = [m.mean.u, m.mean.v]);
        point(&offsets, out);
        for ((lobe, texel), m) in out.iter_mut().zip(&texels).zip(&bumps) {
            lobe.squared_alpha = base_lobe(texel).roughen(m.covariance.scaled([self.slope_scale; 2]));
        }
    }
}

/// The lobes of level 0 with their reflectance.
struct ReflectingRows<'r, 'a> {
    points: &'r Magnified<'r, Level0<'a>>,
    base: &'r BaseRows<'a>,
}

impl TexelRows for ReflectingRows<'_, '_> {
    type Texel = ReflectingLobe;

    fn width(&self) -> u32 {
        self.points.width()
    }

    fn height(&self) -> u32 {
        self.points.height()
    }

    fn row(&self, y: u32, out: &mut [ReflectingLobe]) {
        self.rows(y, out);
    }

    fn rows(&self, first: u32, out: &mut [ReflectingLobe]) {
        let (mut lobes, mut reflectance) = (vec![OrientedLobe::default(); out.len()], vec![0.0; out.len()]);
        self.points.rows(first, &mut lobes);
        for (y, row) in (first..).zip(reflectance.chunks_exact_mut(self.width() as usize)) {
            self.base.reflectance_row(y, row);
        }
        for ((texel, lobe), reflectance) in out.iter_mut().zip(lobes).zip(reflectance) {
            *texel = ReflectingLobe { lobe, reflectance };
        }
    }
}

#[cfg(test)]
mod tests;
