//! The correction factor c: the roughness that a lobe should have is c K, not K.

/// The shape that the offsets in a footprint are taken to have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Distribution {
    /// A 2-D normal distribution.
    #[default]
    Normal,
    /// Uniform in a rectangle: the case that the paper names.
    Uniform,
}

impl Distribution {
    /// c for a GGX lobe twice as wide as the bumps' deviation or narrower, where it matters. A lobe with GGX's tails
    /// that matched a normal distribution's variance would be too wide; a rectangle has no tails to lose. Values: least
    /// lobe error over c in steps of 0.05 (test `lobe::tests::the_correction_factor_is_the_best`).
    pub fn correction(self) -> f32 {
        match self {
            Self::Normal => 0.9,
            Self::Uniform => 1.0,
        }
    }
}
