//! The parameters of `KHR_materials_anisotropy`.

use super::{Alpha, Roughness, SquaredAlpha};
use crate::math::symmetric::Symmetric2;

/// A lobe as glTF describes it: alpha_b = roughness^2 across the direction, alpha_t = mix(alpha_b, 1, strength^2)
/// along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// Roughness across the direction.
    pub roughness: Roughness,
    /// 0 is isotropic, 1 stretches alpha to 1; in [0, 1].
    pub strength: f32,
    /// Unit vector in (T, B) along which the lobe is stretched, defined up to its sign.
    pub direction: [f32; 2],
}

impl Anisotropy {
    /// Returns the lobe's matrix: alpha_t^2 along the direction, alpha_b^2 across it.
    pub fn squared_alpha(self) -> SquaredAlpha {
        let Alpha(across) = self.roughness.into();
        let along = across + (1.0 - across) * self.strength * self.strength;
        SquaredAlpha(Symmetric2::from_axes(along * along, across * across, self.direction))
    }

    /// Returns the parameters of a lobe. Alphas above 1 become 1.
    ///
    /// `reference` is a unit vector. The sign of the direction is chosen to agree with `reference`, because samplers
    /// average vectors and not axes. Directions of nearly isotropic lobes are pulled towards `reference`, so that their
    /// noise does not disturb neighbouring texels in the filter.
    #[inline(always)]
    pub fn of(a: SquaredAlpha, reference: [f32; 2]) -> Self {
        let e = a.0.eigen();
        let across = e.minor.sqrt().min(1.0);
        let along = e.major.max(0.0).sqrt().min(1.0);
        let strength = if across < 1.0 { ((along - across) / (1.0 - across)).sqrt() } else { 0.0 };
        /// Strength of the pull, relative to the trace. A lobe of axis ratio 1.02 is rotated halfway, and a lobe of
        /// axis ratio 1.5 by less than 2 degrees.
        const LEAN: f32 = 0.01;
        let leaning = a.0 + (LEAN * a.0.trace()) * Symmetric2::outer(reference);
        let [x, y] = leaning.eigen().axis;
        let sign = if x * reference[0] + y * reference[1] < 0.0 { -1.0 } else { 1.0 };
        Self { roughness: Alpha(across).into(), strength, direction: [x * sign, y * sign] }
    }
}
