//! The meshes of a document, for frames that ask how textures lie on them.

use serde_json::Value;

use super::settings::Settings;
use super::source::{Source, SourceError};
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
    /// Reads the buffers if the frame needs them.
    pub fn new(root: &'a Value, source: &Source<'_>, settings: &Settings) -> Result<Self, SourceError> {
        let count = root.get("buffers").and_then(Value::as_array).map_or(0, Vec::len);
        let read = || (0..count).map(|index| source.buffer(index)).collect::<Result<Vec<_>, _>>();
        let main_direction = match settings.frame {
            Frame::MainDirection(m) => m,
            Frame::Natural | Frame::Unit => [0.0, 1.0, 0.0],
        };
        let buffers = if settings.frame == Frame::Unit { None } else { Some(read()?) };
        Ok(Self { root, buffers, main_direction })
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
