//! Decoded texels as a metric sees them, so that every error is a squared distance.

#![expect(clippy::needless_range_loop, reason = "lane loops read several arrays at one index")]

use crate::Metric;
use crate::direction::{UNIT, normal, seen};
use crate::lanes::{Lane, sum};

/// What sixteen decoded texels are to the metric.
#[derive(Clone, Copy)]
pub(super) struct Look {
    /// Points whose squared distance to those of [`target`] is the error, but for `loss`.
    pub points: [Lane; 3],
    /// Part of the error that does not depend on the target.
    pub loss: Lane,
}

/// What source texels of these levels ask for.
#[inline(always)]
pub(super) fn target(metric: Metric, levels: &[Lane; 3]) -> [Lane; 3] {
    match metric {
        Metric::Direction => {
            let mut normals = *levels;
            for i in 0..16 {
                let [x, y, z] = normal([levels[0][i] - UNIT, levels[1][i] - UNIT, levels[2][i] - UNIT]);
                (normals[0][i], normals[1][i], normals[2][i]) = (x, y, z);
            }
            normals
        }
        _ => look(metric, levels).points,
    }
}

/// Decoded levels as `metric` sees them. Directions are those of [`crate::direction`].
#[inline(always)]
pub(super) fn look(metric: Metric, levels: &[Lane; 3]) -> Look {
    let mut look = Look { points: *levels, loss: [0.0; 16] };
    if metric != Metric::Direction {
        let scale = metric.scale();
        for c in 0..3 {
            for i in 0..16 {
                look.points[c][i] *= scale[c];
            }
        }
        return look;
    }
    for i in 0..16 {
        let (direction, loss) = seen([levels[0][i] - UNIT, levels[1][i] - UNIT, levels[2][i] - UNIT]);
        for c in 0..3 {
            look.points[c][i] = direction[c];
        }
        look.loss[i] = loss;
    }
    look
}

impl Look {
    /// Returns the error against `target`.
    #[inline(always)]
    pub fn error(&self, target: &[Lane; 3]) -> f32 {
        let errors = self.errors(target);
        sum(|i| errors[i])
    }

    /// Returns the error of each texel against `target`.
    #[inline(always)]
    pub fn errors(&self, target: &[Lane; 3]) -> Lane {
        let mut errors = self.loss;
        for c in 0..3 {
            for i in 0..16 {
                let d = self.points[c][i] - target[c][i];
                errors[i] += d * d;
            }
        }
        errors
    }
}
