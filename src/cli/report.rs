//! The report of a run (`schemas/report.schema.json`) and its summary for a person.

use std::ops::Not;

use serde::Serialize;
use serde_json::Value;

use crate::digest::Digest;
use crate::remote::{Counts, Origin};
use crate::report::{AssetReport, Choice};
use crate::run::Done;
use crate::settings::Settings;
use crate::text::printable;

/// What a run did.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Report {
    /// Version of the tool.
    pub version: &'static str,
    /// Settings, as they stand in the provenance of textures.
    pub settings: Value,
    /// Each input, in order.
    pub assets: Vec<Asset>,
    /// What a server did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remote: Option<Counts>,
}

/// What became of an input.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Asset {
    /// Id of its job, where it could be planned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub job: Option<Digest>,
    /// The input file.
    pub input: String,
    /// The output document, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<String>,
    /// How it ended.
    pub status: Status,
    /// Whether a worker of a server baked it, or the server knew it; absent where it was not asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remote: Option<Origin>,
    /// Its settings, where its configuration makes them other than those of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settings: Option<Value>,
    /// Seconds from reading to writing.
    pub seconds: f64,
    /// Bytes written.
    pub bytes: u64,
    /// What went wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Whether trying again may help.
    #[serde(skip_serializing_if = "Not::not")]
    pub retry: bool,
    /// Layers and textures.
    #[serde(flatten)]
    pub report: AssetReport,
}

/// How an input ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Textures were baked.
    Baked,
    /// Nothing in it has bumps: copied as it is.
    Copied,
    /// It was baked before: its outputs are as the cache has them.
    Cached,
    /// See `error`.
    Failed,
}

impl Status {
    /// How a job that succeeded ended, whose outputs are from `origin`.
    pub fn of(done: &Done, origin: Option<Origin>) -> Self {
        match &done.report.textures {
            // What a worker baked is new, although it comes through a cache.
            _ if done.is_cached && origin != Some(Origin::Executed) => Self::Cached,
            textures if textures.is_empty() => Self::Copied,
            _ => Self::Baked,
        }
    }
}

impl Asset {
    /// An input that was baked; `own` are its settings where they are not those of the run.
    pub fn done(
        input: String,
        job: Option<Digest>,
        done: &Done,
        origin: Option<Origin>,
        seconds: f64,
        own: Option<Settings>,
    ) -> Self {
        Self {
            job,
            input,
            output: Some(done.output.display().to_string()),
            status: Status::of(done, origin),
            remote: origin,
            settings: own.map(|own| own.to_json(own.model)),
            seconds,
            bytes: done.bytes,
            error: None,
            retry: false,
            report: done.report.clone(),
        }
    }

    /// An input that could not be baked.
    pub fn failed(input: String, job: Option<Digest>, seconds: f64, error: String, retry: bool) -> Self {
        Self {
            job,
            input,
            output: None,
            status: Status::Failed,
            remote: None,
            settings: None,
            seconds,
            bytes: 0,
            error: Some(error),
            retry,
            report: AssetReport::default(),
        }
    }

    /// Returns one line for the asset, then one for each layer and each note, as a terminal may show them.
    pub fn summary(&self) -> String {
        let input = printable(&self.input);
        let mut text = match self.status {
            Status::Failed => return String::new(),
            Status::Cached => {
                return format!("cached {input}: {:.1} MB, {:.2} s\n", self.bytes as f64 / 1e6, self.seconds);
            }
            Status::Copied => format!("copied {input}: no normal or height maps\n"),
            Status::Baked => format!(
                "baked {input}: {} texture(s), {:.1} MB, {:.2} s\n",
                self.report.textures.len(),
                self.bytes as f64 / 1e6,
                self.seconds
            ),
        };
        for layer in &self.report.layers {
            let model = layer.model.map_or_else(|| "left".to_owned(), |m| m.name().to_owned());
            let judged = layer.choice.as_ref().map(Choice::summary).unwrap_or_default();
            let which = match layer.layer {
                crate::gltf::material::LayerKind::Base => "",
                crate::gltf::material::LayerKind::Clearcoat => ", clearcoat",
            };
            let finest = layer.finest.map_or_else(String::new, |f| {
                format!(", sampled from level {} on, typically {}", f.level, f.typical_level)
            });
            text += &format!("  {}{which}: {model}{judged}{finest}\n", printable(&layer.material));
            for note in &layer.notes {
                text += &format!("    note: {}\n", printable(note));
            }
        }
        text
    }
}
