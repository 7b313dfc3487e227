//! The moments of bumps as samplers magnify them.

use crate::bump::{Moments, Offset};
use crate::lobe::{OrientedLobe, SquaredAlpha};
use crate::material::bump_map::BumpMap;
use crate::material::magnified::Magnified;
use crate::math::symmetric::Symmetric2;
use crate::mip::{AreaResampled, Magnification, Sampler, TexelRows};

/// Level 0 of the moments of a bump map: what a sampler interpolates within each texel, or the moments themselves where
/// it does not interpolate them.
pub struct MagnifiedBumps<'a> {
    /// The bumps.
    pub rows: AreaResampled<&'a BumpMap>,
    /// The modes of their sampler.
    pub sampler: Sampler,
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

impl TexelRows for MagnifiedBumps<'_> {
    type Texel = Moments;

    fn width(&self) -> u32 {
        self.rows.width()
    }

    fn height(&self) -> u32 {
        self.rows.height()
    }

    fn row(&self, y: u32, out: &mut [Moments]) {
        let unchanged = self.rows.unchanged().filter(|_| self.sampler.magnification == Magnification::Linear);
        let Some(bump_map) = unchanged else { return self.rows.row(y, out) };
        let mut lobes = vec![OrientedLobe::default(); out.len()];
        let wrap = Some(self.sampler.wrap);
        Magnified { source: &Normals(bump_map), wrap, is_isotropic: true }.row(y, &mut lobes);
        for (moments, lobe) in out.iter_mut().zip(lobes) {
            // A lobe without width is widened by twice the covariance.
            *moments = Moments { mean: lobe.offset(), covariance: 0.5 * lobe.squared_alpha.0 };
        }
    }
}
