//! The mean correction factor of a map.

use rayon::prelude::*;

use crate::bump::ShapedMoments;
use crate::lobe::SquaredAlpha;
use crate::mip::{Pyramid, TexelRows};
use crate::settings::Settings;

/// Returns the one correction factor c of a map under `base_lobe`: the trace of all corrected covariances over the
/// trace of all covariances, where each level has the same weight. Returns 1 for a map without bumps.
pub fn mean_correction<R>(moments: &Pyramid<R>, settings: &Settings, base_lobe: SquaredAlpha) -> f32
where
    R: TexelRows<Texel = ShapedMoments>,
{
    let mut total = [0.0; 2];
    for (level, (width, height)) in moments.sizes().into_iter().enumerate().skip(1) {
        let in_row = |texels: &mut Vec<ShapedMoments>, y: u32| {
            moments.row(level, y, texels);
            texels.iter().fold([0.0; 2], |sum, m| {
                let corrected = settings.distribution.correct(m, base_lobe, settings.lobe).covariance.trace();
                [sum[0] + f64::from(corrected), sum[1] + f64::from(m.moments.covariance.trace())]
            })
        };
        let empty = || vec![ShapedMoments::default(); width as usize];
        // Rows are added in order, so that the sum does not depend on the number of threads.
        let rows: Vec<[f64; 2]> = (0..height).into_par_iter().map_init(empty, in_row).collect();
        let count = f64::from(width) * f64::from(height);
        total = rows.iter().fold(total, |t, row| [t[0] + row[0] / count, t[1] + row[1] / count]);
    }
    if total[1] > 0.0 { (total[0] / total[1]) as f32 } else { 1.0 }
}
