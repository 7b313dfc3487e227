//! What a bake did, as data (`schemas/report.schema.json`).

mod reason;

pub use reason::{Evidence, Reason};

use serde::{Deserialize, Serialize};

use crate::gltf::material::{LayerKind, Material};
use crate::material::Range;
use crate::settings::{Finest, Model, Settings};

/// What was done for one asset.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct AssetReport {
    /// Layers of materials, in the order of the file.
    pub layers: Vec<LayerReport>,
    /// Textures that were written.
    pub textures: Vec<TextureReport>,
}

/// What was done for one layer of a material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// The candidates that were judged; absent where the layer's own lobe is not known texel by texel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<Choice>,
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
            choice: None,
            finest: None,
            notes: vec!["no normal or height map: left as it was".to_owned()],
        }
    }
}

/// How the roughness data of a layer was chosen, so that the choice can be audited.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Choice {
    /// The finest level that can be sampled, to which the first error of each candidate belongs.
    pub finest: usize,
    /// In the order of rising cost: shader work, then bytes.
    pub candidates: Vec<Candidate>,
    /// Index of the one that was taken.
    pub chosen: usize,
    /// Levels at which it exceeds the bound.
    pub misses: Vec<Miss>,
}

/// Roughness data that a layer might have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Candidate {
    /// What it models.
    pub model: Model,
    /// The level that becomes level 0 of its textures: 1 for half, 2 for a quarter of the size.
    pub first: usize,
    /// Bytes of its textures on the GPU; 0 for none, which keeps the material's own.
    pub bytes: u64,
    /// Mean lobe error of the levels from `finest` on, as decoded.
    pub errors: Vec<f32>,
}

/// A level at which the bound is exceeded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Miss {
    /// The level.
    pub level: usize,
    /// Mean lobe error there.
    pub error: f32,
    /// What the best single lobe would leave of it.
    pub oracle: f32,
    /// Why.
    pub reason: Reason,
}

impl Choice {
    /// The candidate that was taken.
    pub fn taken(&self) -> Option<&Candidate> {
        self.candidates.get(self.chosen)
    }

    /// The largest error of what was taken and of what was not, for a person: ` (error 0.12; isotropic 0.41, none 0.43)`.
    pub fn summary(&self) -> String {
        let worst = |c: &Candidate| c.errors.iter().copied().fold(0.0, f32::max);
        let Some(taken) = self.taken() else { return String::new() };
        let finest = self.candidates.iter().map(|c| c.first).min().unwrap_or(0);
        let size = ["", ", half size", ", quarter size"].get(taken.first - finest).copied().unwrap_or_default();
        // Of the other models the full size only.
        let others = self.candidates.iter().rev().filter(|c| c.model != taken.model && c.first == finest);
        let others: Vec<String> = others.map(|c| format!("{} {:.2}", c.model.name(), worst(c))).collect();
        let others = if others.is_empty() { String::new() } else { format!("; {}", others.join(", ")) };
        format!("{size} (error {:.2}{others})", worst(taken))
    }

    /// The bound and the levels that miss it, in a sentence; `None` when none does.
    pub fn warning(&self, settings: &Settings) -> Option<String> {
        let worst = self.misses.iter().max_by(|a, b| a.error.total_cmp(&b.error))?;
        let mut reasons: Vec<Reason> = self.misses.iter().map(|m| m.reason).collect();
        reasons.sort();
        reasons.dedup();
        let levels = |of: &dyn Fn(&Miss) -> bool| ranges(self.misses.iter().filter(|m| of(m)).map(|m| m.level));
        let all = levels(&|_| true);
        let why = |reason: &Reason| match reasons.len() {
            1 => reason.text().to_owned(),
            _ => format!("{} ({})", reason.text(), levels(&|m| m.reason == *reason)),
        };
        let why: Vec<String> = reasons.iter().map(why).collect();
        Some(format!(
            "lobe error above {} at level {all}, most at {}: {:.2} where the best lobe has {:.2}; {}",
            settings.max_error,
            worst.level,
            worst.error,
            worst.oracle,
            why.join("; ")
        ))
    }
}

/// `2-5, 7`.
fn ranges(numbers: impl Iterator<Item = usize>) -> String {
    let mut ranges: Vec<(usize, usize)> = Vec::new();
    for n in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == n => *last = n,
            _ => ranges.push((n, n)),
        }
    }
    let text =
        |(first, last): &(usize, usize)| if first == last { first.to_string() } else { format!("{first}-{last}") };
    ranges.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// A texture that was written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    #[serde(default, skip_serializing_if = "is_zero")]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Content {
    /// Unit normals.
    Normal,
    /// RoughenedTextures roughness in green.
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
