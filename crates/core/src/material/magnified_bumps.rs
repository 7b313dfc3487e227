//! The moments of bumps as samplers magnify them.

use crate::bump::{Moments, Offset};
use crate::lobe::{OrientedLobe, SquaredAlpha};
use crate::material::bump_map::BumpMap;
use crate::material::magnified::Magnified;
use crate::math::symmetric::Symmetric2;
use crate::mip::{AreaResampled, Magnification, Sampler, TexelRows};

/// The moments of a bump map: what a sampler interpolates within each texel, or the moments themselves where it does
/// not interpolate them.
pub struct MagnifiedMap<'a> {
    bump_map: &'a BumpMap,
    /// The modes of the map's sampler.
    sampler: Sampler,
}

/// Level 0 of a magnified bump map on a grid. Engines magnify the map that they are given and not the resampled one, so
/// a texel of another size stands for what is interpolated within its area.
pub type MagnifiedBumps<'a> = AreaResampled<MagnifiedMap<'a>>;

impl<'a> MagnifiedBumps<'a> {
    /// Magnifies the bump map of `bumps`, and puts it on their grid.
    pub fn of(bumps: AreaResampled<&'a BumpMap>, sampler: Sampler) -> Self {
        let map = MagnifiedMap { bump_map: bumps.source(), sampler };
        Self::new(map, bumps.width(), bumps.height())
    }
}

/// The normals of a bump map as lobes without width.
struct Normals<'a>(&'a BumpMap);

impl TexelRows for Normals<'_> {
    type Texel = OrientedLobe;

    fn width(&self) -> u32 {
        self.0.width()
    }

    fn height(&self) -> u32 {
        self.0.height()
    }

    fn row(&self, y: u32, out: &mut [OrientedLobe]) {
        let mut offsets = vec![[0.0; 2]; out.len()];
        self.0.offsets(y, &mut offsets);
        for (lobe, [u, v]) in out.iter_mut().zip(offsets) {
            *lobe = OrientedLobe::new(Offset { u, v }, SquaredAlpha(Symmetric2::ZERO));
        }
    }
}

impl TexelRows for MagnifiedMap<'_> {
    type Texel = Moments;

    fn width(&self) -> u32 {
        self.bump_map.width()
    }

    fn height(&self) -> u32 {
        self.bump_map.height()
    }

    fn row(&self, y: u32, out: &mut [Moments]) {
        self.rows(y, out);
    }

    fn rows(&self, first: u32, out: &mut [Moments]) {
        if self.sampler.magnification != Magnification::Linear {
            return self.bump_map.rows(first, out);
        }
        let mut lobes = vec![OrientedLobe::default(); out.len()];
        let wrap = Some(self.sampler.wrap);
        Magnified { source: &Normals(self.bump_map), wrap, is_isotropic: true }.rows(first, &mut lobes);
        for (moments, lobe) in out.iter_mut().zip(lobes) {
            // A lobe without width is widened by twice the covariance.
            *moments = Moments { mean: lobe.offset(), covariance: 0.5 * lobe.squared_alpha.0 };
        }
    }
}
