//! Building `ROUGHCAST_materials_roughness_pyramid` for a material.

use serde_json::Map;

use crate::bake::group::GroupLayer;
use crate::bump::Frame;
use crate::gltf::material::{Layer, Mapping, TextureUse};
use crate::gltf::roughness_pyramid::{Anisotropy, FORMAT_VERSION, RoughnessModel, RoughnessPyramid, TextureInfo};
use crate::material::Range;

pub use crate::gltf::roughness_pyramid::EXTENSION;

/// The extension object of a material, as it is written.
pub type Extension = RoughnessPyramid<f32>;

/// The lobe that a material had before the portable profile roughened it, as it is written.
pub type BaseLobe = crate::gltf::roughness_pyramid::BaseLobe<f32>;

/// A texture of offsets.
pub struct ScaledTexture {
    /// Index into `textures`.
    pub texture: usize,
    /// Whether z is stored.
    pub has_z: bool,
    /// What multiplies the slopes of the normals.
    pub scale: [f32; 2],
}

/// A texture with the range of its values.
pub struct RangedTexture {
    /// Index into `textures`.
    pub texture: usize,
    /// What texels of 0 and 1 stand for.
    pub range: Range,
}

impl BaseLobe {
    /// Returns the base lobe of `layer`, whose textures stay in the document. If `is_baked`, a baked texture will take
    /// the place of roughness and its factor.
    pub fn new(layer: &GroupLayer, is_baked: bool) -> Self {
        let GroupLayer { layer: Layer { roughness_factor, roughness, .. }, .. } = layer;
        Self {
            roughness_factor: Some(if is_baked { 1.0 } else { *roughness_factor }),
            metallic_roughness_texture: roughness.as_ref().filter(|_| !is_baked).map(TextureInfo::of),
            anisotropy: layer.anisotropy.as_ref().map(|anisotropy| Anisotropy {
                anisotropy_strength: Some(anisotropy.strength),
                anisotropy_rotation: Some(anisotropy.rotation),
                anisotropy_texture: anisotropy.texture.as_ref().map(TextureInfo::of),
            }),
        }
    }

    /// Takes the texture with an index, which has the texture coordinates of `mapping`.
    pub fn with_texture(self, index: usize, mapping: &Mapping) -> Self {
        Self { metallic_roughness_texture: Some(TextureInfo::new(index, mapping)), ..self }
    }

    fn numbers(&self) -> impl Iterator<Item = f32> {
        let anisotropy = self.anisotropy.iter().flat_map(|a| [a.anisotropy_strength, a.anisotropy_rotation]);
        [self.roughness_factor].into_iter().chain(anisotropy).flatten()
    }
}

impl TextureInfo {
    fn new(index: usize, mapping: &Mapping) -> Self {
        let transform = mapping.transform.clone();
        let extensions = transform.map(|transform| Map::from_iter([("KHR_texture_transform".to_owned(), transform)]));
        Self { index, tex_coord: mapping.tex_coord, extensions, extras: None }
    }

    fn of(texture: &TextureUse) -> Self {
        Self::new(texture.texture, &texture.mapping)
    }
}

impl Extension {
    /// Builds the extension from the texture of offsets and the texture of D (three channels) or lambda_1 (one
    /// channel), both read with the texture coordinates of `mapping`. `base_lobe` is needed if the core properties hold
    /// K too.
    pub fn new(
        offset: ScaledTexture,
        roughness: Option<RangedTexture>,
        correction_factor: f32,
        frame: Frame,
        mapping: &Mapping,
        base_lobe: Option<BaseLobe>,
    ) -> Self {
        let info = |index| TextureInfo::new(index, mapping);
        let model = |r: &RangedTexture| match r.range.max.len() {
            3 => RoughnessModel::CovarianceFactor,
            _ => RoughnessModel::StandardDeviation,
        };
        Self {
            format_version: FORMAT_VERSION,
            offset_texture: info(offset.texture),
            offset_channels: if offset.has_z { 3 } else { 2 },
            offset_scale: offset.scale,
            roughness_model: roughness.as_ref().map(model),
            roughness_texture: roughness.as_ref().map(|r| info(r.texture)),
            roughness_min: roughness.as_ref().map(|r| r.range.min.clone()),
            roughness_max: roughness.map(|r| r.range.max),
            correction_factor,
            frame: frame.kind(),
            main_direction: frame.main_direction(),
            base_lobe,
            extensions: None,
            extras: None,
        }
    }

    /// Returns whether JSON has all the numbers: infinities and NaN would be written as `null`.
    pub fn is_finite(&self) -> bool {
        let ranges = [self.roughness_min.as_deref(), self.roughness_max.as_deref()].into_iter().flatten().flatten();
        let direction = self.main_direction.iter().flatten();
        let numbers = self.offset_scale.iter().chain(ranges).chain(direction).chain([&self.correction_factor]).copied();
        numbers.chain(self.base_lobe.iter().flat_map(BaseLobe::numbers)).all(f32::is_finite)
    }
}
