//! A bump map: a normal map or a height map, read as rows of moments.

use crate::bump::{FrameTransform, HeightMap, HeightOffsets, Moments, NormalMap, NormalOffsets, Offset, Outliers};
use crate::gltf::rotation_map::RotationMap;
use crate::math::symmetric::Symmetric2;
use crate::mip::{TexelRows, Wrap};
use crate::simd::map_row;

/// A decoded normal or height map.
#[non_exhaustive]
pub enum BumpMap {
    /// Tangent-space normals.
    Normals(NormalMap),
    /// Heights.
    Heights {
        /// The map.
        map: HeightMap,
        /// Slope of a change of the height by 1 between neighbouring texels, across and down.
        slope_per_step: [f32; 2],
        /// The sampler's mode, across and down.
        wrap: [Wrap; 2],
    },
}

impl BumpMap {
    /// Returns the sampler's mode across and down. A normal map does not know its sampler and is taken to repeat.
    pub fn wrap(&self) -> [Wrap; 2] {
        match self {
            Self::Normals(_) => [Wrap::Repeat; 2],
            Self::Heights { wrap, .. } => *wrap,
        }
    }

    /// Writes the offsets (f_u, f_v) of row `y` to `out`.
    pub fn offsets(&self, y: u32, out: &mut [[f32; 2]]) {
        match self {
            Self::Normals(map) => NormalOffsets::new(map).offsets(y, out),
            Self::Heights { map, slope_per_step, wrap } => {
                HeightOffsets::new(map, *slope_per_step, *wrap).offsets(y, out);
            }
        }
    }

    /// Maps the offset of each texel of row `y`, with the number `beside` it, by `of`, and stores the results in `out`,
    /// as `simd::map_row` does.
    pub fn map_offsets<T, const M: usize>(
        &self,
        y: u32,
        beside: impl Iterator<Item = f32> + Clone,
        out: &mut [T],
        of: impl Fn(Offset, f32) -> [f32; M],
        store: impl Fn(&mut T, [f32; M]),
    ) {
        if let Self::Normals(map) = self {
            return NormalOffsets::new(map).map_offsets(y, beside, out, of, store);
        }
        let mut offsets = vec![[0.0; 2]; out.len()];
        self.offsets(y, &mut offsets);
        map_row(
            offsets.iter().zip(beside).map(|(&[u, v], beside)| [u, v, beside]),
            out,
            |[u, v, beside]| of(Offset { u, v }, beside),
            store,
        );
    }

    /// Counts the texels whose slope is not the one in the map.
    pub fn outliers(&self) -> Outliers {
        match self {
            Self::Normals(map) => NormalOffsets::new(map).outliers(),
            Self::Heights { map, slope_per_step, wrap } => HeightOffsets::new(map, *slope_per_step, *wrap).outliers(),
        }
    }

    /// Returns the covariance of slopes that rounding to the map's depth alone makes on a flat surface.
    pub fn noise(&self) -> Symmetric2 {
        match self {
            Self::Normals(map) => NormalOffsets::new(map).noise(),
            Self::Heights { map, slope_per_step, wrap } => HeightOffsets::new(map, *slope_per_step, *wrap).noise(),
        }
    }
}

impl TexelRows for BumpMap {
    type Texel = Moments;

    fn width(&self) -> u32 {
        match self {
            Self::Normals(map) => map.width(),
            Self::Heights { map, .. } => map.width(),
        }
    }

    fn height(&self) -> u32 {
        match self {
            Self::Normals(map) => map.height(),
            Self::Heights { map, .. } => map.height(),
        }
    }

    fn row(&self, y: u32, out: &mut [Moments]) {
        match self {
            Self::Normals(map) => NormalOffsets::new(map).row(y, out),
            Self::Heights { map, slope_per_step, wrap } => HeightOffsets::new(map, *slope_per_step, *wrap).row(y, out),
        }
    }
}

/// The transforms of offsets from the tangent frame to another frame.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameTransforms {
    /// One transform for all texels.
    Uniform(FrameTransform),
    /// A transform for each texel of the map.
    PerTexel(RotationMap),
}

impl FrameTransforms {
    /// Offsets stay in the tangent frame.
    pub const IDENTITY: Self = Self::Uniform(FrameTransform::IDENTITY);
}

/// A bump map in another frame.
pub struct Framed<'a> {
    /// The bump map in the tangent frame.
    pub bump_map: &'a BumpMap,
    /// The transforms to the other frame.
    pub transforms: &'a FrameTransforms,
}

impl TexelRows for Framed<'_> {
    type Texel = Moments;

    fn width(&self) -> u32 {
        self.bump_map.width()
    }

    fn height(&self) -> u32 {
        self.bump_map.height()
    }

    fn row(&self, y: u32, out: &mut [Moments]) {
        self.bump_map.row(y, out);
        match self.transforms {
            FrameTransforms::Uniform(transform) => out.iter_mut().for_each(|m| *m = transform.apply(*m)),
            FrameTransforms::PerTexel(map) => {
                let row = &map.transforms[y as usize * out.len()..][..out.len()];
                out.iter_mut().zip(row).for_each(|(m, transform)| *m = transform.apply(*m));
            }
        }
    }
}
