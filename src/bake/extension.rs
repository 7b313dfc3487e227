//! `ROUGHCAST_materials_roughness_pyramid`: what a plugin needs (`schemas/`).

use serde::Serialize;
use serde_json::Value;

use super::pyramids::Range;
use crate::bump::Frame;
use crate::gltf::material::Mapping;

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

/// A texture with what its texels stand for.
pub struct RangedTexture {
    /// Index into `textures`.
    pub texture: usize,
    /// What texels of 0 and 1 stand for.
    pub range: Range,
}

impl Extension {
    /// Offsets, and D (three channels) or lambda_1 (one), read with the texture coordinates of `mapping`.
    pub fn new(
        offset: RangedTexture,
        roughness: Option<RangedTexture>,
        correction_factor: f32,
        frame: Frame,
        mapping: &Mapping,
    ) -> Self {
        let info = |index| TextureInfo {
            index,
            tex_coord: mapping.tex_coord,
            extensions: mapping.transform.clone().map(|transform| TextureInfoExtensions { transform }),
        };
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
        }
    }
}

fn is_zero(n: &u64) -> bool {
    *n == 0
}
