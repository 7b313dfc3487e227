//! What samplers return beyond the border of a map.

/// What a sampler returns beyond the border, along one axis; named as in glTF.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Wrap {
    /// The map again: the neighbour of the last texel is the first.
    #[default]
    Repeat,
    /// The map mirrored: the neighbour of the last texel is itself, so heights have a crest or trough at the seam.
    Mirror,
    /// Nothing new: only texels inside count, so the slope at the border is a one-sided difference.
    Clamp,
}

impl Wrap {
    /// The texels before and after `i` on an axis of `size` texels, and their distance in texels.
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
