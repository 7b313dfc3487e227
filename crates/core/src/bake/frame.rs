//! The frame of a layer's offsets in the pyramid profile.

use super::geometry::Geometry;
use super::group::GroupLayer;
use super::offsets::size_of;
use crate::bump::{Frame, FrameTransform};
use crate::material::{BumpMap, FrameTransforms};
use crate::note::{self, Note, Unread};

/// Largest deviation of the tangent rotations of triangles that count as equal, root mean square, in radians: 6
/// degrees.
const MAX_ROTATION_DEVIATION: f32 = 0.1;

/// The frame of the offsets of a layer.
pub struct OffsetFrame {
    /// The frame.
    pub frame: Frame,
    /// The transforms to the frame, up to its scale.
    pub transforms: FrameTransforms,
    /// The scale of the frame: what multiplies slopes along its two axes.
    pub scale: [f32; 2],
    /// Why the frame is not the requested one.
    pub note: Option<Note>,
}

impl OffsetFrame {
    fn new(frame: Frame, transforms: FrameTransforms) -> Self {
        Self { frame, transforms, scale: [1.0; 2], note: None }
    }
}

/// Returns the frame of the offsets of `layer`. If the layer cannot have the `requested` frame, it has the unit frame,
/// and the note says why.
pub fn offset_frame(requested: Frame, geometry: &Geometry<'_>, bump_map: &BumpMap, layer: &GroupLayer) -> OffsetFrame {
    requested_frame(requested, geometry, bump_map, layer).unwrap_or_else(|reason| OffsetFrame {
        note: Some(reason),
        ..OffsetFrame::new(Frame::Unit, FrameTransforms::IDENTITY)
    })
}

fn requested_frame(
    requested: Frame,
    geometry: &Geometry<'_>,
    bump_map: &BumpMap,
    layer: &GroupLayer,
) -> Result<OffsetFrame, Note> {
    let transforms = match (requested, layer.layout.as_ref()) {
        (Frame::Unit, _) => FrameTransforms::IDENTITY,
        (_, None) => {
            let compressed = |extension| note::compressed_mesh(extension, Unread::Layout);
            return Err(geometry.compression(layer.material).map_or_else(note::unknown_layout, compressed));
        }
        (Frame::Natural, Some(layout)) => {
            let frame = OffsetFrame::new(requested, FrameTransforms::IDENTITY);
            return Ok(OffsetFrame { scale: layout.units_per_repeat, ..frame });
        }
        (Frame::MainDirection(_), Some(layout)) if layout.rotation_deviation <= MAX_ROTATION_DEVIATION => {
            let [cos, sin] = layout.tangent_rotation;
            FrameTransforms::Uniform(FrameTransform::rotation(cos, sin))
        }
        (Frame::MainDirection(_), Some(layout)) => {
            let (mapping, (width, height)) = (&layer.layer.bumps.texture().mapping, size_of(bump_map));
            match geometry.rotation_map(layer.material, mapping, [width, height]) {
                Some(map) if map.conflict <= MAX_ROTATION_DEVIATION => FrameTransforms::PerTexel(map),
                map => {
                    let over_map = map.map_or(2.0, |map| map.conflict);
                    return Err(note::conflicting_rotations(layout.rotation_deviation, over_map));
                }
            }
        }
    };
    Ok(OffsetFrame::new(requested, transforms))
}
