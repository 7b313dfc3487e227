//! A lobe and the normal that it is centred on.

use super::SquaredAlpha;
use crate::bump::{Offset, normal_from_offset, slopes};
use crate::math::vector::cross;
use crate::simd::Real;

/// A lobe about a unit normal: the reflection of one texel of a level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OrientedLobe {
    /// Unit normal in (T, B, N), with z > 0.
    pub normal: [f32; 3],
    /// Squared alphas along T made perpendicular to the normal, and B = N x T.
    pub squared_alpha: SquaredAlpha,
}

impl OrientedLobe {
    /// Creates a lobe about the normal of `offset`.
    pub fn new(offset: Offset, squared_alpha: SquaredAlpha) -> Self {
        Self { normal: normal_from_offset(offset), squared_alpha }
    }

    /// Returns the offset (f_u, f_v) of the normal.
    pub fn offset(&self) -> Offset {
        slopes(self.normal)
    }
}

/// The least cosine to a normal for which slopes are computed, at 87 degrees. Steeper slopes are treated like this one.
pub(super) const LEAST_COSINE: f32 = 0.05;

/// Returns the orthonormal frame of a unit normal: T made perpendicular to the normal, then B = N x T, as in glTF's
/// engines.
#[inline(always)]
pub fn frame<F: Real>(n: [F; 3]) -> [[F; 3]; 3] {
    let one = n[0].splat_like(1.0);
    // For normals tilted by almost 90 degrees, x rounds to 1. For a slope of 16, 1 - x^2 is 0.004.
    let scale = one / (one - n[0] * n[0]).max(n[0].splat_like(1e-7)).sqrt();
    let minus_x = n[0].splat_like(0.0) - n[0];
    let t = [(one - n[0] * n[0]) * scale, minus_x * n[1] * scale, minus_x * n[2] * scale];
    [t, cross(n, t), n]
}

#[cfg(test)]
mod tests;
