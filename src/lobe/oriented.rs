//! A lobe about a normal of its own.

use super::SquaredAlpha;
use crate::bump::{Offset, normal_from_offset, slopes};
use crate::simd::Real;

/// A lobe about a unit normal: what one texel of a level reflects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OrientedLobe {
    /// Unit normal in (T, B, N), with z > 0.
    pub normal: [f32; 3],
    /// Squared alphas along T made perpendicular to the normal, and B = N x T.
    pub squared_alpha: SquaredAlpha,
}

impl OrientedLobe {
    /// A lobe about the normal of `offset`.
    pub fn new(offset: Offset, squared_alpha: SquaredAlpha) -> Self {
        Self { normal: normal_from_offset(offset), squared_alpha }
    }

    /// (f_u, f_v) of the normal.
    pub fn offset(&self) -> Offset {
        slopes(self.normal)
    }
}

/// Slopes from a normal are counted to 87 degrees: what lies beyond is as good as behind the surface.
pub(super) const LEAST_COSINE: f32 = 0.05;

/// The orthonormal frame of a unit normal: T made perpendicular to it, then B = N x T, as glTF's engines do.
#[inline(always)]
pub(super) fn frame<F: Real>(n: [F; 3]) -> [[F; 3]; 3] {
    let one = n[0].splat_like(1.0);
    // Normals that lean by almost 90 degrees have an x that rounds to 1; a slope of 16 leaves 0.004.
    let scale = one / (one - n[0] * n[0]).max(n[0].splat_like(1e-7)).sqrt();
    let minus_x = n[0].splat_like(0.0) - n[0];
    let t = [(one - n[0] * n[0]) * scale, minus_x * n[1] * scale, minus_x * n[2] * scale];
    [t, [n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]], n]
}

#[inline(always)]
pub(super) fn dot<F: Real>(a: [F; 3], b: [F; 3]) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_survive() {
        for (u, v) in [(0.0, 0.0), (0.5, -2.0), (-15.0, 3.0)] {
            let back = OrientedLobe::new(Offset { u, v }, SquaredAlpha::default()).offset();
            assert!((back.u - u).abs() < 1e-4 * u.abs().max(1.0) && (back.v - v).abs() < 1e-4 * v.abs().max(1.0));
        }
    }
}
