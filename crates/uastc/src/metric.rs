//! Settings of the encoder.

/// How hard the encoder searches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Effort {
    /// Estimates errors from the covariance of the colours and fits only the modes that can win. The quality is about
    /// that of level 1 of basis_universal.
    Fast,
    /// Fits all modes that pay and refines the winner. The quality is about that of level 2 of basis_universal, and
    /// better by [`Metric::Direction`].
    Best,
}

impl Effort {
    /// Returns the name, which is that of the value in configuration files too.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Best => "best",
        }
    }
}

/// How errors are measured. The encoder minimises the sum of the errors over the texels of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Metric {
    /// Squared differences of red, green and blue, in levels of 0 to 255.
    Rgb,
    /// Squared differences of red, green, blue and alpha, in levels of 0 to 255.
    ///
    /// This is the only metric that stores alpha: for all others alpha is ignored and decodes as 255. Blocks whose
    /// texels are all opaque are those of [`Metric::Rgb`].
    Rgba,
    /// Squared differences of red, green and blue, each difference multiplied by its channel's weight first.
    ///
    /// Use this metric for textures whose channels hold unrelated quantities of different importance. At least one
    /// channel should have full weight, because the thresholds of the search are tuned for full weights.
    Weighted([Weight; 3]),
    /// Squared distances between directions, for normal maps. A texel encodes the vector 2 rgb / 255 - 1.
    ///
    /// Decoded vectors stay close to unit length (within 0.015 in the mean over a level of unit normals). Renderers
    /// that rebuild z from x and y therefore see the same normal as renderers that normalise.
    ///
    /// If the texels have lobes ([`Image::with_lobes`](crate::Image::with_lobes)), the error of a texel is the total
    /// variation between two GGX lobes of its squared alphas, about the wanted and about the decoded normal. The
    /// distance between the lobes also has the part that keeps lengths. Total variation is at most 1, so texels whose
    /// lobes miss anyway no longer pull the endpoints.
    Direction,
}

/// The factor of differences in one channel. All factors are powers of two, which keeps sums of differences exact.
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
    /// Returns the factors of differences in red, green and blue.
    pub(crate) fn scale(self) -> [f32; 3] {
        match self {
            Self::Weighted(weights) => weights.map(Weight::factor),
            Self::Rgb | Self::Rgba | Self::Direction => [1.0; 3],
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
