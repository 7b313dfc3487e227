//! The roughness ellipse as a sampling region: what a ray tracer draws its normals from (paper, "The roughness
//! information": "In a ray tracer, the ellipse can be used to perform antialiasing by supersampling").

use crate::bump::Offset;
use crate::lobe::factor::Factor;

/// How offsets about the mean are spread. Either way their covariance is K.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Region {
    /// As a 2-D normal distribution: what the bumps are taken to be.
    #[default]
    Normal,
    /// Uniformly inside the ellipse x^T K^-1 x = 4: bounded, so that no ray strays. A uniform ellipse has a quarter of its
    /// squared half-axes as variances, hence 4 and not 1.
    Ellipse,
}

impl Region {
    /// The deviation from the mean offset for a point of the unit square: D times a point of the plane, or of the disc
    /// of radius 2, whose coordinates have variance 1. Evenly spread points give evenly spread offsets. Coordinates
    /// outside [0, 1] count as the nearest one inside; the largest deviation of [`Region::Normal`] is 5.8.
    ///
    /// ```
    /// use roughcast::bump::{Offset, normal_from_offset};
    /// use roughcast::lobe::{Factor, Region};
    /// use roughcast::math::symmetric::Symmetric2;
    ///
    /// // What the ray tracer reads where its ray hits: the mean offset and D.
    /// let (mean, d) = (Offset { u: 0.1, v: 0.0 }, Factor { d1: 0.3, d2: 0.1, d3: 0.05 });
    /// let (n, mut k) = (64, Symmetric2::ZERO);
    /// for i in 0..n * n {
    ///     let point = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|c| c / n as f32);
    ///     let deviation = Region::Ellipse.offset(d, point);
    ///     let normal = normal_from_offset(Offset { u: mean.u + deviation.u, v: mean.v + deviation.v });
    ///     assert!(normal[2] > 0.8); // ... and here it would trace the reflected ray.
    ///     k = k + (1.0 / (n * n) as f32) * Symmetric2::outer([deviation.u, deviation.v]);
    /// }
    /// // Together the rays have the roughness of the footprint.
    /// let exact = d.covariance();
    /// assert!((k.uu - exact.uu).abs() < 1e-3 && (k.uv - exact.uv).abs() < 1e-3 && (k.vv - exact.vv).abs() < 1e-3);
    /// ```
    pub fn offset(self, factor: Factor, [share, turn]: [f32; 2]) -> Offset {
        let share = f64::from(share.clamp(0.0, 1.0));
        let radius = match self {
            // G. Box, M. Muller, 1958. The largest f32 below 1 is 1 - 2^-24.
            Self::Normal => (-2.0 * libm::log((1.0 - share).max(1.0 / f64::from(1 << 24)))).sqrt(),
            Self::Ellipse => 2.0 * share.sqrt(),
        };
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(turn.clamp(0.0, 1.0)));
        let (x, y) = ((radius * cos) as f32, (radius * sin) as f32);
        Offset { u: factor.d1 * x + factor.d2 * y, v: factor.d3 * y }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::symmetric::Symmetric2;

    #[test]
    fn samples_reproduce_the_covariance() {
        let n = 200;
        for factor in [
            Factor { d1: 0.3, d2: -0.2, d3: 0.1 },
            Factor { d1: 0.0, d2: 0.2, d3: 0.1 },
            Factor { d1: 0.2, d2: 0.0, d3: 0.0 },
            Factor::default(),
        ] {
            for region in [Region::Normal, Region::Ellipse] {
                let (mut k, mut mean) = (Symmetric2::ZERO, [0.0; 2]);
                let share = 1.0 / (n * n) as f32;
                for i in 0..n * n {
                    let point = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|c| c / n as f32);
                    let o = region.offset(factor, point);
                    k = k + share * Symmetric2::outer([o.u, o.v]);
                    mean = [mean[0] + share * o.u, mean[1] + share * o.v];
                }
                let exact = factor.covariance();
                // The midpoint rule loses 0.4 % of the normal distribution's unbounded tail.
                let bound = 0.006 * exact.trace();
                for (found, exact) in [(k.uu, exact.uu), (k.uv, exact.uv), (k.vv, exact.vv)] {
                    assert!((found - exact).abs() <= bound, "{region:?} {factor:?}: {found} {exact}");
                }
                assert!(mean[0].abs() < 1e-4 && mean[1].abs() < 1e-4, "{mean:?}");
            }
        }
    }

    #[test]
    fn the_ellipse_is_bounded_and_full() {
        // With D = 1 the region is the disc of radius 2.
        let unit = Factor { d1: 1.0, d2: 0.0, d3: 1.0 };
        let border = Region::Ellipse.offset(unit, [1.0, 0.125]);
        assert!((border.u - 2f32.sqrt()).abs() < 1e-6 && (border.v - 2f32.sqrt()).abs() < 1e-6);
        assert_eq!(Region::Ellipse.offset(unit, [0.0, 0.3]), Offset::default());
        for hostile in [f32::INFINITY, -1.0, 2.0] {
            let far = Region::Normal.offset(unit, [hostile, hostile]);
            assert!(far.u.abs() < 5.9 && far.v.abs() < 5.9, "{far:?}");
        }
    }
}
