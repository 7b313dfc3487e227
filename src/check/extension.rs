//! `ROUGHCAST_materials_roughness_pyramid`, read as strictly as its schema in `schemas/` says.
//!
//! Not through the schema itself: a validator in the product would bring a regular expression engine and some 30 crates
//! along. A test validates the same objects against the schema and expects the same verdicts.

use serde::Deserialize;
use serde_json::{Map, Value};

/// What the extension of a material says.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct RoughnessPyramid {
    /// Texture of (f_u, f_v).
    pub offset_texture: TextureInfo,
    /// Value of a texel of 0.
    pub offset_min: [f64; 2],
    /// Value of a texel of 1.
    pub offset_max: [f64; 2],
    /// What the roughness texture holds.
    pub roughness_model: Option<RoughnessModel>,
    /// Texture of D or lambda_1.
    pub roughness_texture: Option<TextureInfo>,
    /// Value of a texel of 0.
    pub roughness_min: Option<Vec<f64>>,
    /// Value of a texel of 1.
    pub roughness_max: Option<Vec<f64>>,
    /// c.
    pub correction_factor: f64,
    /// The frame of the offsets.
    pub frame: FrameName,
    /// m, in the space of the mesh.
    pub main_direction: Option<[f64; 3]>,
    /// The lobe that K is added to, where it is not that of the core properties.
    pub base_lobe: Option<BaseLobe>,
    #[serde(rename = "extensions")]
    _extensions: Option<Map<String, Value>>,
    #[serde(rename = "extras")]
    _extras: Option<Value>,
}

/// A material's own lobe.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct BaseLobe {
    /// `roughnessFactor` of the core material; 1 when absent.
    pub roughness_factor: Option<f64>,
    /// `metallicRoughnessTexture` of the core material.
    pub metallic_roughness_texture: Option<TextureInfo>,
    /// `KHR_materials_anisotropy`.
    pub anisotropy: Option<Anisotropy>,
}

/// `KHR_materials_anisotropy`.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Anisotropy {
    /// 0 when absent.
    pub anisotropy_strength: Option<f64>,
    /// In radians; 0 when absent.
    pub anisotropy_rotation: Option<f64>,
    /// Direction and strength.
    pub anisotropy_texture: Option<TextureInfo>,
}

/// A reference to a texture.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct TextureInfo {
    /// Index into `textures`.
    pub index: u32,
    #[serde(rename = "texCoord")]
    _tex_coord: Option<u32>,
    #[serde(rename = "extensions")]
    _extensions: Option<Map<String, Value>>,
    #[serde(rename = "extras")]
    _extras: Option<Value>,
}

/// `roughnessModel`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub enum RoughnessModel {
    /// (d1, d2, d3).
    CovarianceFactor,
    /// lambda_1.
    StandardDeviation,
}

impl RoughnessModel {
    fn channels(self) -> usize {
        match self {
            Self::CovarianceFactor => 3,
            Self::StandardDeviation => 1,
        }
    }
}

/// `frame`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub enum FrameName {
    /// Offsets in mesh units.
    Natural,
    /// glTF's tangent frame.
    Unit,
    /// A frame from a direction m.
    MainDirection,
}

impl RoughnessPyramid {
    /// Reads the extension object.
    ///
    /// # Errors
    /// What the schema does not allow, in words.
    pub fn read(value: &Value) -> Result<Self, String> {
        // Optional members may be absent, not null; readers of serde make no difference.
        if has_null(value) {
            return Err("null in place of a value".to_owned());
        }
        let read = Self::deserialize(value).map_err(|e| e.to_string())?;
        read.check()?;
        Ok(read)
    }

    fn check(&self) -> Result<(), String> {
        if self.correction_factor < 0.0 {
            return Err(format!("a correctionFactor of {}", self.correction_factor));
        }
        let parts = (&self.roughness_model, &self.roughness_texture, &self.roughness_min, &self.roughness_max);
        match parts {
            (None, None, None, None) => {}
            (Some(model), Some(_), Some(min), Some(max)) => {
                let channels = model.channels();
                if (min.len(), max.len()) != (channels, channels) {
                    return Err(format!(
                        "roughnessMin and roughnessMax of {} and {} numbers where the roughnessModel has {channels}",
                        min.len(),
                        max.len()
                    ));
                }
            }
            _ => {
                return Err(
                    "some but not all of roughnessModel, roughnessTexture, roughnessMin, roughnessMax".to_owned()
                );
            }
        }
        match (self.frame, self.main_direction) {
            (FrameName::MainDirection, None) => Err("the frame mainDirection without a mainDirection".to_owned()),
            (FrameName::Natural | FrameName::Unit, Some(_)) => Err("a mainDirection with another frame".to_owned()),
            _ => Ok(()),
        }
    }

    /// The textures, each with its member and the content that its provenance should name.
    pub fn textures(&self) -> Vec<(&'static str, usize, &'static str)> {
        let mut textures = vec![("offsetTexture", self.offset_texture.index as usize, "offset")];
        if let (Some(texture), Some(model)) = (&self.roughness_texture, self.roughness_model) {
            let content = match model {
                RoughnessModel::CovarianceFactor => "factor",
                RoughnessModel::StandardDeviation => "lambda1",
            };
            textures.push(("roughnessTexture", texture.index as usize, content));
        }
        textures
    }
}

/// Whether a member that the schema describes is null.
fn has_null(value: &Value) -> bool {
    let is_null = |(key, value): (&String, &Value)| match key.as_str() {
        "extras" => false,
        "extensions" => value.is_null(),
        _ => value.is_null() || has_null(value),
    };
    value.as_object().is_some_and(|members| members.iter().any(is_null))
}
