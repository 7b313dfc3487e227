//! `ROUGHCAST_materials_roughness_pyramid`: what a plugin needs (`schemas/`).

use serde::Serialize;
use serde_json::Value;

use crate::bump::Frame;
use crate::gltf::material::{Layer, Mapping, TextureUse};
use crate::material::Range;

/// Name of the extension.
pub const EXTENSION: &str = "ROUGHCAST_materials_roughness_pyramid";

/// The extension object of a material.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Extension {
    offset_texture: TextureInfo,
    offset_min: Vec<f32>,
    offset_max: Vec<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    roughness_model: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    roughness_texture: Option<TextureInfo>,
    #[serde(skip_serializing_if = "Option::is_none")]
    roughness_min: Option<Vec<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    roughness_max: Option<Vec<f32>>,
    correction_factor: f32,
    frame: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    main_direction: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    base_lobe: Option<BaseLobe>,
}

/// The lobe that a material had before the portable profile folded its bumps into the core properties. A plugin adds K to
/// this one, or it would count the bumps twice.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct BaseLobe {
    roughness_factor: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    metallic_roughness_texture: Option<TextureInfo>,
    #[serde(skip_serializing_if = "Option::is_none")]
    anisotropy: Option<Anisotropy>,
}

/// `KHR_materials_anisotropy`.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Anisotropy {
    anisotropy_strength: f32,
    anisotropy_rotation: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    anisotropy_texture: Option<TextureInfo>,
}

impl BaseLobe {
    fn factors(&self) -> [f32; 3] {
        let (strength, rotation) =
            self.anisotropy.as_ref().map_or((0.0, 0.0), |a| (a.anisotropy_strength, a.anisotropy_rotation));
        [self.roughness_factor, strength, rotation]
    }

    /// As `layer` says, whose textures stay in the document.
    pub fn new(layer: &Layer) -> Self {
        Self {
            roughness_factor: layer.roughness_factor,
            metallic_roughness_texture: layer.roughness.as_ref().map(TextureInfo::of),
            anisotropy: layer.anisotropy.as_ref().map(|own| Anisotropy {
                anisotropy_strength: own.strength,
                anisotropy_rotation: own.rotation,
                anisotropy_texture: own.texture.as_ref().map(TextureInfo::of),
            }),
        }
    }
}

#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct TextureInfo {
    index: usize,
    #[serde(skip_serializing_if = "is_zero")]
    tex_coord: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    extensions: Option<TextureInfoExtensions>,
}

#[derive(Clone, Debug, Serialize)]
struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: Value,
}

impl TextureInfo {
    fn new(index: usize, mapping: &Mapping) -> Self {
        Self {
            index,
            tex_coord: mapping.tex_coord,
            extensions: mapping.transform.clone().map(|transform| TextureInfoExtensions { transform }),
        }
    }

    fn of(texture: &TextureUse) -> Self {
        Self::new(texture.texture, &texture.mapping)
    }
}

/// A texture with what its texels stand for.
pub struct RangedTexture {
    /// Index into `textures`.
    pub texture: usize,
    /// What texels of 0 and 1 stand for.
    pub range: Range,
}

impl Extension {
    /// Offsets, and D (three channels) or lambda_1 (one), read with the texture coordinates of `mapping`; `baseLobe` where
    /// the core properties hold K, too.
    pub fn new(
        offset: RangedTexture,
        roughness: Option<RangedTexture>,
        correction_factor: f32,
        frame: Frame,
        mapping: &Mapping,
        base_lobe: Option<BaseLobe>,
    ) -> Self {
        let info = |index| TextureInfo::new(index, mapping);
        let model = |r: &RangedTexture| if r.range.max.len() == 3 { "covarianceFactor" } else { "standardDeviation" };
        let (frame, main_direction) = match frame {
            Frame::Natural => ("natural", None),
            Frame::Unit => ("unit", None),
            Frame::MainDirection(m) => ("mainDirection", Some(m)),
        };
        Self {
            offset_texture: info(offset.texture),
            offset_min: offset.range.min,
            offset_max: offset.range.max,
            roughness_model: roughness.as_ref().map(model),
            roughness_texture: roughness.as_ref().map(|r| info(r.texture)),
            roughness_min: roughness.as_ref().map(|r| r.range.min.clone()),
            roughness_max: roughness.map(|r| r.range.max),
            correction_factor,
            frame,
            main_direction,
            base_lobe,
        }
    }
}

impl Extension {
    /// Whether all numbers are ones that JSON has: others would be written as `null`.
    pub fn is_finite(&self) -> bool {
        let ranges =
            [Some(&self.offset_min), Some(&self.offset_max), self.roughness_min.as_ref(), self.roughness_max.as_ref()];
        let own = self.base_lobe.as_ref().map_or([0.0; 3], BaseLobe::factors);
        let direction = self.main_direction.unwrap_or_default();
        let mut all =
            ranges.into_iter().flatten().flatten().chain(&own).chain(&direction).chain([&self.correction_factor]);
        all.all(|number| number.is_finite())
    }
}

fn is_zero(n: &u64) -> bool {
    *n == 0
}
