//! The correction factor c: the roughness that a lobe should have is c K, not K, and where its centre should be.
//!
//! c follows the shape of the distribution along each axis of K and how wide the bumps spread beside the lobe. The
//! tables of each family are fitted to synthetic distributions by `examples/correction_table`, which prints `table.rs`.

use crate::bump::{Offset, ShapedMoments};
use crate::lobe::family::Family;
use crate::lobe::lattice::LatticePoint;
use crate::lobe::shape::Shape;
use crate::lobe::{SquaredAlpha, table};
use crate::math::symmetric::Symmetric2;

/// The shape that the offsets in a footprint are taken to have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Distribution {
    /// The one that the footprint's own third and fourth moments tell.
    #[default]
    Auto,
    /// A 2-D normal distribution.
    Normal,
    /// Uniform in a rectangle: the case that the paper names.
    Uniform,
}

/// What a lobe should take for the mean and covariance of its bumps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corrected {
    /// The centre: the mean, less what the tails pull it away from where most offsets are.
    pub centre: Offset,
    /// c K, with a c for each axis.
    pub covariance: Symmetric2,
}

impl Distribution {
    /// Centre and c K for bumps of moments `m` under a lobe of `own` squared alphas.
    pub fn correct(self, m: &ShapedMoments, own: SquaredAlpha, family: Family) -> Corrected {
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
            let squared_alpha = own.0.uu * x * x + 2.0 * own.0.uv * x * y + own.0.vv * y * y;
            let point = LatticePoint::new(shape.kurtosis[k], variance, squared_alpha);
            *corrected = variance
                * match self {
                    Self::Auto => point.interpolate(&table.factor),
                    Self::Normal => point.along(&table.normal),
                    Self::Uniform => point.along(&table.uniform),
                };
            if self == Self::Auto {
                // Nothing was fitted beyond a deviation.
                let shift = (shape.skewness[k] * point.interpolate(&table.shift)).clamp(-1.0, 1.0) * variance.sqrt();
                centre.u -= shift * x;
                centre.v -= shift * y;
            }
        }
        Corrected { centre, covariance: Symmetric2::from_axes(corrected[0], corrected[1], shape.axes[0]) }
    }
}
