//! The smallest model within the error bound.

use rayon::prelude::*;

use crate::lobe::{SquaredAlpha, isotropic_distance, shape_distance};

/// Mean lobe error per level that leaving something out of the model causes: the distance between lobes, not counting
/// what the fullest model itself misses.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct ModelLoss {
    /// Of keeping the roughness as it was.
    pub none: f32,
    /// Of one number per texel.
    pub isotropic: f32,
}

impl ModelLoss {
    /// The mean over the texels of one level; `lobe` returns a texel's lobe without and with the lost bumps. Summed
    /// row by row in order, so that it does not depend on threads.
    pub fn of_level(width: u32, height: u32, row: impl Fn(u32, &mut [(SquaredAlpha, SquaredAlpha)]) + Sync) -> Self {
        let rows: Vec<[f64; 2]> = (0..height)
            .into_par_iter()
            .map_init(
                || vec![Default::default(); width as usize],
                |lobes, y| {
                    row(y, lobes);
                    lobes.iter().fold([0.0; 2], |sum, (bare, full)| {
                        let shape = f64::from(shape_distance(full.axis_ratio()));
                        let (before, after) = (bare.closest_isotropic(), full.closest_isotropic());
                        let size = f64::from(isotropic_distance(before, after));
                        // A lobe that was elliptical already keeps its ellipse when nothing is modelled.
                        let kept = f64::from(shape_distance(bare.axis_ratio()));
                        [sum[0] + size.max((shape - kept).abs()), sum[1] + shape]
                    })
                },
            )
            .collect();
        let count = f64::from(width) * f64::from(height);
        let total = rows.iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        Self { none: (total[0] / count) as f32, isotropic: (total[1] / count) as f32 }
    }

    /// The larger loss of each kind.
    pub fn worst(self, other: Self) -> Self {
        Self { none: self.none.max(other.none), isotropic: self.isotropic.max(other.isotropic) }
    }
}
