//! The meshes of a document, for frames that ask how textures lie on them.

use serde_json::Value;

use super::settings::Settings;
use super::source::Source;
use crate::bump::Frame;
use crate::gltf::geometry::{Layout, layout};
use crate::gltf::material::Mapping;
use crate::gltf::turn::{TurnMap, turn_map};

/// A document's meshes and the main direction asked for.
pub struct Geometry<'a> {
    root: &'a Value,
    /// None under the unit frame, which asks nothing of meshes.
    buffers: Option<Vec<Vec<u8>>>,
    main_direction: [f32; 3],
}

impl<'a> Geometry<'a> {
    /// Reads the buffers if the frame needs them. One without data, such as the fallback of compressed ones, is empty.
    pub fn new(root: &'a Value, source: &Source<'_>, settings: &Settings) -> Self {
        let count = root.get("buffers").and_then(Value::as_array).map_or(0, Vec::len);
        let read = || (0..count).map(|index| source.buffer(index).unwrap_or_default()).collect();
        let main_direction = match settings.frame {
            Frame::MainDirection(m) => m,
            Frame::Natural | Frame::Unit => [0.0, 1.0, 0.0],
        };
        let buffers = (settings.frame != Frame::Unit).then(read);
        Self { root, buffers, main_direction }
    }

    /// See [`layout`]; `None` under the unit frame.
    pub fn layout(&self, material: usize, mapping: &Mapping) -> Option<Layout> {
        let buffers = self.buffers.as_ref()?;
        layout(self.root, material, mapping, self.main_direction, &|i| buffers.get(i).map(Vec::as_slice))
    }

    /// See [`turn_map`]; `None` under the unit frame.
    pub fn turn_map(&self, material: usize, mapping: &Mapping, size: [u32; 2]) -> Option<TurnMap> {
        let buffers = self.buffers.as_ref()?;
        turn_map(self.root, material, mapping, self.main_direction, &|i| buffers.get(i).map(Vec::as_slice), size)
    }
}
