//! Lobes: alphas, the covariances that roughen them, D and lambda_1, correction factors, and the engines' parameters.
//!
//! A lobe is a density of slopes with a 2 x 2 matrix A of squared alphas, e.g. GGX:
//! P22(s) = 1/(pi sqrt|A|) (1 + s^T A^-1 s)^-2 (E. Heitz, "Understanding the masking-shadowing function in
//! microfacet-based BRDFs", 2014, section 5.3).

mod anisotropy;
pub mod blinn_phong;
mod correction;
mod distance;
mod factor;
mod family;
mod lattice;
mod merge;
mod oriented;
pub mod reflectance;
mod reflecting;
mod region;
mod shape;
mod table;
#[cfg(test)]
pub mod test_lobes;

pub use anisotropy::Anisotropy;
pub use correction::{Corrected, Distribution};
pub use distance::{isotropic_distance, shape_distance};
pub use factor::{Factor, lambda_1};
pub use family::Family;
pub use lattice::{KURTOSES, Lattice, LatticePoint, RATIOS, Table};
pub use oriented::OrientedLobe;
pub(crate) use oriented::frame;
pub use reflecting::{LobeTexel, ReflectingLobe};
pub use region::Region;
pub use shape::{CROSS_SKEWNESS, Shape};

use crate::math::symmetric::Symmetric2;

/// Perceptual roughness as glTF stores it, in [0, 1]: the square root of alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Roughness(pub f32);

/// Width of a lobe in slopes, in [0, 1] for engines: the square of glTF's roughness.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Alpha(pub f32);

impl From<Roughness> for Alpha {
    fn from(r: Roughness) -> Self {
        Self(r.0 * r.0)
    }
}

impl From<Alpha> for Roughness {
    fn from(alpha: Alpha) -> Self {
        Self(alpha.0.max(0.0).sqrt())
    }
}

/// The matrix A of a lobe, in (T, B).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SquaredAlpha(pub Symmetric2);

impl SquaredAlpha {
    /// Creates an isotropic lobe.
    pub fn isotropic(alpha: Alpha) -> Self {
        let squared = alpha.0 * alpha.0;
        Self(Symmetric2::diagonal(squared, squared))
    }

    /// Returns the roughened lobe A' = A + 2 K of a surface with the base lobe `self` and bumps of covariance `k`,
    /// which includes the correction factor. Exact for Beckmann lobes and normal distributions, where P22 is a normal
    /// density of covariance A/2.
    #[inline(always)]
    pub fn roughen(self, k: Symmetric2) -> Self {
        Self(self.0 + 2.0 * k)
    }

    /// Returns the alpha of the closest isotropic lobe: alpha^4 = |A|.
    ///
    /// This isotropic lobe has the peak of `self`. The distance from `self` is symmetric about this alpha, because
    /// stretching slopes by a matrix changes no distance between densities (test
    /// `the_closest_isotropic_lobe_has_the_determinant`).
    #[inline(always)]
    pub fn closest_isotropic(self) -> Alpha {
        Alpha(self.0.determinant().sqrt().sqrt())
    }

    /// Returns whether [`Self::closest_isotropic`] is above 1, without computing roots. The roots of 1 + 3 ulp round
    /// to 1.
    pub fn isotropic_exceeds_one(self) -> bool {
        self.0.determinant() > 1.0 + 3.0 * f32::EPSILON
    }

    /// Returns the ratio of the larger alpha to the smaller one, at least 1; infinite if only the smaller one is 0.
    pub fn axis_ratio(self) -> f32 {
        let e = self.0.eigen();
        if e.major <= 0.0 { 1.0 } else { (e.major / e.minor).sqrt() }
    }

    /// Returns whether glTF engines cannot show the lobe because an alpha is above 1 by more than the error of a fit.
    pub fn exceeds_one(self) -> bool {
        self.0.eigen().major > 1.02
    }
}

#[cfg(test)]
mod tests;
