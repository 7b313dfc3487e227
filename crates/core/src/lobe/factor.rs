//! Roughness from covariances: D and lambda_1 (paper, "The roughness pyramid"). The correction factor is in
//! `correction.rs`.

use crate::math::symmetric::Symmetric2;

/// The upper triangular factor of K: D D^T = K with D = [[d1, d2], [0, d3]] and d1, d3 >= 0. Its elements are
/// proportional to standard deviations, so they can be stored with uniform accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Factor {
    /// First diagonal element.
    pub d1: f32,
    /// Off-diagonal element; the only one that may be negative.
    pub d2: f32,
    /// Second diagonal element.
    pub d3: f32,
}

impl Factor {
    /// Computes d3 = sqrt c, d2 = b / sqrt c, d1 = sqrt(a - b^2/c) for K = [[a, b], [b, c]]. K of rank 0 and 1 is
    /// allowed: for c = 0, a positive semidefinite K has b = 0, hence d2 = d3 = 0.
    pub fn of(k: Symmetric2) -> Self {
        let d3 = k.vv.max(0.0).sqrt();
        let d2 = if d3 > 0.0 {
            // |b| <= sqrt(a c) holds for exact numbers, but not after rounding.
            let bound = k.uu.max(0.0).sqrt();
            (k.uv / d3).clamp(-bound, bound)
        } else {
            0.0
        };
        Self { d1: (k.uu - d2 * d2).max(0.0).sqrt(), d2, d3 }
    }

    /// Returns D D^T.
    pub fn covariance(self) -> Symmetric2 {
        Symmetric2::new(self.d1 * self.d1 + self.d2 * self.d2, self.d2 * self.d3, self.d3 * self.d3)
    }
}

/// Returns lambda_1: the standard deviation along the axis of largest variance, a conservative isotropic roughness
/// (paper, "Isotropic roughness representation").
pub fn lambda_1(k: Symmetric2) -> f32 {
    k.eigen().major.max(0.0).sqrt()
}

#[cfg(test)]
mod tests;
