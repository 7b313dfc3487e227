//! The frame of a layer's offsets in the pyramid profile.

use super::geometry::Geometry;
use super::group::GroupLayer;
use super::offsets::size_of;
use crate::bump::{Frame, FrameTransform};
use crate::material::{BumpMap, FrameTransforms};
use crate::note::{self, Note};

/// Largest deviation of the tangent rotations of triangles that count as equal, root mean square, in radians: 6
/// degrees.
const MAX_ROTATION_DEVIATION: f32 = 0.1;

/// Returns the frame of the offsets of `layer` and the transforms to it. If the layer cannot have the `requested`
/// frame, it has the unit frame, and the note says why.
pub fn offset_frame(
    requested: Frame,
    geometry: &Geometry<'_>,
    bump_map: &BumpMap,
    layer: &GroupLayer,
) -> (Frame, FrameTransforms, Option<Note>) {
    match transforms(requested, geometry, bump_map, layer) {
        Ok(transforms) => (requested, transforms, None),
        Err(reason) => (Frame::Unit, FrameTransforms::IDENTITY, Some(reason)),
    }
}

fn transforms(
    requested: Frame,
    geometry: &Geometry<'_>,
    bump_map: &BumpMap,
    layer: &GroupLayer,
) -> Result<FrameTransforms, Note> {
    match (requested, layer.layout.as_ref()) {
        (Frame::Unit, _) => Ok(FrameTransforms::IDENTITY),
        (_, None) => Err(note::unknown_layout()),
        (Frame::Natural, Some(layout)) => {
            let [p_u, p_v] = layout.units_per_repeat;
            Ok(FrameTransforms::Uniform(FrameTransform::natural(p_u, p_v)))
        }
        (Frame::MainDirection(_), Some(layout)) if layout.rotation_deviation <= MAX_ROTATION_DEVIATION => {
            let [cos, sin] = layout.tangent_rotation;
            Ok(FrameTransforms::Uniform(FrameTransform::rotation(cos, sin)))
        }
        (Frame::MainDirection(_), Some(layout)) => {
            let (mapping, (width, height)) = (&layer.layer.bumps.texture().mapping, size_of(bump_map));
            match geometry.rotation_map(layer.material, mapping, [width, height]) {
                Some(map) if map.conflict <= MAX_ROTATION_DEVIATION => Ok(FrameTransforms::PerTexel(map)),
                map => {
                    let over_map = map.map_or(2.0, |map| map.conflict);
                    Err(note::conflicting_rotations(layout.rotation_deviation, over_map))
                }
            }
        }
    }
}
