//! The textures that a bake encodes and does not change (`--textures all`): step 3 and steps 7 and 8 of each. Base
//! colours may be darkened for suns.

use std::collections::BTreeSet;
use std::sync::Arc;

use serde_json::Value;

use super::decode::Images;
use super::diffuse_light::{BumpyColour, BumpyColours};
use super::error::BakeError;
use super::group::GroupError;
use super::group_output::{GroupOutput, GroupTexture};
use super::products::EncodedTexture;
use super::reader::Reader;
use crate::codec::EncodeError;
use crate::gltf::material::Mapping;
use crate::gltf::plain_textures::{Meaning, PlainTextureUse, plain_textures};
use crate::gltf::rewrite::Slot;
use crate::gltf::texture::{TextureSource, Textures};
use crate::material::{Encoding, PlainTexture, Product, first_within, grid};
use crate::note::{self, KeptColour, Note};
use crate::report::Content;
use crate::settings::{DiffuseLight, Settings, Textures as Written};

/// Plain textures of one image, one sampler and one meaning. Base colours also have the same bumps and metalness over
/// them, if they are darkened for suns.
pub struct PlainTextureGroup<'g> {
    source: Arc<TextureSource>,
    meaning: Meaning,
    /// Name of the first material that uses it.
    material: String,
    /// References of materials.
    pointers: Vec<String>,
    /// What darkens the texture, and the indices of the materials whose base colour it is then.
    bumpy: Option<(BumpyColour<'g>, Vec<usize>)>,
}

/// What a plain texture becomes.
pub enum PlainTextureOutput {
    /// A new texture.
    Texture(Box<GroupOutput>),
    /// The texture stays as it is. Each note is about the base layer of the material of the index.
    Unchanged(Vec<(usize, Note)>),
}

/// Groups the plain textures of `root`, in the order of the file; none if `settings` leave them as they are. `bumpy`
/// has the base colours that are darkened.
///
/// # Errors
/// [`GroupError`] for the first reference that leads nowhere.
pub fn group_plain_textures<'g>(
    root: &Value,
    settings: &Settings,
    bumpy: &BumpyColours<'g>,
) -> Result<Vec<PlainTextureGroup<'g>>, GroupError> {
    let mut groups: Vec<PlainTextureGroup<'g>> = Vec::new();
    if settings.textures != Written::All {
        return Ok(groups);
    }
    let mut textures = Textures::of(root);
    for PlainTextureUse { pointer, index, texture, material, meaning, is_base_colour } in plain_textures(root) {
        let failed = |error| GroupError { material: material.clone(), part: "texture", error };
        let source = textures.get(texture).map_err(failed)?;
        let bumpy = bumpy.get(&index).filter(|_| is_base_colour).and_then(|bumpy| bumpy.as_ref().ok());
        let is_same = |group: &&mut PlainTextureGroup<'g>| {
            let is_bumpy_alike = match (&group.bumpy, bumpy) {
                (Some((ours, _)), Some(theirs)) => ours.is_same(theirs),
                (ours, theirs) => ours.is_none() && theirs.is_none(),
            };
            Arc::ptr_eq(&group.source, &source) && group.meaning == meaning && is_bumpy_alike
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => {
                group.pointers.push(pointer);
                group.bumpy.iter_mut().for_each(|(_, materials)| materials.push(index));
            }
            None => {
                let bumpy = bumpy.map(|bumpy| (*bumpy, vec![index]));
                groups.push(PlainTextureGroup { source, meaning, material, pointers: vec![pointer], bumpy });
            }
        }
    }
    Ok(groups)
}

impl PlainTextureGroup<'_> {
    /// Encodes the texture for the references that are not among `taken`, since the bake gave those another texture. It
    /// stays as it is if none is left, or if the image is a KTX2 already.
    ///
    /// # Errors
    /// [`BakeError`] if the image cannot be read or encoded.
    pub fn bake(
        self,
        taken: &BTreeSet<&str>,
        reader: &Reader<'_>,
        settings: &Settings,
    ) -> Result<PlainTextureOutput, BakeError> {
        let Self { source, meaning, material, mut pointers, bumpy } = self;
        pointers.retain(|pointer| !taken.contains(pointer.as_str()));
        if pointers.is_empty() {
            return Ok(PlainTextureOutput::Unchanged(Vec::new()));
        }
        let images = Images::new(reader, settings.max_texels);
        let Some(image) = images.colours_unless_ktx2(&source, &material)? else {
            let materials = bumpy.map_or_else(Vec::new, |(_, materials)| materials);
            let note = |index| (index, note::base_colour_unchanged(KeptColour::Ktx2));
            return Ok(PlainTextureOutput::Unchanged(materials.into_iter().map(note).collect()));
        };
        let bumpy = bumpy.map(|(bumpy, _)| bumpy);
        let over = bumpy.as_ref().map(|bumpy| Ok::<_, BakeError>((bumpy, bumpy.decode(&images)?))).transpose()?;
        let size = grid(settings, [(image.width, image.height)])?;
        let diffuse_light = over.as_ref().map(|(bumpy, over)| bumpy.light(over, &image, size, source.wrap));
        let texture = PlainTexture::new(&image, meaning, size, source.wrap).darkened_by(diffuse_light);
        let encoding = match meaning {
            Meaning::Linear => Encoding::of(settings, 3),
            // Settings without a format for colours are refused before any bake.
            Meaning::Colour(_) => Encoding::of_colours(settings, texture.has_alpha())
                .ok_or(EncodeError::WithoutColours { target: settings.target })?,
        };
        let content = if meaning == Meaning::Linear { Content::Linear } else { Content::Colour };
        let texture = EncodedTexture {
            diffuse_light: bumpy.map(|_| DiffuseLight::Suns),
            ..EncodedTexture::new(content, texture.encode(encoding.starting_at(first_within(settings, size)))?)
        };
        let slot = |pointer: String| Slot { pointer, mapping: Mapping::default() };
        let texture = GroupTexture {
            texture,
            stem: source.stem(),
            sources: images
                .digests([&source.location].into_iter().chain(bumpy.iter().flat_map(BumpyColour::locations))),
            slots: pointers.into_iter().map(slot).collect(),
            sampler: source.sampler,
        };
        Ok(PlainTextureOutput::Texture(Box::new(GroupOutput { textures: vec![texture], layers: Vec::new() })))
    }
}

#[cfg(test)]
mod tests;
