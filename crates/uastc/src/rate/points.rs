//! Texels as points in the space of a metric, in which an error is a squared distance.

#![expect(clippy::needless_range_loop, reason = "loops over texels read several arrays at one index")]

use crate::Metric;
use crate::direction::{UNIT, effective_direction, normal};
use crate::lanes::{ScalarGrid, Texels, sum};

/// The points of sixteen decoded texels.
#[derive(Clone, Copy)]
pub(super) struct DecodedPoints {
    /// The error is the squared distance from these points to those of [`source_points`], plus `loss`.
    pub points: [ScalarGrid; 3],
    /// The part of the error that does not depend on the source.
    pub loss: ScalarGrid,
}

/// Returns red, green and blue of the texels of one block.
pub(super) fn grids(texels: &Texels) -> [ScalarGrid; 3] {
    [0, 1, 2].map(|c| texels.map(|texel| f32::from(texel[c])))
}

/// Returns the points of source texels with these `levels`.
#[inline(always)]
pub(super) fn source_points(metric: Metric, levels: &[ScalarGrid; 3]) -> [ScalarGrid; 3] {
    match metric {
        Metric::Direction => {
            let mut normals = *levels;
            for i in 0..16 {
                let [x, y, z] = normal([levels[0][i] - UNIT, levels[1][i] - UNIT, levels[2][i] - UNIT]);
                (normals[0][i], normals[1][i], normals[2][i]) = (x, y, z);
            }
            normals
        }
        _ => decoded_points(metric, levels).points,
    }
}

/// Returns the points of decoded texels with these `levels`. Directions are those of [`effective_direction`].
#[inline(always)]
pub(super) fn decoded_points(metric: Metric, levels: &[ScalarGrid; 3]) -> DecodedPoints {
    let mut decoded = DecodedPoints { points: *levels, loss: [0.0; 16] };
    if metric != Metric::Direction {
        let scale = metric.scale();
        for c in 0..3 {
            for i in 0..16 {
                decoded.points[c][i] *= scale[c];
            }
        }
        return decoded;
    }
    for i in 0..16 {
        let (direction, loss) = effective_direction([levels[0][i] - UNIT, levels[1][i] - UNIT, levels[2][i] - UNIT]);
        for c in 0..3 {
            decoded.points[c][i] = direction[c];
        }
        decoded.loss[i] = loss;
    }
    decoded
}

impl DecodedPoints {
    /// Returns the error of all sixteen texels against the points of the source.
    #[inline(always)]
    pub fn error(&self, source: &[ScalarGrid; 3]) -> f32 {
        let errors = self.errors(source);
        sum(|i| errors[i])
    }

    /// Returns the error of each texel against the points of the source.
    #[inline(always)]
    pub fn errors(&self, source: &[ScalarGrid; 3]) -> ScalarGrid {
        let mut errors = self.loss;
        for c in 0..3 {
            for i in 0..16 {
                let d = self.points[c][i] - source[c][i];
                errors[i] += d * d;
            }
        }
        errors
    }
}
