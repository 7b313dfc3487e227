//! The table of material layers: where a material keeps the bumps, roughness and anisotropy of each of its lobes.
//!
//! [`crate::gltf::material`] reads materials by this table, the bake writes them by it, and the checker and `inspect`
//! find textures by it. A new layer is a new [`LayerKind`] with a new row.

use serde::{Deserialize, Serialize};

/// A lobe of a material that has bumps of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum LayerKind {
    /// The metallic-roughness lobe.
    Base,
    /// `KHR_materials_clearcoat`.
    Clearcoat,
}

/// A JSON pointer into a material, without the leading slash: `pbrMetallicRoughness/roughnessFactor`.
pub type Pointer = &'static str;

/// Where a material keeps one of its layers.
#[derive(Debug)]
pub struct LayerRow {
    /// The layer.
    pub kind: LayerKind,
    /// The name of the layer in reports, in notes and on the command line.
    pub name: &'static str,
    /// The extension without which a material does not have the layer; none for the base layer.
    pub extension: Option<&'static str>,
    /// The number that the light of the layer is multiplied by, 0 by default; none for the base layer.
    pub strength: Option<Pointer>,
    /// The normal texture. The scale of its bumps is its member `scale`.
    pub normal_texture: Pointer,
    /// The height texture, which is read where there is no normal texture. Its scale is its member `scale`.
    pub height_texture: Option<Pointer>,
    /// The texture whose green channel is the roughness.
    pub roughness_texture: Pointer,
    /// The number that multiplies the roughness texture.
    pub roughness_factor: Pointer,
    /// The roughness factor of a material that names none.
    pub default_roughness_factor: f32,
    /// The anisotropy of the layer; none if its lobe can only be isotropic.
    pub anisotropy: Option<AnisotropyRow>,
    /// What decides on the specular reflectance of the layer; none if the reflectance is constant.
    pub reflectance: Option<ReflectanceRow>,
    /// The texture with occlusion in red, which may share its image with the roughness.
    pub occlusion_texture: Option<Pointer>,
    /// An extension that takes the place of the roughness in engines that know it.
    pub other_workflow: Option<Pointer>,
    /// Whether `ROUGHCAST_materials_roughness_pyramid` describes the layer.
    pub is_in_pyramid: bool,
}

/// Where a material keeps the anisotropy of a layer.
#[derive(Debug)]
pub struct AnisotropyRow {
    /// The object with all of it.
    pub object: Pointer,
    /// The name of the extension that defines it.
    pub extension: &'static str,
    /// The texture with the direction in red and green and the strength in blue.
    pub texture: Pointer,
    /// The number that multiplies the strength.
    pub strength: Pointer,
    /// The angle that is added to the direction, in radians.
    pub rotation: Pointer,
}

/// Where a material keeps what decides on the specular reflectance of a layer. Metalness is the blue channel of the
/// layer's roughness texture.
#[derive(Debug)]
pub struct ReflectanceRow {
    /// The object with base colour and metalness.
    pub object: Pointer,
    /// The texture with the base colour.
    pub base_colour_texture: Pointer,
    /// The linear colour that multiplies the base colour.
    pub base_colour_factor: Pointer,
    /// The number that multiplies the metalness.
    pub metallic_factor: Pointer,
    /// The object of `KHR_materials_specular`.
    pub specular: Pointer,
    /// The texture whose alpha multiplies the reflectance of the dielectric.
    pub specular_texture: Pointer,
    /// The number that multiplies the reflectance of the dielectric.
    pub specular_factor: Pointer,
    /// The texture with the colour of the dielectric's F0.
    pub specular_colour_texture: Pointer,
    /// The linear colour that multiplies the dielectric's F0.
    pub specular_colour_factor: Pointer,
}

/// All layers, in the order in which materials list them.
pub static LAYERS: [LayerRow; 2] = [BASE, CLEARCOAT];

const BASE: LayerRow = LayerRow {
    kind: LayerKind::Base,
    name: "base",
    extension: None,
    strength: None,
    normal_texture: "normalTexture",
    height_texture: Some("extras/roughcast/heightTexture"),
    roughness_texture: "pbrMetallicRoughness/metallicRoughnessTexture",
    roughness_factor: "pbrMetallicRoughness/roughnessFactor",
    default_roughness_factor: 1.0,
    anisotropy: Some(AnisotropyRow {
        object: "extensions/KHR_materials_anisotropy",
        extension: "KHR_materials_anisotropy",
        texture: "extensions/KHR_materials_anisotropy/anisotropyTexture",
        strength: "extensions/KHR_materials_anisotropy/anisotropyStrength",
        rotation: "extensions/KHR_materials_anisotropy/anisotropyRotation",
    }),
    reflectance: Some(ReflectanceRow {
        object: "pbrMetallicRoughness",
        base_colour_texture: "pbrMetallicRoughness/baseColorTexture",
        base_colour_factor: "pbrMetallicRoughness/baseColorFactor",
        metallic_factor: "pbrMetallicRoughness/metallicFactor",
        specular: "extensions/KHR_materials_specular",
        specular_texture: "extensions/KHR_materials_specular/specularTexture",
        specular_factor: "extensions/KHR_materials_specular/specularFactor",
        specular_colour_texture: "extensions/KHR_materials_specular/specularColorTexture",
        specular_colour_factor: "extensions/KHR_materials_specular/specularColorFactor",
    }),
    occlusion_texture: Some("occlusionTexture"),
    other_workflow: Some("extensions/KHR_materials_pbrSpecularGlossiness"),
    is_in_pyramid: true,
};

const CLEARCOAT: LayerRow = LayerRow {
    kind: LayerKind::Clearcoat,
    name: "clearcoat",
    extension: Some("KHR_materials_clearcoat"),
    strength: Some("extensions/KHR_materials_clearcoat/clearcoatFactor"),
    normal_texture: "extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
    height_texture: None,
    roughness_texture: "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture",
    roughness_factor: "extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor",
    default_roughness_factor: 0.0,
    anisotropy: None,
    // The clearcoat has one refractive index everywhere.
    reflectance: None,
    occlusion_texture: None,
    other_workflow: None,
    is_in_pyramid: false,
};

/// Splits a pointer into the pointer of the object and the name of the member.
pub(super) fn split(pointer: Pointer) -> (Pointer, &'static str) {
    pointer.rsplit_once('/').unwrap_or(("", pointer))
}

/// Returns the name of the member that a pointer leads to.
pub fn member(pointer: Pointer) -> &'static str {
    split(pointer).1
}

impl LayerKind {
    /// Returns the name, as reports have it.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Returns the row of the layer.
    pub fn row(self) -> &'static LayerRow {
        // Layers are made from rows, so every layer has one.
        LAYERS.iter().find(|row| row.kind == self).unwrap_or(&LAYERS[0])
    }
}

#[cfg(test)]
mod tests;
