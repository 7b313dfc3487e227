//! The variance that lobes need where they are not known texel by texel.

use rayon::prelude::*;

use crate::bump::ShapedMoments;
use crate::lobe::SquaredAlpha;
use crate::mip::{Pyramid, TexelRows};
use crate::settings::Settings;

/// Returns the sum over levels 1 and coarser of the mean trace of c K, where c is the correction factor of each texel
/// under `base_lobe`.
pub fn corrected_variance<R>(moments: &Pyramid<R>, settings: &Settings, base_lobe: SquaredAlpha) -> f64
where
    R: TexelRows<Texel = ShapedMoments>,
{
    let mean_trace = |(level, (width, height)): (usize, (u32, u32))| {
        let in_row = |texels: &mut Vec<ShapedMoments>, y: u32| {
            moments.row(level, y, texels);
            let corrected = |m| settings.distribution.correct(m, base_lobe, settings.lobe).covariance.trace();
            texels.iter().map(|m| f64::from(corrected(m))).sum::<f64>()
        };
        let empty = || vec![ShapedMoments::default(); width as usize];
        // Rows are added in order, so that the sum does not depend on the number of threads.
        let rows: Vec<f64> = (0..height).into_par_iter().map_init(empty, in_row).collect();
        rows.iter().sum::<f64>() / (f64::from(width) * f64::from(height))
    };
    moments.sizes().into_iter().enumerate().skip(1).map(mean_trace).sum()
}
