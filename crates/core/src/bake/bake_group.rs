//! Steps 3 to 8 of one group of layers: its images, then [`bake_bump_map`], then what becomes of its layers.

use std::borrow::Cow;
use std::sync::Arc;

use super::bake_bump_map::bake_bump_map;
use super::decode::{BaseImages, Images};
use super::error::BakeError;
use super::frame::{OffsetFrame, offset_frame};
use super::geometry::Geometry;
use super::group::{BumpMapGroup, GroupLayer};
use super::group_output::GroupOutput;
use super::lobes::{AnisotropyInput, BaseInput, LayerInput, PreparedBase};
use super::offsets::MapOffsets;
use super::pyramid::PyramidInput;
use super::reader::Reader;
use super::reflectance::ReflectanceInput;
use crate::gltf::texel_size::NoDensity;
use crate::material::{first_within, notes};
use crate::note::{self, Note, Unread};
use crate::settings::{Finest, Settings};

/// Bakes `group`.
///
/// # Errors
/// [`BakeError`] for the first image that cannot be baked.
pub fn bake_group(
    group: &BumpMapGroup,
    reader: &Reader<'_>,
    geometry: &Geometry<'_>,
    settings: &Settings,
) -> Result<GroupOutput, BakeError> {
    let bake = GroupBake { group, images: Images::new(reader, settings.max_texels), settings, geometry };
    let lobe_groups = group.lobe_groups();
    let only = if let [users] = &*lobe_groups { Some(users) } else { None };
    // Decoders have one thread each, and the bump map takes the longest.
    let prepare = || only.map(|users| bake.prepared(users)).transpose();
    let (bump_map, only_base) = rayon::join(|| bake.images.bump_map(group), prepare);
    let ((bump_map, mut map_notes), only_base) = (bump_map?, only_base?);
    let map = MapOffsets::new(&bump_map, settings, group.source.sampling())?;
    let map = if group.may_scale_normals { map.scaling_normals() } else { map };
    map_notes.extend(notes::of_bump_map(&bump_map, map.bumps.size()));
    let lobe_groups = if only_base.is_some() { lobe_groups } else { bake.narrowest_first(lobe_groups, &map)? };
    let first = bake.first_level(&group.layers, map.bumps.size());
    let mut products = bake_bump_map(&map, first, bake.inputs(&map, &lobe_groups, only_base), || {
        bake.pyramid_inputs(&map, &lobe_groups)
    })?;
    // The order of the document, so that names of textures do not depend on the widths of lobes.
    let mut placed: Vec<_> = products.layers.into_iter().zip(lobe_groups).collect();
    placed.sort_by_key(|(_, users)| users[0]);
    let lobe_groups: Vec<Vec<usize>>;
    (products.layers, lobe_groups) = placed.into_iter().unzip();
    let notes = |layer: &GroupLayer| bake.notes(layer, &map_notes, map.bumps.size());
    let output = GroupOutput::new(group, &bake.images, settings, products, &lobe_groups, notes);
    drop(map);
    // The system takes memory back page by page, for 10 ms after 4096 x 4096: files are made meanwhile.
    rayon::spawn(|| drop(bump_map));
    Ok(output)
}

/// A group on its way through the steps.
struct GroupBake<'a> {
    group: &'a BumpMapGroup,
    images: Images<'a>,
    settings: &'a Settings,
    geometry: &'a Geometry<'a>,
}

impl GroupBake<'_> {
    /// Decodes the base lobe of the layers `users` and builds its levels.
    fn prepared(&self, users: &[usize]) -> Result<PreparedBase<'static>, BakeError> {
        Ok(self.base(&self.group.layers[users[0]])?.with_levels(self.settings)?)
    }

    /// Sorts `lobe_groups` so that the base lobe comes first that is narrowest beside its bumps: it decides the
    /// directions for all, and an error of a direction counts by its ratio to the width of the lobe. Lobes that cannot
    /// decide come last, and before them those that are not seen. Each image is dropped again, since together they may
    /// be large.
    fn narrowest_first(
        &self,
        lobe_groups: Vec<Vec<usize>>,
        map: &MapOffsets<'_>,
    ) -> Result<Vec<Vec<usize>>, BakeError> {
        let mut keyed = Vec::with_capacity(lobe_groups.len());
        for users in lobe_groups {
            let layer = &self.group.layers[users[0]];
            let input = self.input(layer, self.images.base(layer)?, None);
            let size = input.grid(self.settings, Some(map.bump_map))?;
            let can_decide = layer.base.is_ok() && map.can_be_decided_by(size, layer.slope_scale);
            let is_seen = users.iter().any(|user| self.group.layers[*user].layer.is_seen);
            let width = input.mean_alpha() / f64::from(layer.slope_scale.abs());
            keyed.push((!can_decide, !is_seen, width, users));
        }
        keyed.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
        Ok(keyed.into_iter().map(|(.., users)| users).collect())
    }

    /// Decodes the base lobe of `layer` and its reflectance.
    fn base(&self, layer: &GroupLayer) -> Result<PreparedBase<'static>, BakeError> {
        let images = self.images.base(layer)?;
        let (reflectance, note) = ReflectanceInput::new(&self.images, layer, images.roughness.as_ref())?;
        Ok(PreparedBase { input: self.input(layer, images, reflectance), levels: None, note })
    }

    /// Returns the base lobe of `layer`, whose `images` are decoded.
    fn input(
        &self,
        layer: &GroupLayer,
        images: BaseImages,
        reflectance: Option<ReflectanceInput>,
    ) -> BaseInput<'static> {
        let BaseImages { roughness, anisotropy } = images;
        BaseInput {
            roughness: roughness.map(Cow::Owned),
            roughness_factor: layer.layer.roughness_factor,
            anisotropy: layer.anisotropy.as_ref().map(|source| AnisotropyInput {
                texture: anisotropy,
                strength: source.strength,
                rotation: source.rotation,
            }),
            reflectance,
            wrap: self.group.source.wrap,
        }
    }

    /// Returns the inputs of all lobes. Images are decoded when the iterator reaches them, unless there is one lobe
    /// only, whose base is `only_base`.
    fn inputs<'i>(
        &'i self,
        map: &'i MapOffsets<'_>,
        lobe_groups: &'i [Vec<usize>],
        mut only_base: Option<PreparedBase<'static>>,
    ) -> impl ExactSizeIterator<Item = Result<LayerInput<'static>, BakeError>> + 'i {
        lobe_groups.iter().map(move |users| {
            let layer = &self.group.layers[users[0]];
            let base = match only_base.take() {
                Some(base) => base,
                None => self.base(layer)?,
            };
            let size = base.input.grid(self.settings, Some(map.bump_map))?;
            let users = || users.iter().map(|user| &self.group.layers[*user]);
            Ok(LayerInput {
                base,
                size,
                can_be_roughened: layer.base.is_ok(),
                keeps_core_lobe: layer.keeps_core_lobe,
                slope_scale: layer.slope_scale,
                is_in_pyramid: layer.row().is_in_pyramid,
                max_model: layer.max_model().min(self.settings.model_limit()),
                finest: self.finest_level(users(), size),
                first: self.first_level(users(), size),
            })
        })
    }

    /// Returns the inputs of the pyramid profile: all layers that its extension describes.
    fn pyramid_inputs(&self, map: &MapOffsets<'_>, lobe_groups: &[Vec<usize>]) -> Vec<PyramidInput> {
        let layers = self.group.layers.iter().enumerate().filter(|(_, layer)| layer.row().is_in_pyramid);
        let input = |(index, layer): (usize, &GroupLayer)| {
            let lobes = lobe_groups.iter().position(|users| users.contains(&index)).unwrap_or(0);
            let frame = offset_frame(self.settings.frame, self.geometry, map.bump_map, layer);
            let OffsetFrame { frame, transforms, scale, note } = frame;
            PyramidInput { lobes, frame, transforms: Arc::new(transforms), scale, note }
        };
        layers.map(input).collect()
    }

    /// Returns the finest level that the view can sample of a map of `size` on `layer`; `None` without a view.
    fn finest(&self, layer: &GroupLayer, size: (u32, u32)) -> Option<Result<Finest, NoDensity>> {
        self.geometry.finest(layer.material, &layer.layer.bumps.texture().mapping, size)
    }

    /// Returns the finest level that is sampled of a map of `size` on any of `layers`: the view cannot sample finer
    /// levels, or they are larger than textures may be.
    fn finest_level<'l>(&self, layers: impl IntoIterator<Item = &'l GroupLayer>, size: (u32, u32)) -> usize {
        let level = |layer: &GroupLayer| self.finest(layer, size).and_then(Result::ok).map_or(0, |finest| finest.level);
        layers.into_iter().map(level).min().unwrap_or(0).max(first_within(self.settings, size))
    }

    /// Returns the finest level that is written of such a map.
    fn first_level<'l>(&self, layers: impl IntoIterator<Item = &'l GroupLayer>, size: (u32, u32)) -> usize {
        if self.settings.view.is_some_and(|view| view.trim) {
            self.finest_level(layers, size)
        } else {
            first_within(self.settings, size)
        }
    }

    /// Returns the finest level that the view can sample of `layer`, and the notes that are known before any lobe is
    /// made. `size` is the grid of the bump map.
    fn notes(&self, layer: &GroupLayer, map_notes: &[Note], size: (u32, u32)) -> (Option<Finest>, Vec<Note>) {
        let mut notes = layer.notes.clone();
        if !self.group.source.samples_mips {
            notes.push(note::sampler_without_mips());
        }
        notes.extend_from_slice(map_notes);
        match self.finest(layer, size) {
            None => (None, notes),
            Some(Ok(finest)) => (Some(finest), notes),
            Some(Err(NoDensity::Compressed(extension))) => {
                notes.push(note::compressed_mesh(extension, Unread::TexelSize));
                (None, notes)
            }
            Some(Err(reason)) => {
                notes.push(note::unknown_texel_size(&reason));
                (None, notes)
            }
        }
    }
}
