//! The correction factor c (a lobe should be roughened by c K, not by K) and the corrected centre of a lobe.
//!
//! c depends on the shape of the distribution along each axis of K, and on the deviation of the bumps relative to
//! alpha. The tables of each family are fitted to synthetic distributions by `benches/studies/correction_table`, which
//! prints `table.rs`.

use crate::bump::{Offset, ShapedMoments};
use crate::lobe::family::Family;
use crate::lobe::lattice::LatticePoint;
use crate::lobe::shape::Shape;
use crate::lobe::{SquaredAlpha, table};
use crate::math::symmetric::Symmetric2;

/// The assumed shape of the distribution of offsets in a footprint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Distribution {
    /// The shape that follows from the third and fourth moments of the footprint.
    #[default]
    #[cfg_attr(
        feature = "cli",
        value(help = "The slopes' own: lobes are merged by likelihood, factors follow the kurtosis")
    )]
    Auto,
    /// A 2-D normal distribution.
    Normal,
    /// A uniform distribution in a rectangle, which the paper names as an example.
    #[cfg_attr(feature = "cli", value(help = "Uniform in a rectangle"))]
    Uniform,
}

/// Corrected mean and covariance of the bumps of a footprint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corrected {
    /// The mean, shifted back towards most offsets if tails on one side pull it away.
    pub centre: Offset,
    /// c K, with a factor c for each axis.
    pub covariance: Symmetric2,
}

impl Distribution {
    /// Computes centre and c K for bumps of moments `m` on a surface with the lobe `base`.
    pub fn correct(self, m: &ShapedMoments, base: SquaredAlpha, family: Family) -> Corrected {
        let table = match family {
            Family::Ggx => &table::GGX,
            Family::Beckmann => &table::BECKMANN,
        };
        let shape = Shape::of(m);
        let mut centre = m.moments.mean;
        let mut corrected = [0.0; 2];
        for (k, corrected) in corrected.iter_mut().enumerate() {
            let [x, y] = shape.axes[k];
            let variance = shape.variance[k];
            let squared_alpha = base.0.uu * x * x + 2.0 * base.0.uv * x * y + base.0.vv * y * y;
            let point = LatticePoint::new(shape.kurtosis[k], variance, squared_alpha);
            *corrected = variance
                * match self {
                    Self::Auto => point.interpolate(&table.factor),
                    Self::Normal => point.along(&table.normal),
                    Self::Uniform => point.along(&table.uniform),
                };
            if self == Self::Auto {
                // The tables were fitted to shifts of at most one standard deviation.
                let shift = (shape.skewness[k] * point.interpolate(&table.shift)).clamp(-1.0, 1.0) * variance.sqrt();
                centre.u -= shift * x;
                centre.v -= shift * y;
            }
        }
        Corrected { centre, covariance: Symmetric2::from_axes(corrected[0], corrected[1], shape.axes[0]) }
    }
}
