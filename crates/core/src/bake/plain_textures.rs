//! The textures that a bake encodes and does not change (`--textures all`): step 3 and steps 7 and 8 of each.

use std::collections::BTreeSet;
use std::sync::Arc;

use serde_json::Value;

use super::decode::Images;
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
use crate::report::Content;
use crate::settings::{Model, Settings, Textures as Written};

/// Plain textures of one image, one sampler and one meaning.
pub struct PlainTextureGroup {
    source: Arc<TextureSource>,
    meaning: Meaning,
    /// Name of the first material that uses it.
    material: String,
    /// References of materials.
    pointers: Vec<String>,
}

/// Groups the plain textures of `root`, in the order of the file; none if `settings` leave them as they are.
///
/// # Errors
/// [`GroupError`] for the first reference that leads nowhere.
pub fn group_plain_textures(root: &Value, settings: &Settings) -> Result<Vec<PlainTextureGroup>, GroupError> {
    let mut groups: Vec<PlainTextureGroup> = Vec::new();
    if settings.textures != Written::All {
        return Ok(groups);
    }
    let mut textures = Textures::of(root);
    for PlainTextureUse { pointer, texture, material, meaning } in plain_textures(root) {
        let failed = |error| GroupError { material: material.clone(), part: "texture", error };
        let source = textures.get(texture).map_err(failed)?;
        let is_same = |group: &&mut PlainTextureGroup| Arc::ptr_eq(&group.source, &source) && group.meaning == meaning;
        match groups.iter_mut().find(is_same) {
            Some(group) => group.pointers.push(pointer),
            None => groups.push(PlainTextureGroup { source, meaning, material, pointers: vec![pointer] }),
        }
    }
    Ok(groups)
}

impl PlainTextureGroup {
    /// Encodes the texture for the references that are not among `taken`, since the bake gave those another texture.
    /// Returns `None` if none is left, or if the image is a KTX2 already.
    ///
    /// # Errors
    /// [`BakeError`] if the image cannot be read or encoded.
    pub fn bake(
        self,
        taken: &BTreeSet<&str>,
        reader: &Reader<'_>,
        settings: &Settings,
    ) -> Result<Option<GroupOutput>, BakeError> {
        let Self { source, meaning, material, mut pointers } = self;
        pointers.retain(|pointer| !taken.contains(pointer.as_str()));
        if pointers.is_empty() {
            return Ok(None);
        }
        let images = Images::new(reader, settings.max_texels);
        let Some(image) = images.colours_unless_ktx2(&source, &material)? else { return Ok(None) };
        let size = grid(settings, [(image.width, image.height)])?;
        let texture = PlainTexture::new(&image, meaning, size, source.wrap);
        let encoding = match meaning {
            Meaning::Linear => Encoding::of(settings, 3),
            // Settings without a format for colours are refused before any bake.
            Meaning::Colour(_) => Encoding::of_colours(settings, texture.has_alpha())
                .ok_or(EncodeError::WithoutColours { target: settings.target })?,
        };
        let texture = EncodedTexture {
            content: if meaning == Meaning::Linear { Content::Linear } else { Content::Colour },
            mip_chain: texture.encode(encoding.starting_at(first_within(settings, size)))?,
            range: None,
            scale: None,
            model: Model::None,
            lobe_errors: Vec::new(),
        };
        let slot = |pointer: String| Slot { pointer, mapping: Mapping::default() };
        let texture = GroupTexture {
            texture,
            stem: source.stem(),
            sources: images.digests([&source.location]),
            slots: pointers.into_iter().map(slot).collect(),
            sampler: source.sampler,
        };
        Ok(Some(GroupOutput { textures: vec![texture], layers: Vec::new() }))
    }
}

#[cfg(test)]
mod tests;
