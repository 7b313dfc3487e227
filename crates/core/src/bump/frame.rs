//! The paper's three local frames ("The Local Coordinate System", 1 to 3).

use serde::{Deserialize, Serialize, Serializer};

use super::Offset;
use crate::bump::Moments;
use crate::math::symmetric::Symmetric2;

/// The frame of stored offsets. Provenance records it as a [`FrameKind`], or as the direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub enum Frame {
    /// Frame 1: offsets are df/du and df/dv in mesh units per repeat of the texture. The reader divides by |p_u| and
    /// |p_v|, so that bumps keep their height if the map is scaled.
    Natural,
    /// Frame 2: offsets are slopes along unit vectors: glTF's tangent frame. Bumps scale with the map.
    #[default]
    Unit,
    /// Frame 3: slopes along e1 = m x n / |m x n| and e2 = n x e1 for a main direction m, given in the space of the
    /// mesh. No tangents are needed at run time.
    MainDirection(#[serde(serialize_with = "in_double_precision")] [f32; 3]),
}

/// A [`Frame`] without its direction, under the name that the command line and `roughcast.toml` have for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum FrameKind {
    /// Offsets in mesh units per repeat: bumps keep their height when the map is scaled.
    Natural,
    /// Slopes in glTF's tangent frame.
    #[default]
    Unit,
    /// Slopes along e1 = m x n and e2 = n x e1: no tangents at run time.
    MainDirection,
}

impl Frame {
    /// Returns the kind of the frame.
    pub fn kind(self) -> FrameKind {
        match self {
            Self::Natural => FrameKind::Natural,
            Self::Unit => FrameKind::Unit,
            Self::MainDirection(_) => FrameKind::MainDirection,
        }
    }

    /// Returns the main direction m, which only [`Frame::MainDirection`] has.
    pub fn main_direction(self) -> Option<[f32; 3]> {
        match self {
            Self::Natural | Self::Unit => None,
            Self::MainDirection(m) => Some(m),
        }
    }
}

/// Writes a direction with the digits of double precision, as all numbers of recorded settings are written.
fn in_double_precision<S: Serializer>(direction: &[f32; 3], serializer: S) -> Result<S::Ok, S::Error> {
    direction.map(f64::from).serialize(serializer)
}

/// Transforms slopes in glTF's tangent frame to offsets in a [`Frame`], for one material: f' = M f, K' = M K M^T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTransform {
    /// Rows of M.
    pub matrix: [[f32; 2]; 2],
}

impl FrameTransform {
    /// M = 1: the tangent frame itself.
    pub const IDENTITY: Self = Self { matrix: [[1.0, 0.0], [0.0, 1.0]] };

    /// Returns the transform to a frame rotated against the tangent frame, in which T = `cos` e1 + `sin` e2.
    pub fn rotation(cos: f32, sin: f32) -> Self {
        Self { matrix: [[cos, -sin], [sin, cos]] }
    }

    /// Returns mean and covariance in the new frame.
    pub fn apply(&self, moments: Moments) -> Moments {
        let [[a, b], [c, d]] = self.matrix;
        let (mean, k) = (moments.mean, moments.covariance);
        Moments {
            mean: Offset { u: a * mean.u + b * mean.v, v: c * mean.u + d * mean.v },
            covariance: Symmetric2::new(
                a * a * k.uu + 2.0 * a * b * k.uv + b * b * k.vv,
                a * c * k.uu + (a * d + b * c) * k.uv + b * d * k.vv,
                c * c * k.uu + 2.0 * c * d * k.uv + d * d * k.vv,
            ),
        }
    }
}

#[cfg(test)]
mod tests;
