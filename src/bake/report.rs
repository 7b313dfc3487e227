//! What a bake did, as data (`schemas/report.schema.json`).

use serde::Serialize;

use super::pyramids::Range;
use super::settings::Model;
use super::view::Finest;
use crate::choose::ModelLoss;
use crate::gltf::material::{LayerKind, Material};

/// What was done for one asset.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct AssetReport {
    /// Layers of materials, in the order of the file.
    pub layers: Vec<LayerReport>,
    /// Textures that were written.
    pub textures: Vec<TextureReport>,
}

/// What was done for one layer of a material.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct LayerReport {
    /// Index into `materials`.
    pub index: usize,
    /// Name of the material, or `material <index>`.
    pub material: String,
    /// Which of its lobes.
    pub layer: LayerKind,
    /// What is modelled of the lost bumps; absent when nothing was baked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<Model>,
    /// What smaller models would lose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loss: Option<ModelLoss>,
    /// The finest level of its bump map that the view can sample; absent where no view is told, or no one can tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finest: Option<Finest>,
    /// What was left as it was, or is not as exact as it could be, and why.
    pub notes: Vec<String>,
}

impl LayerReport {
    /// Of a material without bumps.
    pub fn flat(material: &Material) -> Self {
        Self {
            index: material.index,
            material: material.name.clone(),
            layer: LayerKind::Base,
            model: None,
            loss: None,
            finest: None,
            notes: vec!["no normal or height map: left as it was".to_owned()],
        }
    }
}

/// A texture that was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct TextureReport {
    /// Path relative to the asset.
    pub path: String,
    /// What its texels are.
    pub content: Content,
    /// Columns of level 0.
    pub width: u32,
    /// Rows of level 0.
    pub height: u32,
    /// Mip levels.
    pub levels: usize,
    /// Finer levels that were left out.
    #[serde(skip_serializing_if = "is_zero")]
    pub trimmed: usize,
    /// Bytes of the KTX2 file.
    pub bytes: usize,
    /// What texels of 0 and 1 stand for; only for the pyramid profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<Range>,
}

fn is_zero(n: &usize) -> bool {
    *n == 0
}

/// What the texels of a baked texture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Content {
    /// Unit normals.
    Normal,
    /// Folded roughness in green.
    Roughness,
    /// Direction and strength of anisotropy.
    Anisotropy,
    /// (f_u, f_v).
    Offset,
    /// D.
    Factor,
    /// lambda_1.
    Lambda1,
}

impl Content {
    /// As in file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Roughness => "roughness",
            Self::Anisotropy => "anisotropy",
            Self::Offset => "offset",
            Self::Factor => "factor",
            Self::Lambda1 => "lambda1",
        }
    }
}
