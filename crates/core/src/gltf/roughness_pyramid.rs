//! `ROUGHCAST_materials_roughness_pyramid`, the extension that tells a plugin what it needs: one structure that is
//! written and read, as strictly as its schema in `schemas/` says.
//!
//! Reading does not use the schema itself: a validator in the product would bring a regular expression engine and some
//! 30 crates along. A test validates the same objects against the schema and expects the same verdicts.

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};

use crate::bump::FrameKind;

/// Name of the extension.
pub const EXTENSION: &str = "ROUGHCAST_materials_roughness_pyramid";

/// The `formatVersion` of extension objects that this version of the crate writes and reads. A change that plugins must
/// know of increases it.
pub const FORMAT_VERSION: u32 = 2;

/// The members that refer to textures: offsets, and D or lambda_1.
const TEXTURES: [&str; 2] = ["offsetTexture", "roughnessTexture"];

/// The extension object of a material. Numbers are written as `f32`, as short as they can be, and read as `f64`.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct RoughnessPyramid<N = f64> {
    /// The format version, [`FORMAT_VERSION`].
    pub format_version: u32,
    /// Texture of the unit normals of scaled offsets.
    pub offset_texture: TextureInfo,
    /// Channels of the offset texture: 3 with z, 2 without it.
    pub offset_channels: u32,
    /// What multiplies the slopes of the normals.
    pub offset_scale: [N; 2],
    /// What the roughness texture holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roughness_model: Option<RoughnessModel>,
    /// Texture of D or lambda_1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roughness_texture: Option<TextureInfo>,
    /// Values that a texel of 0 stands for, one for each channel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roughness_min: Option<Vec<N>>,
    /// Values that a texel of 1 stands for, one for each channel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roughness_max: Option<Vec<N>>,
    /// The correction factor c.
    pub correction_factor: N,
    /// The frame of the offsets.
    #[serde(with = "frame_name")]
    pub frame: FrameKind,
    /// The direction m, in the space of the mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub main_direction: Option<[N; 3]>,
    /// The lobe that K is added to, if the core properties describe another lobe.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_lobe: Option<BaseLobe<N>>,
    /// Extensions of the extension, which are not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<Map<String, Value>>,
    /// Data of applications, which are not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extras: Option<Value>,
}

/// The lobe that a material had before the portable profile roughened it. A plugin adds K to this lobe: with the
/// roughened lobe the bumps would count twice.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct BaseLobe<N = f64> {
    /// `roughnessFactor` of the core material; 1 if it is absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roughness_factor: Option<N>,
    /// `metallicRoughnessTexture` of the core material.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub metallic_roughness_texture: Option<TextureInfo>,
    /// `KHR_materials_anisotropy`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anisotropy: Option<Anisotropy<N>>,
}

/// `KHR_materials_anisotropy`.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Anisotropy<N = f64> {
    /// The strength; 0 if it is absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anisotropy_strength: Option<N>,
    /// The rotation in radians; 0 if it is absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anisotropy_rotation: Option<N>,
    /// Texture of direction and strength.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anisotropy_texture: Option<TextureInfo>,
}

/// A reference to a texture.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct TextureInfo {
    /// Index into `textures`.
    #[serde(deserialize_with = "index")]
    pub index: usize,
    /// The n of the attribute `TEXCOORD_n`.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "is_zero")]
    pub tex_coord: u64,
    /// `KHR_texture_transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<Map<String, Value>>,
    /// Data of applications, which are not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extras: Option<Value>,
}

/// Reads an index: the schema allows 32 bits.
fn index<'de, D: Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
    u32::deserialize(deserializer).map(|index| index as usize)
}

/// Reads the number of an attribute: the schema allows 32 bits.
fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    u32::deserialize(deserializer).map(u64::from)
}

fn is_zero(number: &u64) -> bool {
    *number == 0
}

/// `roughnessModel`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub enum RoughnessModel {
    /// (d1, d2, d3).
    CovarianceFactor,
    /// lambda_1.
    StandardDeviation,
}

impl RoughnessModel {
    /// Returns the number of channels of the roughness texture.
    pub fn channels(self) -> usize {
        match self {
            Self::CovarianceFactor => 3,
            Self::StandardDeviation => 1,
        }
    }
}

/// Reads and writes a [`FrameKind`] under the name that the extension has for it.
mod frame_name {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    use crate::bump::FrameKind;

    const NAMES: [&str; 3] = ["natural", "unit", "mainDirection"];

    pub fn serialize<S: Serializer>(kind: &FrameKind, serializer: S) -> Result<S::Ok, S::Error> {
        let [natural, unit, main_direction] = NAMES;
        serializer.serialize_str(match kind {
            FrameKind::Natural => natural,
            FrameKind::Unit => unit,
            FrameKind::MainDirection => main_direction,
        })
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<FrameKind, D::Error> {
        let name = String::deserialize(deserializer)?;
        let kinds = [FrameKind::Natural, FrameKind::Unit, FrameKind::MainDirection];
        let kind = NAMES.into_iter().zip(kinds).find(|(known, _)| *known == name);
        kind.map(|(_, kind)| kind).ok_or_else(|| D::Error::unknown_variant(&name, &NAMES))
    }
}

impl RoughnessPyramid {
    /// Reads the extension object.
    ///
    /// # Errors
    /// What the schema does not allow, in words.
    pub fn read(value: &Value) -> Result<Self, String> {
        // Optional members may be absent, not null; serde makes no difference between both.
        if has_null(value) {
            return Err("null in place of a value".to_owned());
        }
        // Objects of other versions may have other members, so that the version comes first.
        match value.get("formatVersion") {
            Some(version) if *version == FORMAT_VERSION => {}
            Some(version) => return Err(format!("formatVersion {version} instead of {FORMAT_VERSION}")),
            None => return Err(format!("no formatVersion, which should be {FORMAT_VERSION}")),
        }
        let read = Self::deserialize(value).map_err(|e| e.to_string())?;
        read.check()?;
        Ok(read)
    }

    /// Checks what the types leave open.
    fn check(&self) -> Result<(), String> {
        if ![2, 3].contains(&self.offset_channels) {
            return Err(format!("offsetChannels {} instead of 2 or 3", self.offset_channels));
        }
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
            (FrameKind::MainDirection, None) => Err("the frame mainDirection without a mainDirection".to_owned()),
            (FrameKind::Natural | FrameKind::Unit, Some(_)) => Err("a mainDirection with another frame".to_owned()),
            _ => Ok(()),
        }
    }

    /// Returns whether the offset texture stores z.
    pub fn has_z(&self) -> bool {
        self.offset_channels == 3
    }

    /// Returns the textures, each with its member and the content that its provenance should name.
    pub fn textures(&self) -> Vec<(&'static str, usize, &'static str)> {
        let [offset, roughness] = TEXTURES;
        let mut textures = vec![(offset, self.offset_texture.index, "offset")];
        if let (Some(texture), Some(model)) = (&self.roughness_texture, self.roughness_model) {
            let content = match model {
                RoughnessModel::CovarianceFactor => "factor",
                RoughnessModel::StandardDeviation => "lambda1",
            };
            textures.push((roughness, texture.index, content));
        }
        textures
    }
}

/// Returns whether a member that the schema describes is null.
fn has_null(value: &Value) -> bool {
    let is_null = |(key, value): (&String, &Value)| match key.as_str() {
        "extras" => false,
        "extensions" => value.is_null(),
        _ => value.is_null() || has_null(value),
    };
    value.as_object().is_some_and(|members| members.iter().any(is_null))
}
