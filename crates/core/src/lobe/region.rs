//! The roughness ellipse as a region from which a ray tracer samples normals (paper, "The roughness information": "In a
//! ray tracer, the ellipse can be used to perform antialiasing by supersampling").

use crate::bump::Offset;
use crate::lobe::factor::Factor;

/// The distribution of sampled offsets about the mean. The covariance of both distributions is K.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Region {
    /// A 2-D normal distribution, which bumps are assumed to have.
    #[default]
    Normal,
    /// A uniform distribution inside the ellipse x^T K^-1 x = 4. It is bounded, so that no ray is an outlier. The
    /// variances of a uniform ellipse are a quarter of its squared half-axes, hence 4 and not 1.
    Ellipse,
}

impl Region {
    /// Returns the deviation from the mean offset for a point of the unit square.
    ///
    /// The deviation is D times a point of the plane, or of the disc of radius 2, whose coordinates have variance 1.
    /// Evenly distributed points give evenly distributed offsets. Coordinates are clamped to [0, 1]. The largest
    /// deviation of [`Region::Normal`] is 5.8.
    ///
    /// ```
    /// use roughcast_core::bump::{Offset, normal_from_offset};
    /// use roughcast_core::lobe::{Factor, Region};
    /// use roughcast_core::math::symmetric::Symmetric2;
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
    pub fn offset(self, factor: Factor, [share, angle]: [f32; 2]) -> Offset {
        let share = f64::from(share.clamp(0.0, 1.0));
        let radius = match self {
            // G. Box, M. Muller, 1958. The largest f32 below 1 is 1 - 2^-24.
            Self::Normal => (-2.0 * libm::log((1.0 - share).max(1.0 / f64::from(1 << 24)))).sqrt(),
            Self::Ellipse => 2.0 * share.sqrt(),
        };
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(angle.clamp(0.0, 1.0)));
        let (x, y) = ((radius * cos) as f32, (radius * sin) as f32);
        Offset { u: factor.d1 * x + factor.d2 * y, v: factor.d3 * y }
    }
}

#[cfg(test)]
mod tests;
