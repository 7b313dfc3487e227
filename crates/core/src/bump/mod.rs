//! Offsets (f_u, f_v): the slopes of the bumps, from normals or heights, in one of the paper's three local frames.
//!
//! In an orthonormal tangent frame, n' = N - f_u T - f_v B (paper, "The Local Coordinate System"). B points up in the
//! image, towards row 0, as in glTF. This module knows level 0 only, and no coarser mip levels.

mod frame;
mod height;
mod height_map;
mod moments;
mod normal;
mod normal_map;
mod shaped;

pub use height_map::HeightMap;
pub use normal_map::{NormalLayout, NormalMap};
pub use shaped::{Shaped, ShapedMoments};

pub use frame::{Frame, FrameKind, FrameTransform};
pub use height::HeightOffsets;
pub use moments::Moments;
pub(crate) use normal::slopes;
pub use normal::{NormalOffsets, normal_from_offset, offset_from_normal};

/// The steepest slope that is kept: 86.4 degrees. With steeper slopes, one texel of noise would dominate K of the whole
/// footprint. The squared alpha of this slope (2 * 16^2) is far above 1, the most that an engine can show.
pub const MAX_SLOPE: f32 = 16.0;

/// Slopes (rise over run) along T and B.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Offset {
    /// f_u: along the tangent, rightwards in the image.
    pub u: f32,
    /// f_v: along the bitangent, upwards in the image.
    pub v: f32,
}

/// Numbers of texels whose slopes were changed, because the map's slope cannot be used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outliers {
    /// Texels with slopes above [`MAX_SLOPE`] whose normals point above the surface.
    pub steep: u64,
    /// Texels whose normals point along the surface or below it.
    pub below: u64,
    /// Texels without a normal, which got those of the texels around them.
    pub unused: u64,
}

impl Outliers {
    fn plus(self, other: Self) -> Self {
        Self { steep: self.steep + other.steep, below: self.below + other.below, unused: self.unused + other.unused }
    }
}

impl Offset {
    /// Limits a slope to [`MAX_SLOPE`] and keeps its direction. Computes in f64, where no square of an f32 overflows.
    fn clamped(u: f64, v: f64) -> Self {
        let length = (u * u + v * v).sqrt();
        let scale = if length > f64::from(MAX_SLOPE) { f64::from(MAX_SLOPE) / length } else { 1.0 };
        Self { u: (u * scale) as f32, v: (v * scale) as f32 }
    }
}
