//! The lobe of every texel of every level: the material's own, roughened by the bumps that the level has lost.

use rayon::prelude::*;

use super::base::{BaseRows, BaseTexel};
use super::bumps::Bumps;
use super::relief::Relief;
use crate::bump::Offset;
use crate::lobe::{OrientedLobe, SquaredAlpha};
use crate::pyramid::{Area, Level, Moments, Pyramid, Rows, ShapedMoments, build};
use crate::roughness::Distribution;
use crate::symmetric::Symmetric2;

/// Lobes of a material on the grid of its bumps.
pub struct Lobes<'a> {
    finest: Finest<'a>,
    coarser: Vec<Level<OrientedLobe>>,
}

impl<'a> Lobes<'a> {
    /// `base` on the grid of `bumps`, whose offsets are multiplied by `slope_scale`. Levels 1 and coarser are merged from
    /// level to level by likelihood where the distribution is the bumps' own, else folded by its correction factor.
    pub fn new<'b: 'a>(
        base: &Pyramid<BaseRows<'a>>,
        bumps: &Bumps<'b>,
        slope_scale: f32,
        distribution: Distribution,
    ) -> Self {
        let finest = Finest { base: base.source().clone(), bumps: bumps.rows, slope_scale };
        let coarser = match distribution {
            Distribution::Auto => build(&finest),
            Distribution::Normal | Distribution::Uniform => {
                let levels = bumps.sizes().into_iter().enumerate().skip(1);
                levels.map(|(level, size)| finest.folded(level, size, base, bumps.moments(), distribution)).collect()
            }
        };
        Self { finest, coarser }
    }

    /// What offsets are multiplied by.
    pub fn slope_scale(&self) -> f32 {
        self.finest.slope_scale
    }

    /// Writes the lobes of row `y` of `level` to `out`.
    pub fn row(&self, level: usize, y: u32, out: &mut [OrientedLobe]) {
        match level.checked_sub(1) {
            None => self.finest.row(y, out),
            Some(coarser) => self.coarser[coarser].row(y, out),
        }
    }

    /// Writes the offsets that a normal map should hold to `out`: where the lobes of row `y` of `level` point, before
    /// scaling.
    pub fn offsets(&self, level: usize, y: u32, out: &mut [Offset]) {
        if level == 0 {
            let mut bumps = vec![Moments::default(); out.len()];
            self.finest.bumps.row(y, &mut bumps);
            out.iter_mut().zip(bumps).for_each(|(offset, m)| *offset = m.mean);
            return;
        }
        let scale = 1.0 / self.finest.slope_scale;
        let mut lobes = vec![OrientedLobe::default(); out.len()];
        self.row(level, y, &mut lobes);
        for (offset, lobe) in out.iter_mut().zip(lobes) {
            let Offset { u, v } = lobe.offset();
            *offset = Offset { u: u * scale, v: v * scale };
        }
    }

    /// The single texel of the coarsest level.
    pub fn whole(&self) -> OrientedLobe {
        let mut texel = [OrientedLobe::default()];
        self.row(self.coarser.len(), 0, &mut texel);
        texel[0]
    }
}

/// Level 0.
struct Finest<'a> {
    base: BaseRows<'a>,
    bumps: Area<&'a Relief>,
    slope_scale: f32,
}

impl Finest<'_> {
    fn scaled(&self, m: &Moments) -> Moments {
        let scale = [self.slope_scale; 2];
        Moments {
            mean: Offset { u: m.mean.u * self.slope_scale, v: m.mean.v * self.slope_scale },
            covariance: m.covariance.scaled(scale),
        }
    }

    fn folded(
        &self,
        level: usize,
        (width, height): (u32, u32),
        base: &Pyramid<BaseRows<'_>>,
        moments: &Pyramid<Area<&Relief>>,
        distribution: Distribution,
    ) -> Level<OrientedLobe> {
        let mut texels = vec![OrientedLobe::default(); width as usize * height as usize];
        texels.par_chunks_mut(width as usize).enumerate().for_each(|(y, out)| {
            let (mut own, mut bumps) = (vec![BaseTexel::default(); out.len()], vec![Moments::default(); out.len()]);
            base.row(level, y as u32, &mut own);
            moments.row(level, y as u32, &mut bumps);
            for ((lobe, texel), m) in out.iter_mut().zip(&own).zip(&bumps) {
                let (m, own) = (self.scaled(m), own_lobe(texel));
                let corrected = distribution.correct(&ShapedMoments::normal(m), own);
                *lobe = OrientedLobe::new(corrected.centre, own.fold(corrected.covariance));
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
        let (mut own, mut bumps) = (vec![BaseTexel::default(); out.len()], vec![Moments::default(); out.len()]);
        self.base.row(y, &mut own);
        self.bumps.row(y, &mut bumps);
        for ((lobe, texel), m) in out.iter_mut().zip(&own).zip(&bumps) {
            let m = self.scaled(m);
            *lobe = OrientedLobe::new(m.mean, own_lobe(texel).fold(m.covariance));
        }
    }
}

/// The material's own lobe in a texel.
pub fn own_lobe(texel: &BaseTexel) -> SquaredAlpha {
    SquaredAlpha(Symmetric2::new(texel[0], texel[1], texel[2]))
}
