//! Step 2 of base colours that are darkened for suns (`--diffuse-light suns`): which bumps and which metalness lie over
//! them, and step 3, the images of these.

use std::collections::BTreeMap;
use std::ptr;
use std::sync::Arc;

use serde_json::Value;

use super::decode::Images;
use super::error::BakeError;
use super::group::{BumpMapGroup, GroupLayer, ReflectanceTextures};
use crate::gltf::layers::LayerKind;
use crate::gltf::texture::ImageLocation;
use crate::image::Image;
use crate::material::{BumpMap, DiffuseLight, DiffuseSource, Factored, Metalness};
use crate::mip::Wrap;
use crate::note::{self, KeptColour, Note};
use crate::settings::{DiffuseLight as Light, Settings};

/// The bumps and the metalness over a base colour.
#[derive(Clone, Copy)]
pub struct BumpyColour<'g> {
    group: &'g BumpMapGroup,
    layer: &'g GroupLayer,
    reflectance: &'g ReflectanceTextures,
}

/// The base colours that are darkened, by the indices of their materials, or why one of a material with bumps is not.
pub type BumpyColours<'g> = BTreeMap<usize, Result<BumpyColour<'g>, Note>>;

/// Returns the base colours of all materials of `root`, the document's JSON, whose base layer has bumps; none if
/// `settings` leave mips of colours as means.
pub fn bumpy_colours<'g>(root: &Value, groups: &'g [BumpMapGroup], settings: &Settings) -> BumpyColours<'g> {
    if settings.diffuse_light != Light::Suns {
        return BumpyColours::new();
    }
    let layers = groups.iter().flat_map(|group| group.layers.iter().map(move |layer| (group, layer)));
    let base = layers.filter(|(_, layer)| layer.layer.kind == LayerKind::Base);
    base.map(|(group, layer)| (layer.material, bumpy_colour(root, group, layer).map_err(note::base_colour_unchanged)))
        .collect()
}

fn bumpy_colour<'g>(
    root: &Value,
    group: &'g BumpMapGroup,
    layer: &'g GroupLayer,
) -> Result<BumpyColour<'g>, KeptColour> {
    if root.pointer(&layer.pointer("extensions/KHR_materials_unlit")).is_some() {
        return Err(KeptColour::Unlit);
    }
    if layer.layer.has_other_workflow {
        return Err(KeptColour::SpecularGlossiness);
    }
    let Some(Ok(factors)) = &layer.layer.reflectance else { return Err(KeptColour::UnknownMetalness) };
    if factors.base_colour.is_none() {
        return Err(KeptColour::NoTexture);
    }
    let reflectance = layer.reflectance().ok_or(KeptColour::UnknownMetalness)?;
    match reflectance.base_colour {
        Some(_) => Ok(BumpyColour { group, layer, reflectance }),
        None => Err(KeptColour::OtherTexels),
    }
}

/// The decoded images over a base colour.
pub struct DiffuseImages {
    bump_map: BumpMap,
    roughness: Option<Image>,
    metalness: Metalness,
}

impl BumpyColour<'_> {
    /// Returns whether both darken a base colour alike.
    pub fn is_same(&self, other: &Self) -> bool {
        let roughness = |of: &Self| of.layer.base_textures()[0].map(ptr::from_ref);
        ptr::eq(self.group, other.group)
            && self.layer.slope_scale == other.layer.slope_scale
            && roughness(self) == roughness(other)
            && self.reflectance.factors.metallic_factor == other.reflectance.factors.metallic_factor
            && self.reflectance.factors.base_colour_factor == other.reflectance.factors.base_colour_factor
    }

    /// Returns the locations of the images that [`Self::decode`] reads.
    pub fn locations(&self) -> impl Iterator<Item = &Arc<ImageLocation>> {
        let roughness = self.layer.base_textures()[0].map(|texture| &texture.location);
        [&self.group.source.location].into_iter().chain(roughness)
    }

    /// Decodes the bump map and the metalness.
    ///
    /// # Errors
    /// [`BakeError`] for an image that cannot be decoded.
    pub fn decode(&self, images: &Images<'_>) -> Result<DiffuseImages, BakeError> {
        let (bump_map, _) = images.bump_map(self.group)?;
        let roughness = self.layer.base_textures()[0].map(|texture| images.colours(texture, &self.layer.name));
        let roughness = roughness.transpose()?;
        let metalness = Metalness::new(roughness.as_ref(), self.reflectance.factors.metallic_factor);
        Ok(DiffuseImages { bump_map, roughness, metalness })
    }

    /// Returns the factors of the base colour `image` on a grid of `size` texels.
    pub fn light<'a>(
        &self,
        images: &'a DiffuseImages,
        image: &'a Image,
        size: (u32, u32),
        wrap: [Wrap; 2],
    ) -> DiffuseLight<'a> {
        let source = DiffuseSource {
            bump_map: &images.bump_map,
            slope_scale: self.layer.slope_scale,
            roughness: images.roughness.as_ref(),
            metalness: images.metalness,
            base_colour: Factored { image: Some(image), factor: self.reflectance.factors.base_colour_factor },
        };
        DiffuseLight::new(source, size, wrap)
    }
}

#[cfg(test)]
mod tests;
