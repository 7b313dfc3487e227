//! The extension object of a material, read and checked.

use bevy::math::{Affine2, Mat3, Vec2, Vec3};
use serde::Deserialize;
use serde_json::Value;

/// Name of the glTF extension.
pub const EXTENSION: &str = "ROUGHCAST_materials_roughness_pyramid";

/// The format version that the plugin reads.
const FORMAT_VERSION: u32 = 1;

/// The extension object of the schema (`schemas/` of Roughcast).
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Extension {
    pub offset_texture: TextureInfo,
    pub offset_min: Vec2,
    pub offset_max: Vec2,
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
    /// lambda_1, the square root of K's larger eigenvalue.
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
        if extension.correction_factor < 0.0 {
            let found = extension.correction_factor;
            return Err(format!("correctionFactor: expected a number of at least 0, found {found}"));
        }
        if (extension.frame == Frame::MainDirection) != extension.main_direction.is_some() {
            return Err("expected mainDirection with the frame of that name, found one of them".to_owned());
        }
        Ok(extension)
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
mod tests {
    use super::*;
    use serde_json::json;

    fn definition() -> Value {
        json!({
            "formatVersion": 1,
            "offsetTexture": { "index": 1, "extensions": { "KHR_texture_transform": { "scale": [2, 3], "texCoord": 1 } } },
            "offsetMin": [-1, -2],
            "offsetMax": [1, 2],
            "roughnessModel": "covarianceFactor",
            "roughnessTexture": { "index": 2 },
            "roughnessMin": [0, -0.5, 0],
            "roughnessMax": [0.5, 0.5, 0.25],
            "correctionFactor": 0.8,
            "frame": "unit",
        })
    }

    #[test]
    fn reads_what_the_schema_allows() {
        let extension = Extension::read(&definition()).unwrap();
        assert_eq!(extension.roughness_range(), [Vec3::new(0.0, -0.5, 0.0), Vec3::new(0.5, 0.5, 0.25)]);
        assert_eq!(extension.offset_texture.channel(), 1);
        assert_eq!(extension.offset_texture.uv_transform() * Vec3::ONE, Vec3::new(2.0, 3.0, 1.0));
        let smooth = json!({
            "formatVersion": 1,
            "offsetTexture": { "index": 0 }, "offsetMin": [0, 0], "offsetMax": [1, 1], "correctionFactor": 1,
            "frame": "mainDirection", "mainDirection": [0, 1, 0],
        });
        assert_eq!(Extension::read(&smooth).unwrap().roughness_range(), [Vec3::ZERO; 2]);
    }

    #[test]
    fn a_base_lobe_has_the_defaults_of_gltf() {
        let mut definition = definition();
        definition["baseLobe"] = json!({ "metallicRoughnessTexture": { "index": 5 } });
        let extension = Extension::read(&definition).unwrap();
        let indices: Vec<usize> = extension.textures().map(|info| info.index).collect();
        assert_eq!(indices, [1, 2, 5]);
        let lobe = extension.base_lobe.unwrap();
        assert_eq!((lobe.roughness_factor, lobe.anisotropy.strength), (1.0, 0.0));
    }

    #[test]
    fn names_what_the_schema_does_not_allow() {
        let cases = [
            ("formatVersion", json!(null), "formatVersion: expected 1, found none"),
            ("formatVersion", json!(2), "formatVersion: expected 1, found 2"),
            ("offsetTexture", json!(null), "offsetTexture"),
            ("offsetMin", json!([1]), "length 1"),
            ("roughnessModel", json!("variance"), "unknown variant `variance`"),
            ("roughnessTexture", json!(null), "roughnessTexture with roughnessModel"),
            ("roughnessMax", json!([1, 1]), "roughnessMax: expected 3 number(s), found 2"),
            ("roughnessMin", json!(null), "roughnessMin: expected 3 number(s), found 0"),
            ("correctionFactor", json!(-1), "at least 0"),
            ("frame", json!("mainDirection"), "mainDirection"),
        ];
        for (name, value, expected) in cases {
            let mut definition = definition();
            if value.is_null() {
                definition.as_object_mut().unwrap().remove(name);
            } else {
                definition[name] = value;
            }
            let found = Extension::read(&definition).unwrap_err();
            assert!(found.contains(expected), "{name}: {found}");
        }
    }
}
