//! The lobe of every texel of every level: the material's own, roughened by the bumps that the level has lost.

use rayon::prelude::*;

use crate::bump::{Moments, Offset, Shaped, ShapedMoments, normal_from_offset, slopes};
use crate::codec::uastc::Effort;
use crate::lobe::{Distribution, Family, OrientedLobe, SquaredAlpha};
use crate::material::base::{Base, BaseRows, BaseTexel};
use crate::material::bump_map::BumpMap;
use crate::material::bumps::Bumps;
use crate::math::symmetric::Symmetric2;
use crate::metric::{Footprint, Lobe, Part, Reference, overlaps, refine};
use crate::mip::{Area, Level, MipTail, Pyramid, Rows, level_sizes};
use crate::settings::Settings;
use crate::simd::map_row;

/// Lobes of a material on the grid of its bumps.
pub struct Lobes<'a> {
    finest: Finest<'a>,
    tail: MipTail<OrientedLobe>,
}

impl<'a> Lobes<'a> {
    /// `base` on the grid of `bumps`, whose offsets are multiplied by `slope_scale`. Levels 1 and coarser of GGX lobes are
    /// merged from level to level by likelihood where the distribution is the bumps' own, else folded by its correction
    /// factor. The best quality then fits them to the bumps' own distribution.
    pub fn new<'b: 'a>(base: &Base<'a>, bumps: &Bumps<'b>, slope_scale: f32, settings: &Settings) -> Self {
        let finest = Finest { base: base.finest().clone(), bumps: bumps.rows, slope_scale };
        let roughened = || finest.roughened(base, bumps, settings).into();
        let tail = match (settings.distribution, settings.effort) {
            (Distribution::Normal | Distribution::Uniform, _) => roughened(),
            (Distribution::Auto, effort) => {
                let merged = match settings.family {
                    Family::Ggx => MipTail::keeping(&finest, MOST_MERGED),
                    // Merging normal distributions by likelihood is adding moments.
                    Family::Beckmann => roughened(),
                };
                match effort {
                    Effort::Fast => merged,
                    Effort::Best => fitted(&finest, &merged, settings.family),
                }
            }
        };
        Self { finest, tail }
    }

    /// What offsets are multiplied by.
    pub fn slope_scale(&self) -> f32 {
        self.finest.slope_scale
    }

    /// Writes the lobes of row `y` of `level` to `out`.
    pub fn row(&self, level: usize, y: u32, out: &mut [OrientedLobe]) {
        self.tail.row(&self.finest, level, y, out);
    }

    /// Their squared alphas alone.
    pub fn squared_alphas(&self, level: usize, y: u32, out: &mut [SquaredAlpha]) {
        self.tail.with_row(&self.finest, level, y, |lobes| {
            out.iter_mut().zip(lobes).for_each(|(a, lobe)| *a = lobe.squared_alpha);
        });
    }

    /// Whether squared alphas of `level` are the material's own: bumps that are not resampled do not vary within a texel.
    pub fn are_base(&self, level: usize) -> bool {
        level == 0 && self.finest.bumps.unchanged().is_some()
    }

    /// Writes the offsets (f_u, f_v) that a normal map should hold to `out`: where the lobes of row `y` of `level` point,
    /// before scaling.
    pub fn offsets(&self, level: usize, y: u32, out: &mut [[f32; 2]]) {
        let scale = 1.0 / self.slope_scale();
        self.tail.with_row(&self.finest, level, y, |lobes| {
            map_row(
                lobes.iter().map(|lobe| lobe.normal),
                out,
                |normal| {
                    let Offset { u, v } = slopes(normal);
                    [u * scale, v * scale]
                },
                |offset, made| *offset = made,
            );
        });
    }

    /// The single texel of the coarsest level.
    pub fn whole(&self) -> OrientedLobe {
        self.tail.whole(&self.finest)
    }
}

/// Texels of the largest level of merged lobes that is kept, level 1 of 8192 x 8192 or level 2 of 16384 x 16384: 400 MB. Merging
/// takes far longer than all else that a row is made of: 8192 x 8192 bakes in 5.0 s instead of 7.1.
const MOST_MERGED: u64 = 1 << 24;

/// How many levels finer the lobes are that a fit takes for the truth.
const FIT_DEPTH: usize = 3;
/// Half-vectors that a fit goes by. Four times as many gain 0.001 on average on `../shared/data`.
const FIT_SAMPLES: usize = 128;

/// `merged` fitted to the lobes [`FIT_DEPTH`] levels finer (level 0 for levels 2 and 3) by the lobe error itself. Level 1
/// stays as merged: four texels are too few to fit to.
fn fitted(finest: &Finest<'_>, merged: &MipTail<OrientedLobe>, family: Family) -> MipTail<OrientedLobe> {
    let sizes = level_sizes(finest.width(), finest.height());
    let row = |level, y, out: &mut [OrientedLobe]| merged.row(finest, level, y, out);
    let levels: Vec<_> = (1..sizes.len()).map(|level| fitted_level(&sizes, row, level, family)).collect();
    levels.into()
}

/// `merged` writes a row of a level of `sizes`.
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
                    let lobe = judged(family, &row[*finer_x as usize]);
                    Part { weight: share_x * share_y, normal: lobe.normal(), base: lobe.squared_alpha() }
                })
            });
            let Some(footprint) = Footprint::new(parts.collect()) else { continue };
            let fit = refine(&Reference::new(family, &footprint, FIT_SAMPLES), &judged(family, texel));
            let [uu, uv, vv] = fit.squared_alpha().map(|a| a as f32);
            let squared_alpha = SquaredAlpha(Symmetric2::new(uu, uv, vv));
            *texel = OrientedLobe { normal: fit.normal().map(|c| c as f32), squared_alpha };
        }
    });
    Level { width, height, texels }
}

fn judged(family: Family, lobe: &OrientedLobe) -> Lobe {
    let a = lobe.squared_alpha.0;
    Lobe::new(family, lobe.normal.map(f64::from), [a.uu, a.uv, a.vv].map(f64::from))
}

/// Level 0.
struct Finest<'a> {
    base: BaseRows<'a>,
    bumps: Area<&'a BumpMap>,
    slope_scale: f32,
}

impl Finest<'_> {
    /// The unit normal of an offset of the bumps.
    #[inline(always)]
    fn normal(&self, [u, v]: [f32; 2]) -> [f32; 3] {
        normal_from_offset(Offset { u: u * self.slope_scale, v: v * self.slope_scale })
    }

    /// A row of round lobes over `relief`, whose texels are those of level 0: bumps do not vary within one.
    fn isotropic_row(&self, bump_map: &BumpMap, y: u32, out: &mut [OrientedLobe]) {
        let mut green = vec![0.0; out.len()];
        self.base.green(y, &mut green);
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
            let (mut own, mut row) = (vec![BaseTexel::default(); out.len()], vec![ShapedMoments::default(); out.len()]);
            base.row(level, y as u32, &mut own);
            bumps(level, y as u32, &mut row);
            for ((lobe, texel), m) in out.iter_mut().zip(&own).zip(&row) {
                // The correction depends on the ratio of both: widths are scaled instead of four orders of moments.
                let own = base_lobe(texel);
                let unscaled = SquaredAlpha((1.0 / squared_scale) * own.0);
                let corrected = settings.distribution.correct(m, unscaled, settings.family);
                let Offset { u, v } = corrected.centre;
                let centre = Offset { u: u * self.slope_scale, v: v * self.slope_scale };
                *lobe = OrientedLobe::new(centre, own.roughen(squared_scale * corrected.covariance));
            }
        });
        Level { width, height, texels }
    }
}

impl Rows for Finest<'_> {
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
        let (mut own, mut offsets) = (vec![BaseTexel::default(); out.len()], vec![[0.0; 2]; out.len()]);
        self.base.row(y, &mut own);
        if let Some(bump_map) = bump_map {
            bump_map.offsets(y, &mut offsets);
            point(&offsets, out);
            out.iter_mut().zip(&own).for_each(|(lobe, texel)| lobe.squared_alpha = base_lobe(texel));
            return;
        }
        let mut bumps = vec![Moments::default(); out.len()];
        self.bumps.row(y, &mut bumps);
        offsets.iter_mut().zip(&bumps).for_each(|(offset, m)| *offset = [m.mean.u, m.mean.v]);
        point(&offsets, out);
        for ((lobe, texel), m) in out.iter_mut().zip(&own).zip(&bumps) {
            lobe.squared_alpha = base_lobe(texel).roughen(m.covariance.scaled([self.slope_scale; 2]));
        }
    }
}

/// The material's own lobe in a texel.
pub fn base_lobe(texel: &BaseTexel) -> SquaredAlpha {
    SquaredAlpha(Symmetric2::new(texel[0], texel[1], texel[2]))
}
