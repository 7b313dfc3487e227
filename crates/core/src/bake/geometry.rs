//! The meshes of a document, for frames and views, which depend on how textures lie on meshes.

use super::reader::Reader;
use crate::bump::Frame;
use crate::gltf::geometry::{Layout, layout};
use crate::gltf::material::Mapping;
use crate::gltf::meshes::Meshes;
use crate::gltf::rotation_map::{RotationMap, rotation_map};
use crate::gltf::scene::{BadNode, Placement, placements};
use crate::gltf::texel_size::{NoDensity, density};
use crate::mip::level_sizes;
use crate::settings::{Finest, Settings, View};

/// A document's meshes, as far as the settings need them.
pub struct Geometry<'a> {
    reader: &'a Reader<'a>,
    /// None if neither the frame nor the view depends on meshes.
    meshes: Option<Meshes<'a>>,
    has_frame: bool,
    main_direction: [f32; 3],
    view: Option<View>,
    placements: Result<Vec<Placement>, BadNode>,
}

impl<'a> Geometry<'a> {
    /// Finds the meshes if `settings` need them.
    pub fn new(reader: &'a Reader<'a>, settings: &Settings) -> Self {
        let main_direction = match settings.frame {
            Frame::MainDirection(m) => m,
            Frame::Natural | Frame::Unit => [0.0, 1.0, 0.0],
        };
        let view = settings.view;
        let meshes = Self::is_needed(settings).then(|| Meshes::of(reader.root));
        let placements = if view.is_some() { placements(reader.root) } else { Ok(Vec::new()) };
        Self { reader, meshes, has_frame: settings.frame != Frame::Unit, main_direction, view, placements }
    }

    /// Returns whether the bake needs meshes, and with them all buffers.
    pub fn is_needed(settings: &Settings) -> bool {
        settings.frame != Frame::Unit || settings.view.is_some()
    }

    /// Returns the [`layout`] of a texture on its meshes; `None` under the unit frame.
    pub fn layout(&self, material: usize, mapping: &Mapping) -> Option<Layout> {
        let meshes = self.meshes.as_ref().filter(|_| self.has_frame)?;
        layout(meshes, material, mapping, self.main_direction, &|i| self.reader.buffer(i).ok())
    }

    /// Returns the extension that compresses the meshes of a material, if the settings need meshes.
    pub fn compression(&self, material: usize) -> Option<&'static str> {
        self.meshes.as_ref()?.compression(material)
    }

    /// Returns the [`rotation_map`] of a texture on its meshes; `None` under the unit frame.
    pub fn rotation_map(&self, material: usize, mapping: &Mapping, size: [u32; 2]) -> Option<RotationMap> {
        let meshes = self.meshes.as_ref().filter(|_| self.has_frame)?;
        rotation_map(meshes, material, mapping, self.main_direction, &|i| self.reader.buffer(i).ok(), size)
    }

    /// Returns the finest level that the view can sample of a map of `size`; `None` without a view. [`density`]
    /// describes why the level may not be known.
    pub fn finest(&self, material: usize, mapping: &Mapping, size: (u32, u32)) -> Option<Result<Finest, NoDensity>> {
        let (view, meshes) = (self.view.as_ref()?, self.meshes.as_ref()?);
        let measure = |placements: &Vec<Placement>| {
            let buffer = |i: usize| self.reader.buffer(i).ok();
            density(meshes, placements, material, mapping, size, &buffer)
        };
        let density = self.placements.as_ref().map_err(|bad| NoDensity::from(*bad)).and_then(measure);
        Some(density.map(|density| view.finest(density, level_sizes(size.0, size.1).len())))
    }
}
