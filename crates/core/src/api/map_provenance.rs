//! The provenance of the textures of a standalone map.

use serde::Serialize;

use super::BumpTexels;
use crate::bake::EncodedTexture;
use crate::bump::NormalLayout;
use crate::ktx2::{Key, Provenance, SourceDigest};
use crate::material::Range;
use crate::mip::Wrap;
use crate::settings::{Model, RecordedSettings, Settings};

/// How the images of a standalone map are read, for the provenance of its textures.
#[derive(Clone, Debug)]
pub struct MapProvenance<'a> {
    /// What the texels of the image are.
    pub texels: BumpTexels,
    /// The layer of an EXR file, or the channel as `layer.channel`.
    pub layer: Option<&'a str>,
    /// The factor of the base roughness, if it is known.
    pub roughness_factor: Option<f32>,
    /// The digests of the image files.
    pub sources: Vec<SourceDigest>,
}

impl MapProvenance<'_> {
    /// Returns the keys of the KTX2 file of `texture`: its provenance, unless the settings leave it out.
    pub fn keys(&self, texture: &EncodedTexture, model: Model, settings: &Settings) -> Vec<Key> {
        if !settings.provenance {
            return Vec::new();
        }
        let settings = MapSettings {
            // Only documents have a scale of normals.
            bake: RecordedSettings::new(&settings.with_scale_normals(false), model),
            range: texture.range.as_ref().map(RecordedRange::new),
            scale: texture.scale.map(f64::from),
            map: self.recorded(),
        };
        Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            content: texture.content.name().to_owned(),
            settings,
            lobe_errors: texture.lobe_errors.clone(),
            sources: self.sources.clone(),
        }
        .keys()
    }

    /// Returns how the images are read.
    fn recorded(&self) -> RecordedMap<'_> {
        let texels = match self.texels {
            BumpTexels::Heights { scale, wrap } => {
                RecordedTexels::Heights { height: true, height_scale: f64::from(scale), wrap }
            }
            BumpTexels::Normals { layout, is_green_down } => {
                RecordedTexels::Normals { channels: layout, green_down: is_green_down }
            }
        };
        RecordedMap { texels, layer: self.layer, roughness_factor: self.roughness_factor.map(f64::from) }
    }
}

/// What the provenance of a standalone map's textures records as settings.
#[derive(Serialize)]
struct MapSettings<'a> {
    #[serde(flatten)]
    bake: RecordedSettings,
    range: Option<RecordedRange>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scale: Option<f64>,
    map: RecordedMap<'a>,
}

/// A [`Range`] with the digits of double precision, as all numbers of recorded settings are written.
#[derive(Serialize)]
struct RecordedRange {
    min: Vec<f64>,
    max: Vec<f64>,
}

impl RecordedRange {
    fn new(range: &Range) -> Self {
        let widened = |values: &[f32]| values.iter().copied().map(f64::from).collect();
        Self { min: widened(&range.min), max: widened(&range.max) }
    }
}

/// How the images of a standalone map are read.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct RecordedMap<'a> {
    #[serde(flatten)]
    texels: RecordedTexels,
    layer: Option<&'a str>,
    roughness_factor: Option<f64>,
}

/// What the texels of the image are: [`BumpTexels`] under the names of the flags.
#[derive(Serialize)]
#[serde(untagged, rename_all_fields = "camelCase")]
enum RecordedTexels {
    Heights { height: bool, height_scale: f64, wrap: [Wrap; 2] },
    Normals { channels: NormalLayout, green_down: bool },
}

#[cfg(test)]
mod tests;
