//! The lobes of level 0, and what coarser levels stand for.

use rayon::prelude::*;

use crate::bump::{Moments, Offset, Shaped, ShapedMoments, normal_from_offset};
use crate::lobe::{Distribution, OrientedLobe, ReflectingLobe, SquaredAlpha};
use crate::material::base::{Base, BaseRows, BaseTexel, base_lobe};
use crate::material::bump_map::BumpMap;
use crate::material::bumps::Bumps;
use crate::material::magnified::Magnified;
use crate::material::magnified_bumps::MagnifiedBumps;
use crate::math::symmetric::Symmetric2;
use crate::mip::{AreaResampled, Level, Magnification, MipTail, Pyramid, Sampler, TexelRows};
use crate::settings::Settings;
use crate::simd::map_row;

/// The lobes of level 0.
pub struct Level0<'a> {
    pub base: BaseRows<'a>,
    pub bumps: AreaResampled<&'a BumpMap>,
    /// Multiplies the offsets.
    pub slope_scale: f32,
}

impl<'a> Level0<'a> {
    /// Returns the unit normal of an offset of the bumps.
    #[inline(always)]
    fn normal(&self, [u, v]: [f32; 2]) -> [f32; 3] {
        normal_from_offset(Offset { u: u * self.slope_scale, v: v * self.slope_scale })
    }

    /// Points the lobes of a row along the normals of `offsets`.
    fn point(&self, offsets: impl Iterator<Item = [f32; 2]> + Clone, out: &mut [OrientedLobe]) {
        map_row(offsets, out, |offset| self.normal(offset), |lobe, normal| lobe.normal = normal);
    }

    /// Writes row `first` of the lobes that are widened by `bumps`, which vary within a texel, and the rows below.
    fn widened_rows(&self, bumps: &impl TexelRows<Texel = Moments>, first: u32, out: &mut [OrientedLobe]) {
        let width = bumps.width() as usize;
        let (mut texels, mut rows) = (vec![BaseTexel::default(); width], vec![Moments::default(); out.len()]);
        bumps.rows(first, &mut rows);
        for ((y, out), row) in (first..).zip(out.chunks_exact_mut(width)).zip(rows.chunks_exact(width)) {
            self.base.row(y, &mut texels);
            self.point(row.iter().map(|m| [m.mean.u, m.mean.v]), out);
            for ((lobe, texel), m) in out.iter_mut().zip(&texels).zip(row) {
                lobe.squared_alpha = base_lobe(texel).roughen(m.covariance.scaled([self.slope_scale; 2]));
            }
        }
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

    /// Returns levels 1 and coarser as A + 2 c K, where A is the mean of the base lobes.
    pub fn roughened(
        &self,
        base: &Base<'_>,
        bumps: &Bumps<'_>,
        sampler: Sampler,
        settings: &Settings,
    ) -> Vec<Level<OrientedLobe>> {
        let rows = MagnifiedBumps::of(bumps.rows, sampler);
        let means = (!base.has_mean_squared_alphas()).then(|| MipTail::new(&self.base));
        let base_row = |level: usize, y: u32, out: &mut [BaseTexel]| match &means {
            Some(tail) => tail.row(&self.base, level, y, out),
            None => base.row(level, y, out),
        };
        let levels = bumps.sizes().into_iter().enumerate().skip(1);
        match settings.distribution {
            Distribution::Auto => {
                let moments = Pyramid::new(Shaped(rows));
                let row = |level, y, out: &mut [ShapedMoments]| moments.row(level, y, out);
                levels.map(|(level, size)| self.roughened_level(level, size, base_row, row, settings)).collect()
            }
            Distribution::Normal | Distribution::Uniform => {
                let moments = Pyramid::new(rows);
                let row = |level, y, out: &mut [ShapedMoments]| {
                    let mut plain = vec![Moments::default(); out.len()];
                    moments.row(level, y, &mut plain);
                    out.iter_mut().zip(plain).for_each(|(shaped, m)| *shaped = ShapedMoments::normal(m));
                };
                levels.map(|(level, size)| self.roughened_level(level, size, base_row, row, settings)).collect()
            }
        }
    }

    fn roughened_level(
        &self,
        level: usize,
        (width, height): (u32, u32),
        base: impl Fn(usize, u32, &mut [BaseTexel]) + Sync,
        bumps: impl Fn(usize, u32, &mut [ShapedMoments]) + Sync,
        settings: &Settings,
    ) -> Level<OrientedLobe> {
        let squared_scale = (self.slope_scale * self.slope_scale).max(f32::MIN_POSITIVE);
        let mut texels = vec![OrientedLobe::default(); width as usize * height as usize];
        texels.par_chunks_mut(width as usize).enumerate().for_each(|(y, out)| {
            let (mut texels, mut row) =
                (vec![BaseTexel::default(); out.len()], vec![ShapedMoments::default(); out.len()]);
            base(level, y as u32, &mut texels);
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
        if let Some(bump_map) = bump_map {
            let (mut texels, mut offsets) = (vec![BaseTexel::default(); out.len()], vec![[0.0; 2]; out.len()]);
            self.base.row(y, &mut texels);
            bump_map.offsets(y, &mut offsets);
            self.point(offsets.into_iter(), out);
            out.iter_mut().zip(&texels).for_each(|(lobe, texel)| lobe.squared_alpha = base_lobe(texel));
            return;
        }
        self.widened_rows(&self.bumps, y, out);
    }
}

/// The lobes of level 0 as samplers magnify it, which coarser levels stand for.
#[derive(Clone, Copy)]
pub struct MagnifiedLobes<'r, 'a> {
    pub level_0: &'r Level0<'a>,
    /// The modes of the sampler.
    pub sampler: Sampler,
}

impl TexelRows for MagnifiedLobes<'_, '_> {
    type Texel = OrientedLobe;

    fn width(&self) -> u32 {
        self.level_0.width()
    }

    fn height(&self) -> u32 {
        self.level_0.height()
    }

    fn row(&self, y: u32, out: &mut [OrientedLobe]) {
        self.rows(y, out);
    }

    fn rows(&self, first: u32, out: &mut [OrientedLobe]) {
        let Self { level_0, sampler } = *self;
        if level_0.bumps.unchanged().is_none() {
            return level_0.widened_rows(&MagnifiedBumps::of(level_0.bumps, sampler), first, out);
        }
        let wrap = (sampler.magnification == Magnification::Linear).then_some(sampler.wrap);
        Magnified { source: level_0, wrap, is_isotropic: !level_0.base.is_anisotropic() }.rows(first, out);
    }
}

/// The lobes of level 0 as samplers magnify it, with their reflectance.
pub struct ReflectingRows<'r, 'a>(pub MagnifiedLobes<'r, 'a>);

impl TexelRows for ReflectingRows<'_, '_> {
    type Texel = ReflectingLobe;

    fn width(&self) -> u32 {
        self.0.width()
    }

    fn height(&self) -> u32 {
        self.0.height()
    }

    fn row(&self, y: u32, out: &mut [ReflectingLobe]) {
        self.rows(y, out);
    }

    fn rows(&self, first: u32, out: &mut [ReflectingLobe]) {
        let (mut lobes, mut reflectance) = (vec![OrientedLobe::default(); out.len()], vec![0.0; out.len()]);
        self.0.rows(first, &mut lobes);
        for (y, row) in (first..).zip(reflectance.chunks_exact_mut(self.width() as usize)) {
            self.0.level_0.base.reflectance_row(y, row);
        }
        for ((texel, lobe), reflectance) in out.iter_mut().zip(lobes).zip(reflectance) {
            *texel = ReflectingLobe { lobe, reflectance };
        }
    }
}
