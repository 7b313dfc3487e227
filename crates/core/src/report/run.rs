//! The report of a run (`schemas/report.schema.json`): what became of each asset.

use std::ops::Not;

use serde::{Deserialize, Serialize};

use super::AssetReport;
use super::format::{FormatError, check_format};
use crate::digest::Digest;
use crate::note::Note;
use crate::settings::RecordedSettings;

/// The format version of reports.
pub const REPORT_FORMAT: u32 = 1;

/// What a run did.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct RunReport {
    /// The format version, [`REPORT_FORMAT`].
    pub format_version: u32,
    /// The version of the tool.
    pub version: &'static str,
    /// The settings of the run, as the provenance of textures has them.
    pub settings: RecordedSettings,
    /// What became of each input, in order.
    pub assets: Vec<AssetOutcome>,
    /// Notes on the engines of the assets; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Note>,
    /// What a server did; absent without a server.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remote: Option<Counts>,
}

impl RunReport {
    /// Returns a report of this version of the tool.
    pub fn new(
        settings: RecordedSettings,
        assets: Vec<AssetOutcome>,
        notes: Vec<Note>,
        remote: Option<Counts>,
    ) -> Self {
        Self { format_version: REPORT_FORMAT, version: env!("CARGO_PKG_VERSION"), settings, assets, notes, remote }
    }
}

/// What became of one input.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct AssetOutcome {
    /// The id of the job; absent where the asset could not be planned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub job: Option<Digest>,
    /// The input file.
    pub input: String,
    /// The output document; absent where the asset failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<String>,
    /// How the job ended.
    pub status: Status,
    /// Where a server got the outputs from; absent where no server was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remote: Option<Origin>,
    /// The settings of the asset, where they differ from those of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settings: Option<RecordedSettings>,
    /// Seconds from reading to writing.
    pub seconds: f64,
    /// Bytes of the document and of the files that it names; 0 where the asset failed.
    pub input_bytes: u64,
    /// Bytes of the outputs; `sizes` has what they hold.
    pub bytes: u64,
    /// What went wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Whether another try may succeed.
    #[serde(skip_serializing_if = "Not::not")]
    pub retry: bool,
    /// Layers and textures.
    #[serde(flatten)]
    pub report: AssetReport,
}

impl AssetOutcome {
    /// Returns the outcome of an input that could not be baked.
    pub fn failed(input: String, job: Option<Digest>, seconds: f64, error: String, retry: bool) -> Self {
        Self {
            job,
            input,
            output: None,
            status: Status::Failed,
            remote: None,
            settings: None,
            seconds,
            input_bytes: 0,
            bytes: 0,
            error: Some(error),
            retry,
            report: AssetReport::default(),
        }
    }
}

/// How a job ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Textures were baked.
    Baked,
    /// The asset has no bumps and was copied as it is.
    Copied,
    /// The asset was baked before, and its outputs came from the cache.
    Cached,
    /// See `error`.
    Failed,
}

/// Where a server got the outputs of a job from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Origin {
    /// A worker baked the outputs.
    Executed,
    /// The server had the outputs already.
    Cached,
}

/// What a server has done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Counts {
    /// Jobs that wait for a worker.
    #[serde(skip)]
    pub queued: u64,
    /// Jobs on workers.
    #[serde(skip)]
    pub running: u64,
    /// Jobs that ended, successfully or not.
    #[serde(skip)]
    pub done: u64,
    /// Ended jobs whose outputs the server had already.
    #[serde(skip)]
    pub known: u64,
    /// Actions that the jobs were grouped into.
    pub actions: u64,
    /// Executions, repetitions included.
    pub executed: u64,
    /// Actions whose result the server had already.
    pub cached: u64,
    /// Calls that were repeated after an error.
    pub retries: u64,
    /// Blobs sent.
    pub uploaded_blobs: u64,
    /// Bytes of the blobs sent, before compression.
    pub uploaded_bytes: u64,
    /// Blobs fetched.
    pub downloaded_blobs: u64,
    /// Bytes of the blobs fetched, after decompression.
    pub downloaded_bytes: u64,
}

/// The part of a report that `plan merge` reads.
#[derive(Clone, Debug, Deserialize)]
pub struct PartReport {
    /// What became of each input.
    pub assets: Vec<PartAsset>,
}

/// What became of one input, as far as `plan merge` needs it.
#[derive(Clone, Debug, Deserialize)]
pub struct PartAsset {
    /// The id of the job; absent where the asset could not be planned.
    pub job: Option<Digest>,
    /// The input file.
    pub input: String,
    /// What went wrong.
    pub error: Option<String>,
    /// Whether another try may succeed.
    #[serde(default)]
    pub retry: bool,
}

/// Bytes that are no report.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReportError {
    /// A report of another format.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// No report at all.
    #[error("expected a report as `bake --report` writes it, found: {0}; name such a report")]
    Malformed(String),
}

impl PartReport {
    /// Reads a report.
    ///
    /// # Errors
    /// [`ReportError`] for a report of another format, and for anything but a report.
    pub fn parse(json: &[u8]) -> Result<Self, ReportError> {
        check_format(json, "report", REPORT_FORMAT, "bake the part again with this version of Roughcast")?;
        serde_json::from_slice(json).map_err(|error| ReportError::Malformed(error.to_string()))
    }
}

#[cfg(test)]
mod tests;
