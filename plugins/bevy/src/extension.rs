//! The extension object of a material, read and checked.

use bevy::math::{Affine2, Mat3, Vec2, Vec3};
use serde::Deserialize;
use serde_json::Value;

/// Name of the glTF extension.
pub const EXTENSION: &str = "ROUGHCAST_materials_roughness_pyramid";

/// The format version that the plugin reads.
const FORMAT_VERSION: u32 = 2;

/// The extension object of the schema (`schemas/` of Roughcast).
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Extension {
    pub offset_texture: TextureInfo,
    /// 3 where z is stored, 2 where the shader rebuilds z from x and y.
    offset_channels: u32,
    /// What multiplies the slopes of the stored normals.
    pub offset_scale: Vec2,
    pub roughness_model: Option<Model>,
    pub roughness_texture: Option<TextureInfo>,
    roughness_min: Option<Vec<f32>>,
    roughness_max: Option<Vec<f32>>,
    pub correction_factor: f32,
    pub frame: Frame,
    pub main_direction: Option<Vec3>,
    pub base_lobe: Option<BaseLobe>,
}

/// The base lobe, where the core material is roughened.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct BaseLobe {
    #[serde(default = "one")]
    pub roughness_factor: f32,
    pub metallic_roughness_texture: Option<TextureInfo>,
    #[serde(default)]
    pub anisotropy: Anisotropy,
}

/// KHR_materials_anisotropy.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Anisotropy {
    #[serde(rename = "anisotropyStrength")]
    pub strength: f32,
    #[serde(rename = "anisotropyRotation")]
    pub rotation: f32,
    #[serde(rename = "anisotropyTexture")]
    pub texture: Option<TextureInfo>,
}

fn one() -> f32 {
    1.0
}

/// What the roughness texture holds.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Hash)]
#[serde(rename_all = "camelCase")]
pub enum Model {
    /// D = [[d1, d2], [0, d3]], with K = D D^T.
    CovarianceFactor,
    /// lambda_1, with K = lambda_1^2 1.
    StandardDeviation,
}

/// The frame in which offsets and roughness are given.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Hash)]
#[serde(rename_all = "camelCase")]
pub enum Frame {
    /// The geometry's own derivatives.
    Natural,
    /// glTF's tangent frame.
    Unit,
    /// e1 = m x n, e2 = n x e1.
    MainDirection,
}

/// glTF's textureInfo.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct TextureInfo {
    pub index: usize,
    #[serde(default)]
    tex_coord: u32,
    #[serde(default)]
    extensions: TextureInfoExtensions,
}

#[derive(Clone, Debug, Default, Deserialize)]
struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: Option<Transform>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Transform {
    offset: Vec2,
    rotation: f32,
    scale: Vec2,
    tex_coord: Option<u32>,
}

impl Default for Transform {
    fn default() -> Self {
        Self { offset: Vec2::ZERO, rotation: 0.0, scale: Vec2::ONE, tex_coord: None }
    }
}

impl Extension {
    /// Reads and checks the object. The error names the wrong property.
    pub fn read(definition: &Value) -> Result<Self, String> {
        // Objects of other versions may have other members, so that the version comes first.
        match definition.get("formatVersion") {
            Some(version) if *version == FORMAT_VERSION => {}
            found => {
                let found = found.map_or_else(|| "none".to_owned(), Value::to_string);
                return Err(format!("formatVersion: expected {FORMAT_VERSION}, found {found}"));
            }
        }
        let extension = Self::deserialize(definition).map_err(|error| error.to_string())?;
        let channels = extension.roughness_model.map(|model| match model {
            Model::CovarianceFactor => 3,
            Model::StandardDeviation => 1,
        });
        for (name, values) in [("roughnessMin", &extension.roughness_min), ("roughnessMax", &extension.roughness_max)] {
            let found = values.as_ref().map(Vec::len);
            if found != channels {
                return Err(format!(
                    "{name}: expected {} number(s), found {}",
                    channels.unwrap_or(0),
                    found.unwrap_or(0)
                ));
            }
        }
        if extension.roughness_model.is_some() != extension.roughness_texture.is_some() {
            return Err("expected roughnessTexture with roughnessModel, found one of them".to_owned());
        }
        if ![2, 3].contains(&extension.offset_channels) {
            return Err(format!("offsetChannels: expected 2 or 3, found {}", extension.offset_channels));
        }
        if extension.correction_factor < 0.0 {
            let found = extension.correction_factor;
            return Err(format!("correctionFactor: expected a number of at least 0, found {found}"));
        }
        if (extension.frame == Frame::MainDirection) != extension.main_direction.is_some() {
            return Err("expected mainDirection with the frame of that name, found one of them".to_owned());
        }
        Ok(extension)
    }

    /// Returns whether the offset texture stores z.
    pub fn has_z(&self) -> bool {
        self.offset_channels == 3
    }

    /// Returns all textures of the extension.
    pub fn textures(&self) -> impl Iterator<Item = &TextureInfo> {
        let base = self.base_lobe.iter().flat_map(|lobe| [&lobe.metallic_roughness_texture, &lobe.anisotropy.texture]);
        [Some(&self.offset_texture), self.roughness_texture.as_ref()]
            .into_iter()
            .chain(base.map(Option::as_ref))
            .flatten()
    }

    /// Returns the values that texels of 0 and 1 of the roughness texture stand for, with 0 for absent channels.
    pub fn roughness_range(&self) -> [Vec3; 2] {
        [&self.roughness_min, &self.roughness_max].map(|values| {
            let value = |c: usize| values.as_ref().and_then(|v| v.get(c)).copied().unwrap_or(0.0);
            Vec3::new(value(0), value(1), value(2))
        })
    }
}

impl TextureInfo {
    /// Returns n of TEXCOORD_n.
    pub fn channel(&self) -> u32 {
        self.extensions.transform.as_ref().and_then(|t| t.tex_coord).unwrap_or(self.tex_coord)
    }

    /// Returns KHR_texture_transform as a matrix: translation * rotation * scale.
    pub fn uv_transform(&self) -> Mat3 {
        let Transform { offset, rotation, scale, .. } = self.extensions.transform.clone().unwrap_or_default();
        // glTF's rotations are clockwise, since v points down.
        Affine2::from_scale_angle_translation(scale, -rotation, offset).into()
    }
}

#[cfg(test)]
mod tests;
