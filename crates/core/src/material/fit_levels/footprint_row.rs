//! The footprints of a row of texels, to which their lobes are fitted.

use crate::lobe::{LobeTexel, OrientedLobe};
use crate::metric::DrawnFootprint;
use crate::mip::FinerRows;

/// The weights and lobes of a footprint's texels; the weights sum to 1.
pub type Parts = [(f32, OrientedLobe)];

/// The footprints of a row of texels.
pub struct FootprintRow {
    /// The level of the footprints' texels.
    pub level: usize,
    /// The size of this level.
    pub whole: (u32, u32),
    /// The row.
    pub y: u32,
    /// The size of its level.
    pub size: (u32, u32),
    /// Strata along each axis of a footprint.
    pub strata: u32,
}

impl FootprintRow {
    /// Replaces lobes of the row by those that `refit` returns for a column, its footprint and the lobe in `out`. Calls
    /// it for columns with `is_refitted`. `finer` writes rows of finer levels.
    pub fn refit<T: LobeTexel>(
        &self,
        finer: &FinerRows<'_, T>,
        is_refitted: impl Fn(u32) -> bool,
        refit: impl Fn(u32, &Parts, OrientedLobe) -> OrientedLobe,
        out: &mut [T],
    ) {
        let Self { level, whole, y, size, strata } = *self;
        let footprint = |x| DrawnFootprint { whole, size, texel: (x, y), strata };
        let rows = footprint(0).rows();
        let mut texels = vec![T::default(); whole.0 as usize * rows.len()];
        let mut unread = texels.as_mut_slice();
        for adjacent in rows.chunk_by(|above, below| above.0 + 1 == below.0) {
            let (band, rest) = unread.split_at_mut(whole.0 as usize * adjacent.len());
            finer(level, adjacent[0].0, band);
            unread = rest;
        }
        let mut parts = Vec::new();
        for (x, texel) in (0..).zip(out).filter(|(x, _)| is_refitted(*x)) {
            parts.clear();
            for ((row, share), texels) in rows.iter().zip(texels.chunks_exact(whole.0 as usize)) {
                parts.extend(footprint(x).columns(*row).into_iter().map(|(column, weight)| {
                    let part = &texels[column as usize];
                    (weight * share * part.reflectance(), *part.lobe())
                }));
            }
            let total: f32 = parts.iter().map(|part| part.0).sum();
            parts.iter_mut().for_each(|part| part.0 /= total);
            texel.set_lobe(refit(x, &parts, *texel.lobe()));
        }
    }
}
