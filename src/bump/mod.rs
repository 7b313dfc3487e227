//! Offsets (f_u, f_v): the slopes of the bumps, from normals or heights, in one of the paper's three local frames.
//!
//! In an orthonormal tangent frame n' = N - f_u T - f_v B (paper, "The Local Coordinate System"). B points up the image,
//! towards row 0, as in glTF. This module knows nothing of mip levels beyond level 0.

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

pub use frame::{Frame, FrameTransform};
pub use height::HeightOffsets;
pub use moments::Moments;
pub(crate) use normal::slopes;
pub use normal::{NormalOffsets, normal_from_offset, offset_from_normal};

/// Steepest slope kept: 86.4 degrees. Beyond it one texel of noise would outweigh the whole footprint in K, and the
/// squared alpha that K stands for (2 * 16^2) is far above 1, the most that an engine can show.
pub const MAX_SLOPE: f32 = 16.0;

/// Slopes (rise over run) along T and B.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Offset {
    /// f_u: along the tangent, rightwards in the image.
    pub u: f32,
    /// f_v: along the bitangent, upwards in the image.
    pub v: f32,
}

/// Texels whose slope is not what the map says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outliers {
    /// Steeper than [`MAX_SLOPE`], above the surface.
    pub steep: u64,
    /// Normals that point along the surface or below it.
    pub below: u64,
}

impl Outliers {
    fn plus(self, other: Self) -> Self {
        Self { steep: self.steep + other.steep, below: self.below + other.below }
    }
}

impl Offset {
    /// The same direction, no steeper than [`MAX_SLOPE`]. In f64, where no square of an f32 overflows.
    fn clamped(u: f64, v: f64) -> Self {
        let length = (u * u + v * v).sqrt();
        let scale = if length > f64::from(MAX_SLOPE) { f64::from(MAX_SLOPE) / length } else { 1.0 };
        Self { u: (u * scale) as f32, v: (v * scale) as f32 }
    }
}
