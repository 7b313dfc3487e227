//! The paper's three local frames ("The Local Coordinate System", 1 to 3).

use super::Offset;
use crate::bump::Moments;
use crate::math::symmetric::Symmetric2;

/// The frame of stored offsets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Frame {
    /// Frame 1: offsets are df/du and df/dv in mesh units per repeat of the texture. The reader divides by |p_u| and
    /// |p_v|, so that bumps keep their height if the map is scaled.
    Natural,
    /// Frame 2: offsets are slopes along unit vectors: glTF's tangent frame. Bumps scale with the map.
    #[default]
    Unit,
    /// Frame 3: slopes along e1 = m x n / |m x n| and e2 = n x e1 for a main direction m, given in the space of the
    /// mesh. No tangents are needed at run time.
    MainDirection([f32; 3]),
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

    /// Returns the transform to the natural frame of a surface with |p_u| and |p_v| mesh units per repeat.
    pub fn natural(p_u: f32, p_v: f32) -> Self {
        Self { matrix: [[p_u, 0.0], [0.0, p_v]] }
    }

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
