//! The report of a bake, as data. `schemas/report.schema.json` describes it as JSON.

mod format;
mod map;
mod reason;
mod run;

pub use format::{FormatError, check_format};
pub use map::{MAP_FORMAT, MapReport};
pub use reason::{Evidence, Reason};
pub use run::{AssetOutcome, Counts, Origin, PartAsset, PartReport, REPORT_FORMAT, ReportError, RunReport, Status};

use std::ops::Add;

use serde::{Deserialize, Serialize};

use crate::gltf::material::{LayerKind, Material};
use crate::material::Range;
use crate::note::{self, Note};
use crate::settings::{DiffuseLight, Finest, Model, Settings};

/// The report of one asset.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct AssetReport {
    /// Layers of materials, in the order of the file.
    pub layers: Vec<LayerReport>,
    /// The textures that were made.
    pub textures: Vec<TextureReport>,
    /// What the bytes of the document and of the new files hold.
    pub sizes: OutputSizes,
}

impl AssetReport {
    /// Returns whether a layer was baked to anisotropic lobes.
    pub fn has_anisotropic_lobes(&self) -> bool {
        self.layers.iter().any(|layer| layer.model == Some(Model::Anisotropic))
    }
}

/// Bytes of outputs by what they hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct OutputSizes {
    /// KTX2 textures.
    pub ktx2: u64,
    /// PNG copies of level 0 of these textures, for engines without KTX2.
    pub fallback: u64,
    /// All other images.
    pub images: u64,
    /// Buffers without their images: meshes, skins and animations.
    pub geometry: u64,
    /// The JSON of the document, and the headers of a .glb.
    pub json: u64,
}

impl OutputSizes {
    /// Returns the bytes of all outputs together. Sums stay at the largest number that they can hold, since sizes may
    /// come from a cache that others write to.
    pub fn total(&self) -> u64 {
        [self.fallback, self.images, self.geometry, self.json].into_iter().fold(self.ktx2, u64::saturating_add)
    }
}

impl Add for OutputSizes {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            ktx2: self.ktx2.saturating_add(other.ktx2),
            fallback: self.fallback.saturating_add(other.fallback),
            images: self.images.saturating_add(other.images),
            geometry: self.geometry.saturating_add(other.geometry),
            json: self.json.saturating_add(other.json),
        }
    }
}

/// The report of one layer of a material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct LayerReport {
    /// Index of the material in `materials`.
    pub index: usize,
    /// Name of the material, or `material <index>` if it has none.
    pub material: String,
    /// Which layer of the material.
    pub layer: LayerKind,
    /// What is modelled of the lost bumps; absent if nothing was baked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<Model>,
    /// How the model was chosen; absent if the base lobe is not known texel by texel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<Choice>,
    /// The finest level of the bump map that the view can sample; absent if no view is given or the meshes do not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finest: Option<Finest>,
    /// What was left unchanged or is not as exact as it could be, and why.
    pub notes: Vec<Note>,
}

impl LayerReport {
    /// Returns the report of a material without bumps.
    pub fn flat(material: &Material) -> Self {
        Self {
            index: material.index,
            material: material.name.clone(),
            layer: LayerKind::Base,
            model: None,
            choice: None,
            finest: None,
            notes: vec![note::no_bump_map()],
        }
    }
}

/// How the roughness data of a layer was chosen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Choice {
    /// The finest level that can be sampled. The first error of each candidate belongs to this level.
    pub finest: usize,
    /// The candidates by model, from none to anisotropic, and then by bytes.
    pub candidates: Vec<Candidate>,
    /// Index of the chosen candidate.
    pub chosen: usize,
    /// Levels at which the chosen candidate exceeds the error bound.
    pub misses: Vec<Miss>,
}

/// A candidate for the roughness data of a layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Candidate {
    /// The model.
    pub model: Model,
    /// The level that becomes level 0 of the textures: 1 for half the size, 2 for a quarter.
    pub first: usize,
    /// Bytes of the textures on the GPU; 0 for model none, which keeps the material's own textures.
    pub bytes: u64,
    /// Mean lobe error of the decoded levels, from `finest` on.
    pub errors: Vec<f32>,
    /// Levels that keep the base lobe, since the roughened lobes would have a larger error there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub base_levels: Vec<usize>,
}

/// A setting is worth a note if it may lower the largest lobe error by this much.
const NOTICED: f32 = 0.02;

/// A level at which the chosen candidate exceeds the error bound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Miss {
    /// The level.
    pub level: usize,
    /// Mean lobe error of the level.
    pub error: f32,
    /// Mean lobe error of the best single lobe.
    pub oracle: f32,
    /// Why the bound is exceeded.
    pub reason: Reason,
}

impl Choice {
    /// Returns the chosen candidate.
    pub fn taken(&self) -> Option<&Candidate> {
        self.candidates.get(self.chosen)
    }

    /// Returns the largest errors of the chosen candidate and of the other models, as text:
    /// ` (error 0.12; isotropic 0.41, none 0.43)`.
    pub fn summary(&self) -> String {
        let worst = |c: &Candidate| c.errors.iter().copied().fold(0.0, f32::max);
        let Some(taken) = self.taken() else { return String::new() };
        let finest = self.candidates.iter().map(|c| c.first).min().unwrap_or(0);
        let size = ["", ", half size", ", quarter size"].get(taken.first - finest).copied().unwrap_or_default();
        // Other models are shown at full size only.
        let others = self.candidates.iter().rev().filter(|c| c.model != taken.model && c.first == finest);
        let others: Vec<String> = others.map(|c| format!("{} {:.2}", c.model.name(), worst(c))).collect();
        let others = if others.is_empty() { String::new() } else { format!("; {}", others.join(", ")) };
        format!("{size} (error {:.2}{others})", worst(taken))
    }

    /// Returns the note on the levels that exceed the error bound of `settings`; `None` if no level does. The note asks
    /// for action if a setting can lower the largest error.
    pub fn note(&self, settings: &Settings) -> Option<Note> {
        let worst = self.misses.iter().max_by(|a, b| a.error.total_cmp(&b.error))?;
        let levels = |of: &dyn Fn(&Miss) -> bool| ranges(self.misses.iter().filter(|m| of(m)).map(|m| m.level));
        let (noun, verb) = if self.misses.len() == 1 { ("level", "misses") } else { ("levels", "miss") };
        let missed = format!(
            "{noun} {} {verb} --max-error {} (worst {:.3}, at level {}; the best lobe has {:.3} there)",
            levels(&|_| true),
            settings.max_error,
            worst.error,
            worst.level,
            worst.oracle
        );
        if let Some(remedy) = self.remedy(worst, settings) {
            return Some(note::missed_bound(format!("{missed}; to come closer, use {remedy}"), true));
        }
        let mut reasons: Vec<Reason> = self.misses.iter().map(|m| m.reason).collect();
        reasons.sort();
        reasons.dedup();
        let why = |reason: &Reason| match reasons.len() {
            1 => reason.text().to_owned(),
            _ => format!("{} ({})", reason.text(), levels(&|m| m.reason == *reason)),
        };
        let why: Vec<String> = reasons.iter().map(why).collect();
        Some(note::missed_bound(format!("{missed}: {}", why.join("; ")), false))
    }

    /// Returns what the user can do about the `worst` level, as the object of "use".
    fn remedy(&self, worst: &Miss, settings: &Settings) -> Option<String> {
        let closer = if settings.model == Model::Auto { None } else { self.closer_model(worst.level) };
        let is_noticed = worst.error - worst.oracle >= NOTICED;
        worst.reason.remedy(settings, closer).filter(|_| is_noticed)
    }

    /// Returns the model with the smallest error at `level`, if that is another model than the chosen one.
    fn closer_model(&self, level: usize) -> Option<Model> {
        let error = |c: &Candidate| level.checked_sub(self.finest).and_then(|i| c.errors.get(i)).copied();
        let taken = self.taken()?;
        let known = self.candidates.iter().filter_map(|c| Some((c.model, error(c)?)));
        let (model, smallest) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
        (model != taken.model && smallest < error(taken)?).then_some(model)
    }
}

/// Returns numbers as text, such as `2-5, 7`.
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

/// The report of one texture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct TextureReport {
    /// Path relative to the document, or of the file of a standalone map. In a .glb it is the path that the file would
    /// have beside a .gltf.
    pub path: String,
    /// What the texels are.
    pub content: Content,
    /// Columns of level 0.
    pub width: u32,
    /// Rows of level 0.
    pub height: u32,
    /// Number of mip levels.
    pub levels: usize,
    /// Number of finer levels that were left out.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub trimmed: usize,
    /// Bytes of the KTX2 file.
    pub bytes: usize,
    /// What texels of 0 and 1 stand for; only in textures of D and lambda_1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<Range>,
    /// What multiplies the slopes of the stored normals; only in textures of offsets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f32>,
    /// The light that its mips are darkened for; only in textures of base colour, absent if mips are means.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diffuse_light: Option<DiffuseLight>,
}

fn is_zero(n: &usize) -> bool {
    *n == 0
}

/// What the texels of a baked texture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub enum Content {
    /// Unit normals.
    Normal,
    /// Roughness in green; occlusion and metalness stay in red and blue.
    Roughness,
    /// Roughness of the lobes that the pyramid profile adds K to, as in [`Self::Roughness`].
    BaseRoughness,
    /// Direction in red and green, and strength in blue, of the anisotropy.
    Anisotropy,
    /// Offsets (f_u, f_v), as unit normals of scaled offsets.
    Offset,
    /// The factor D.
    Factor,
    /// The standard deviation lambda_1.
    Lambda1,
    /// sRGB colours, with alpha if materials blend or mask by it.
    Colour,
    /// Linear values of a texture that the bake does not change, such as occlusion.
    Linear,
}

impl Content {
    /// Returns the name, as file names have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Roughness => "roughness",
            Self::BaseRoughness => "baseRoughness",
            Self::Anisotropy => "anisotropy",
            Self::Offset => "offset",
            Self::Factor => "factor",
            Self::Lambda1 => "lambda1",
            Self::Colour => "colour",
            Self::Linear => "linear",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::uastc::Effort;

    fn choice(misses: Vec<Miss>) -> Choice {
        let candidate =
            |model, error| Candidate { model, first: 0, bytes: 0, errors: vec![error; 3], base_levels: Vec::new() };
        let candidates = vec![candidate(Model::Isotropic, 0.2), candidate(Model::Anisotropic, 0.15)];
        Choice { finest: 0, candidates, chosen: 0, misses }
    }

    #[test]
    fn missed_bounds_ask_for_action_where_a_setting_lowers_the_largest_error() {
        let note = |level, error, reason| {
            let other = Miss { level: 1, error: 0.15, oracle: 0.05, reason: Reason::Fit };
            let choice = choice(vec![other, Miss { level, error, oracle: 0.1, reason }]);
            choice.note(&Settings::default()).expect("a note")
        };
        for reason in [Reason::Isotropic, Reason::Fit] {
            assert!(note(2, 0.2, reason).asks_for_action, "{reason:?}");
        }
        let best = [Reason::Encoding, Reason::AlphaAboveOne, Reason::TwoPeaked, Reason::Steep, Reason::NoSingleLobe];
        for reason in best {
            let note = note(2, 0.2, reason);
            assert!(!note.asks_for_action, "{note}");
            assert!(note.text.ends_with("; the fit does not reach the best lobe (1)"), "{note}");
        }
    }

    #[test]
    fn missed_bounds_ask_for_nothing_where_little_can_be_gained() {
        for (error, asks) in [(0.111, false), (0.13, true)] {
            let miss = Miss { level: 2, error, oracle: 0.1, reason: Reason::Fit };
            let note = choice(vec![miss]).note(&Settings::default()).expect("a note");
            assert_eq!(note.asks_for_action, asks, "{note}");
        }
    }

    #[test]
    fn missed_bounds_name_the_remedy() {
        let misses = vec![
            Miss { level: 0, error: 0.12, oracle: 0.1, reason: Reason::Encoding },
            Miss { level: 2, error: 0.2, oracle: 0.1, reason: Reason::Fit },
        ];
        let choice = choice(misses);
        let settings = Settings::default();
        let missed = "levels 0, 2 miss --max-error 0.1 (worst 0.200, at level 2; the best lobe has 0.100 there)";
        for (settings, end) in [
            (settings, "; to come closer, use --quality best"),
            (
                settings.with_model(Model::Isotropic),
                "; to come closer, use --model anisotropic if the engine shows it correctly",
            ),
            (settings.with_quality(Effort::Best), ": lost in encoding (0); the fit does not reach the best lobe (2)"),
        ] {
            let note = choice.note(&settings).expect("a note");
            assert_eq!(note.text, format!("{missed}{end}"));
            assert_eq!(note.asks_for_action, end.contains("use"), "{note}");
        }
    }
}
