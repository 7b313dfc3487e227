//! The meshes of a document, for frames and views that ask how textures lie on them.

use serde_json::Value;

use super::settings::Settings;
use super::source::{Source, SourceError};
use super::view::{Finest, View};
use crate::bump::Frame;
use crate::gltf::density::{NoDensity, density};
use crate::gltf::geometry::{Layout, layout};
use crate::gltf::material::Mapping;
use crate::gltf::scene::{BadNode, Placement, placements};
use crate::gltf::turn::{TurnMap, turn_map};
use crate::pyramid::level_sizes;

/// A document's meshes and what is asked of them.
pub struct Geometry<'a> {
    root: &'a Value,
    /// None where neither frame nor view asks anything of meshes.
    buffers: Option<Vec<Vec<u8>>>,
    has_frame: bool,
    main_direction: [f32; 3],
    view: Option<View>,
    placements: Result<Vec<Placement>, BadNode>,
}

impl<'a> Geometry<'a> {
    /// Reads the buffers if they are needed. One without data, such as the fallback of compressed ones, is empty.
    ///
    /// # Errors
    /// Why a buffer with data cannot be read: without it the bake would be another one.
    pub fn new(root: &'a Value, source: &Source<'_>, settings: &Settings) -> Result<Self, SourceError> {
        let count = root.get("buffers").and_then(Value::as_array).map_or(0, Vec::len);
        let read = |index| match source.buffer(index) {
            Err(SourceError::NoBuffer { .. }) => Ok(Vec::new()),
            read => read,
        };
        let main_direction = match settings.frame {
            Frame::MainDirection(m) => m,
            Frame::Natural | Frame::Unit => [0.0, 1.0, 0.0],
        };
        let (has_frame, view) = (settings.frame != Frame::Unit, settings.view);
        let buffers = (has_frame || view.is_some()).then(|| (0..count).map(read).collect()).transpose()?;
        let placements = if view.is_some() { placements(root) } else { Ok(Vec::new()) };
        Ok(Self { root, buffers, has_frame, main_direction, view, placements })
    }

    /// See [`layout`]; `None` under the unit frame.
    pub fn layout(&self, material: usize, mapping: &Mapping) -> Option<Layout> {
        let buffers = self.buffers.as_ref().filter(|_| self.has_frame)?;
        layout(self.root, material, mapping, self.main_direction, &|i| buffers.get(i).map(Vec::as_slice))
    }

    /// See [`turn_map`]; `None` under the unit frame.
    pub fn turn_map(&self, material: usize, mapping: &Mapping, size: [u32; 2]) -> Option<TurnMap> {
        let buffers = self.buffers.as_ref().filter(|_| self.has_frame)?;
        turn_map(self.root, material, mapping, self.main_direction, &|i| buffers.get(i).map(Vec::as_slice), size)
    }

    /// The finest level that the view can sample of a map of `size`; `None` without a view. See [`density`] for why it
    /// may not be known.
    pub fn finest(&self, material: usize, mapping: &Mapping, size: (u32, u32)) -> Option<Result<Finest, NoDensity>> {
        let (view, buffers) = (self.view.as_ref()?, self.buffers.as_ref()?);
        let measure = |placements: &Vec<Placement>| {
            let buffer = |i: usize| buffers.get(i).map(Vec::as_slice);
            density(self.root, placements, material, mapping, size, &buffer)
        };
        let density = self.placements.as_ref().map_err(|bad| NoDensity::from(*bad)).and_then(measure);
        Some(density.map(|density| view.finest(density, level_sizes(size.0, size.1).len())))
    }
}
