//! What the encoder is asked for.

/// How hard the encoder searches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Effort {
    /// Estimates errors from the covariance of the colours and fits only the modes that can win: about as near to the
    /// source as level 1 of basis_universal.
    Fast,
    /// Fits all modes that pay and refines the winner: about as near as level 2 of basis_universal, and nearer by
    /// direction.
    Best,
}

/// What an error costs: the encoder minimises the sum of these costs over the texels of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Metric {
    /// Squared differences of red, green and blue, in levels of 0 to 255.
    Rgb,
    /// Squared differences of red, green and blue, each difference multiplied by its channel's weight first.
    ///
    /// For textures whose channels hold unrelated quantities that are not equally important. At least one channel
    /// should have full weight: the thresholds of the search are tuned for that.
    Weighted([Weight; 3]),
    /// Squared distances between directions, where a texel stands for the vector 2 rgb / 255 - 1: a normal map.
    ///
    /// Decoded vectors stay close to unit length (within 0.015 in the mean over a level of unit normals), so that
    /// renderers which rebuild z from x and y see the same normal as those which normalise.
    Direction,
}

/// What a difference in one channel counts for. Powers of two keep sums of differences exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Weight {
    /// 1.
    Full,
    /// 1/2, hence a quarter of the squared error.
    Half,
    /// 1/4, hence a sixteenth of the squared error.
    Quarter,
}

impl Metric {
    /// Returns what a difference of one level counts for in red, green and blue.
    pub(crate) fn scale(self) -> [f32; 3] {
        match self {
            Self::Weighted(weights) => weights.map(Weight::factor),
            Self::Rgb | Self::Direction => [1.0; 3],
        }
    }
}

impl Weight {
    fn factor(self) -> f32 {
        match self {
            Self::Full => 1.0,
            Self::Half => 0.5,
            Self::Quarter => 0.25,
        }
    }
}
