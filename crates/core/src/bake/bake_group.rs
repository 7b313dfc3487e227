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
use super::lobes::{AnisotropyInput, BaseInput, LayerInput, PreparedBase, mean_alpha};
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
    // Decoders have one thread each, and the bump map takes the longest.
    let (bump_map, lobes) = rayon::join(|| bake.images.bump_map(group), || bake.lobe_groups());
    let ((bump_map, mut map_notes), (lobe_groups, first_base)) = (bump_map?, lobes?);
    let map = MapOffsets::new(&bump_map, settings, group.source.sampling())?;
    let map = if group.may_scale_normals { map.scaling_normals() } else { map };
    map_notes.extend(notes::of_bump_map(&bump_map, map.bumps.size()));
    let first = bake.first_level(&group.layers, map.bumps.size());
    let products = bake_bump_map(&map, first, bake.inputs(&map, &lobe_groups, first_base), || {
        bake.pyramid_inputs(&map, &lobe_groups)
    })?;
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
    /// Groups the layers by lobe, in the order in which they are baked. Returns also the base lobe of the first group,
    /// with its levels.
    fn lobe_groups(&self) -> Result<(Vec<Vec<usize>>, Option<PreparedBase<'static>>), BakeError> {
        let mut lobe_groups = self.group.lobe_groups();
        if lobe_groups.len() > 1 {
            lobe_groups = self.narrowest_first(lobe_groups)?;
        }
        let Some(users) = lobe_groups.first() else { return Ok((lobe_groups, None)) };
        let base = self.base(&self.group.layers[users[0]])?.with_levels(self.settings)?;
        Ok((lobe_groups, Some(base)))
    }

    /// Sorts `lobe_groups` so that the base lobe comes first that is narrowest beside its bumps: it decides the
    /// directions for all, and an error of a direction counts by its ratio to the width of the lobe. Lobes that cannot
    /// decide come last, and before them those that are not seen. The images of roughness are dropped again, since
    /// together they may be large.
    fn narrowest_first(&self, lobe_groups: Vec<Vec<usize>>) -> Result<Vec<Vec<usize>>, BakeError> {
        let mut keyed = Vec::with_capacity(lobe_groups.len());
        for users in lobe_groups {
            let layer = &self.group.layers[users[0]];
            let is_seen = users.iter().any(|user| self.group.layers[*user].layer.is_seen);
            let roughness = self.images.roughness(layer)?;
            let alpha = mean_alpha(roughness.as_ref(), layer.layer.roughness_factor);
            let width = alpha / f64::from(layer.slope_scale.abs());
            keyed.push((!layer.can_decide_directions(), !is_seen, width, users));
        }
        keyed.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
        Ok(keyed.into_iter().map(|(.., users)| users).collect())
    }

    /// Decodes the base lobe of `layer` and its reflectance.
    fn base(&self, layer: &GroupLayer) -> Result<PreparedBase<'static>, BakeError> {
        let BaseImages { roughness, anisotropy } = self.images.base(layer)?;
        let (reflectance, note) = ReflectanceInput::new(&self.images, layer, roughness.as_ref())?;
        let input = BaseInput {
            roughness: roughness.map(Cow::Owned),
            roughness_factor: layer.layer.roughness_factor,
            anisotropy: layer.anisotropy.as_ref().map(|source| AnisotropyInput {
                texture: anisotropy,
                strength: source.strength,
                rotation: source.rotation,
            }),
            reflectance,
            wrap: self.group.source.wrap,
        };
        Ok(PreparedBase { input, levels: None, note })
    }

    /// Returns the inputs of all lobes. Images are decoded when the iterator reaches them.
    fn inputs<'i>(
        &'i self,
        map: &'i MapOffsets<'_>,
        lobe_groups: &'i [Vec<usize>],
        mut first_base: Option<PreparedBase<'static>>,
    ) -> impl ExactSizeIterator<Item = Result<LayerInput<'static>, BakeError>> + 'i {
        lobe_groups.iter().map(move |users| {
            let layer = &self.group.layers[users[0]];
            let base = match first_base.take() {
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
