//! The lobe of every texel of every level: the base lobe, widened by the bumps that the level has lost. GGX lobes are
//! merged from level to level; with a fixed distribution or another family, A' = A + 2 c K.

use rayon::prelude::*;

use crate::bump::{Moments, Offset, Shaped, ShapedMoments, normal_from_offset, slopes};
use crate::codec::uastc::Effort;
use crate::lobe::{Distribution, Family, OrientedLobe, SquaredAlpha};
use crate::material::base::{Base, BaseRows, BaseTexel, base_lobe};
use crate::material::bump_map::BumpMap;
use crate::material::bumps::Bumps;
use crate::math::symmetric::Symmetric2;
use crate::metric::{Footprint, Lobe, Part, Reference, overlaps, refine};
use crate::mip::{AreaResampled, Level, MipTail, Pyramid, TexelRows, level_sizes};
use crate::settings::Settings;
use crate::simd::map_row;

/// Lobes of a material on the grid of its bumps.
pub struct Lobes<'a> {
    level_0: Level0<'a>,
    tail: MipTail<OrientedLobe>,
}

impl<'a> Lobes<'a> {
    /// Roughens `base` by `bumps` on one grid. `slope_scale` multiplies the offsets.
    ///
    /// Under the automatic distribution, GGX lobes are merged from level to level by likelihood, and the best quality
    /// then fits them to the distribution of the bumps. Under a fixed distribution, and for Beckmann lobes, levels 1
    /// and coarser are A + 2 c K with the distribution's correction factor c.
    pub fn new<'b: 'a>(base: &Base<'a>, bumps: &Bumps<'b>, slope_scale: f32, settings: &Settings) -> Self {
        let level_0 = Level0 { base: base.level_0().clone(), bumps: bumps.rows, slope_scale };
        let roughened = || level_0.roughened(base, bumps, settings).into();
        let tail = match (settings.distribution, settings.quality) {
            (Distribution::Normal | Distribution::Uniform, _) => roughened(),
            (Distribution::Auto, effort) => {
                let merged = match settings.lobe {
                    Family::Ggx => MipTail::with_max_kept(&level_0, MAX_KEPT_TEXELS),
                    // Normal distributions are merged by likelihood when their moments are added.
                    Family::Beckmann => roughened(),
                };
                match effort {
                    Effort::Fast => merged,
                    Effort::Best => fitted(&level_0, &merged, settings.lobe),
                }
            }
        };
        Self { level_0, tail }
    }

    /// Returns the factor that multiplies offsets.
    pub fn slope_scale(&self) -> f32 {
        self.level_0.slope_scale
    }

    /// Writes the lobes of row `y` of `level` to `out`.
    pub fn row(&self, level: usize, y: u32, out: &mut [OrientedLobe]) {
        self.tail.row(&self.level_0, level, y, out);
    }

    /// Writes the squared alphas of row `y` of `level` to `out`.
    pub fn squared_alphas(&self, level: usize, y: u32, out: &mut [SquaredAlpha]) {
        self.tail.with_row(&self.level_0, level, y, |lobes| {
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
        self.tail.with_row(&self.level_0, level, y, |lobes| {
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
        self.tail.coarsest(&self.level_0)
    }
}

/// Texels of the largest level of merged lobes that is kept in memory: level 1 of 8192 x 8192 or level 2 of 16384 x
/// 16384, which take 400 MB. Merging takes far longer than the other steps of a row: with kept levels, 8192 x 8192
/// bakes in 5.0 s instead of 7.1.
const MAX_KEPT_TEXELS: u64 = 1 << 24;

/// A fit compares a lobe with the lobes that are this many levels finer.
const FIT_DEPTH: usize = 3;
/// Half-vectors for each fit. Four times as many gain 0.001 of lobe error on average, measured on real materials.
const FIT_SAMPLES: usize = 128;

/// Fits the lobes of `merged` to the lobes [`FIT_DEPTH`] levels finer (level 0 for levels 2 and 3) by the lobe error.
/// Level 1 stays as merged: four texels are too few for a fit.
fn fitted(level_0: &Level0<'_>, merged: &MipTail<OrientedLobe>, family: Family) -> MipTail<OrientedLobe> {
    let sizes = level_sizes(level_0.width(), level_0.height());
    let row = |level, y, out: &mut [OrientedLobe]| merged.row(level_0, level, y, out);
    let levels: Vec<_> = (1..sizes.len()).map(|level| fitted_level(&sizes, row, level, family)).collect();
    levels.into()
}

/// Fits the lobes of one level. `merged` writes a row of a level of `sizes`.
fn fitted_level(
    sizes: &[(u32, u32)],
    merged: impl Fn(usize, u32, &mut [OrientedLobe]) + Sync,
    level: usize,
    family: Family,
) -> Level<OrientedLobe> {
    let ((width, height), finer) = (sizes[level], level.saturating_sub(FIT_DEPTH));
    let (finer_width, finer_height) = sizes[finer];
    let mut texels = vec![OrientedLobe::default(); width as usize * height as usize];
    texels.par_chunks_mut(width as usize).enumerate().for_each(|(y, out)| {
        merged(level, y as u32, out);
        if level == 1 {
            return;
        }
        let down = overlaps(finer_height, height, y as u32);
        let mut rows = vec![OrientedLobe::default(); finer_width as usize * down.len()];
        for (row, (finer_y, _)) in rows.chunks_exact_mut(finer_width as usize).zip(&down) {
            merged(finer, *finer_y, row);
        }
        for (x, texel) in out.iter_mut().enumerate() {
            let across = overlaps(finer_width, width, x as u32);
            let parts = rows.chunks_exact(finer_width as usize).zip(&down).flat_map(|(row, (_, share_y))| {
                across.iter().map(move |(finer_x, share_x)| {
                    let lobe = metric_lobe(family, &row[*finer_x as usize]);
                    Part { weight: share_x * share_y, normal: lobe.normal(), base: lobe.squared_alpha() }
                })
            });
            let Some(footprint) = Footprint::new(parts.collect()) else { continue };
            let fit = refine(&Reference::new(family, &footprint, FIT_SAMPLES), &metric_lobe(family, texel));
            let [uu, uv, vv] = fit.squared_alpha().map(|a| a as f32);
            let squared_alpha = SquaredAlpha(Symmetric2::new(uu, uv, vv));
            *texel = OrientedLobe { normal: fit.normal().map(|c| c as f32), squared_alpha };
        }
    });
    Level { width, height, texels }
}

fn metric_lobe(family: Family, lobe: &OrientedLobe) -> Lobe {
    let a = lobe.squared_alpha.0;
    Lobe::new(family, lobe.normal.map(f64::from), [a.uu, a.uv, a.vv].map(f64::from))
}

/// The lobes of level 0.
struct Level0<'a> {
    base: BaseRows<'a>,
    bumps: AreaResampled<&'a BumpMap>,
    slope_scale: f32,
}

impl Level0<'_> {
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
    fn roughened(&self, base: &Base<'_>, bumps: &Bumps<'_>, settings: &Settings) -> Vec<Level<OrientedLobe>> {
        let levels = bumps.sizes().into_iter().enumerate().skip(1);
        match settings.distribution {
            Distribution::Auto => {
                let moments = Pyramid::new(Shaped(bumps.rows));
                let row = |level, y, out: &mut [ShapedMoments]| moments.row(level, y, out);
                levels.map(|(level, size)| self.roughened_level(level, size, base, row, settings)).collect()
            }
            Distribution::Normal | Distribution::Uniform => {
                let moments = bumps.moments();
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
