//! The bake of a standalone map: a material of one bump map, without a document.

use std::borrow::Cow;
use std::sync::Arc;

use crate::bake::bake_bump_map::{BumpMapProducts, bake_bump_map};
use crate::bake::error::BakeError;
use crate::bake::lobes::{BaseInput, LayerInput, PreparedBase};
use crate::bake::offsets::MapOffsets;
use crate::bake::products::EncodedTexture;
use crate::bake::pyramid::PyramidInput;
use crate::bump::Frame;
use crate::image::Image;
use crate::material::{BumpMap, FrameTransforms, first_within, notes};
use crate::mip::{Magnification, Sampler};
use crate::note::{self, Note};
use crate::report::Choice;
use crate::settings::{Form, Model, Settings};

/// The roughness of the surface of a standalone map.
pub struct BaseRoughness {
    /// Green is roughness (a grey image is grey in green); constant 1 without an image.
    pub image: Option<Image>,
    /// Multiplies it.
    pub factor: f32,
}

/// A baked standalone map, whose textures are no files yet.
pub struct EncodedMap {
    /// The textures. The first is the bump map: normals or offsets.
    pub textures: Vec<EncodedTexture>,
    /// What is modelled of the lost bumps.
    pub model: Model,
    /// The candidates and their errors, if the base roughness is known.
    pub choice: Option<Choice>,
    /// Notes to the user.
    pub notes: Vec<Note>,
}

/// Bakes a standalone map. The portable profile writes roughness only if the base roughness is known.
///
/// # Errors
/// [`BakeError`] if the grid is too large or a texture cannot be encoded.
pub fn bake_map(
    bump_map: &BumpMap,
    base_roughness: Option<&BaseRoughness>,
    settings: &Settings,
) -> Result<EncodedMap, BakeError> {
    // PNG fallbacks are for documents, which refer to both files, and only documents have a scale of normals.
    let settings = &Settings { gltf: Form::Strict, scale_normals: Some(false), ..*settings };
    let sampler = Sampler { wrap: bump_map.wrap(), magnification: Magnification::Linear };
    let map = MapOffsets::new(bump_map, settings, sampler)?;
    let mut notes = notes::of_bump_map(bump_map, map.bumps.size());
    if base_roughness.is_none() && settings.profile.is_portable() {
        notes.push(note::no_base_roughness());
    }
    let layer = std::iter::once_with(|| layer_input(&map, base_roughness));
    let first = first_within(settings, map.bumps.size());
    let BumpMapProducts { normals, layers, pyramid } = bake_bump_map(&map, first, layer, || vec![tangent_frame()])?;
    let (mut textures, mut model, mut choice) = (Vec::from_iter(normals), Model::None, None);
    for layer in layers {
        notes.extend(layer.notes);
        textures.extend(layer.textures.into_iter().chain(layer.base_roughness));
        (model, choice) = (layer.reported_model, layer.model.choice);
    }
    textures.extend(pyramid.textures);
    notes.extend(pyramid.layers.into_iter().flat_map(|layer| layer.notes));
    Ok(EncodedMap { textures, model, choice, notes })
}

/// Returns the only layer of a standalone map, all of whose written levels can be sampled.
fn layer_input<'a>(
    map: &MapOffsets<'_>,
    base_roughness: Option<&'a BaseRoughness>,
) -> Result<LayerInput<'a>, BakeError> {
    let input = BaseInput {
        roughness: base_roughness.and_then(|base| base.image.as_ref()).map(Cow::Borrowed),
        roughness_factor: base_roughness.map_or(1.0, |base| base.factor),
        anisotropy: None,
        reflectance: None,
        wrap: map.sampler.wrap,
    };
    let size = input.grid(map.settings, Some(map.bump_map))?;
    let first = first_within(map.settings, size);
    Ok(LayerInput {
        size,
        base: PreparedBase { input, levels: None, note: None },
        can_be_roughened: base_roughness.is_some(),
        keeps_core_lobe: false,
        slope_scale: 1.0,
        is_in_pyramid: base_roughness.is_some(),
        max_model: map.settings.model_limit(),
        finest: first,
        first,
    })
}

/// Returns the input of the pyramid profile: offsets stay in the tangent frame.
fn tangent_frame() -> PyramidInput {
    PyramidInput {
        lobes: 0,
        frame: Frame::Unit,
        transforms: Arc::new(FrameTransforms::IDENTITY),
        scale: [1.0; 2],
        note: None,
    }
}

#[cfg(test)]
mod tests;
