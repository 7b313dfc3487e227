//! A lobe about a normal of its own.

use super::SquaredAlpha;
use crate::bump::{Offset, normal_from_offset};
use crate::symmetric::Symmetric2;

/// A lobe about a unit normal: what one texel of a level reflects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OrientedLobe {
    /// Unit normal in (T, B, N), with z > 0.
    pub normal: [f32; 3],
    /// Squared alphas in the [`frame`] of the normal.
    pub squared_alpha: SquaredAlpha,
}

impl OrientedLobe {
    /// A lobe about the normal of `offset`.
    pub fn new(offset: Offset, squared_alpha: SquaredAlpha) -> Self {
        Self { normal: normal_from_offset(offset), squared_alpha }
    }

    /// (f_u, f_v) of the normal.
    pub fn offset(&self) -> Offset {
        let [x, y, z] = self.normal;
        Offset { u: -x / z, v: -y / z }
    }

    /// The lobe that stands in best for this one where the normal is given: wider by what the normals differ.
    ///
    /// Of all widened GGX lobes A + 2 d d^T, d the slope from the one normal to the other, is within 1 % of the least
    /// lobe error for distances up to three alphas (test `a_displaced_lobe_wants_its_displacement_squared`).
    pub fn about(&self, normal: [f32; 3]) -> SquaredAlpha {
        let [t, b, n] = frame(normal);
        let z = dot(self.normal, n).max(LEAST_COSINE);
        let d = [dot(self.normal, t) / z, dot(self.normal, b) / z];
        SquaredAlpha(self.squared_alpha.0 + 2.0 * Symmetric2::outer(d))
    }
}

/// Slopes from a normal are counted to 87 degrees: what lies beyond is as good as behind the surface.
pub(super) const LEAST_COSINE: f32 = 0.05;

/// The orthonormal frame of a unit normal: T made perpendicular to it, then B = N x T, as glTF's engines do.
pub(super) fn frame(n: [f32; 3]) -> [[f32; 3]; 3] {
    // Not 0: normals lean less than 90 degrees.
    let scale = 1.0 / (1.0 - n[0] * n[0]).max(f32::MIN_POSITIVE).sqrt();
    let t = [(1.0 - n[0] * n[0]) * scale, -n[0] * n[1] * scale, -n[0] * n[2] * scale];
    [t, [n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]], n]
}

#[inline]
pub(super) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::{Family, Footprint, Lobe, Part, Reference};

    #[test]
    fn offsets_survive() {
        for (u, v) in [(0.0, 0.0), (0.5, -2.0), (-15.0, 3.0)] {
            let back = OrientedLobe::new(Offset { u, v }, SquaredAlpha::default()).offset();
            assert!((back.u - u).abs() < 1e-4 * u.abs().max(1.0) && (back.v - v).abs() < 1e-4 * v.abs().max(1.0));
        }
    }

    #[test]
    fn a_lobe_about_its_own_normal_is_itself() {
        let lobe = OrientedLobe::new(Offset { u: 0.4, v: -0.1 }, SquaredAlpha(Symmetric2::new(0.2, 0.05, 0.1)));
        let about = lobe.about(lobe.normal).0;
        assert!((about.uu - 0.2).abs() < 1e-6 && (about.uv - 0.05).abs() < 1e-6 && (about.vv - 0.1).abs() < 1e-6);
    }

    /// About another normal, no multiple of the squared displacement in steps of 0.1 is better by more than 1 %.
    #[test]
    fn a_displaced_lobe_wants_its_displacement_squared() {
        let alpha = 0.05;
        for alphas in [0.5, 1.0, 2.0, 3.0] {
            let slope = alphas * alpha;
            let own = [alpha * alpha, 0.0, alpha * alpha];
            let part = Part { weight: 1.0, normal: [-slope, 0.0, 1.0], base: own };
            let reference = Reference::new(Family::Ggx, &Footprint::new(vec![part]).unwrap(), 4096);
            let error = |c: f64| {
                let a = [own[0] + 2.0 * c * slope * slope, 0.0, own[2]];
                reference.error(&Lobe::new(Family::Ggx, [0.0, 0.0, 1.0], a))
            };
            let best = (5..20).map(|c| error(0.1 * f64::from(c))).fold(f64::INFINITY, f64::min);
            assert!(error(1.0) <= 1.01 * best, "{alphas} alphas: {} against {best}", error(1.0));
        }
    }
}
