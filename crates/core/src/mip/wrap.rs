//! Wrap modes and magnification filters of samplers.

/// The wrap mode of a sampler along one axis, named as in glTF.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Wrap {
    /// The map repeats: the neighbour of the last texel is the first texel.
    #[default]
    Repeat,
    /// The map is mirrored: the neighbour of the last texel is the last texel, so heights have a crest or trough at the
    /// seam.
    Mirror,
    /// Only texels inside count: the slope at the border is a one-sided difference.
    Clamp,
}

impl Wrap {
    /// Returns the texels before and after `i` on an axis of `size` texels, and their distance in texels.
    pub(crate) fn neighbours(self, i: u32, size: u32) -> (u32, u32, f32) {
        let last = size - 1;
        let before = i.checked_sub(1);
        let after = (i < last).then_some(i + 1);
        match self {
            Self::Repeat => (before.unwrap_or(last), after.unwrap_or(0), 2.0),
            Self::Mirror => (before.unwrap_or(0), after.unwrap_or(last), 2.0),
            Self::Clamp => {
                let (before, after) = (before.unwrap_or(i), after.unwrap_or(i));
                (before, after, ((after - before) as f32).max(1.0))
            }
        }
    }
}

/// How a sampler magnifies level 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Magnification {
    /// Linear between the centres of texels.
    #[default]
    Linear,
    /// The nearest texel.
    Nearest,
}

/// What a sampler does beyond the border of a map and between its texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Sampler {
    /// Wrap modes across and down.
    pub wrap: [Wrap; 2],
    /// How level 0 is magnified.
    pub magnification: Magnification,
}
