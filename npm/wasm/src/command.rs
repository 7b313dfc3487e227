//! The commands of requests.

use roughcast_core::bake::planned_files;
use roughcast_core::gltf::document::Document;
use roughcast_core::note::{Note, unnamed_engine};
use roughcast_core::report::{AssetReport, MapReport, RunReport};
use roughcast_core::settings::values::Values;
use roughcast_core::settings::{RecordedSettings, Settings, SettingsError};
use serde::{Deserialize, Serialize};

use crate::message::{self, File};
use crate::{bake, map};

/// The header of a request.
#[derive(Deserialize)]
#[serde(tag = "command", rename_all = "lowercase")]
enum Command {
    /// Lists the files that the document, the first file, names.
    Files,
    /// Returns the report of a run with these settings, without assets.
    Run { settings: Values },
    /// Bakes the document, the first file; the others are the files that it names.
    Bake(bake::Request),
    /// Bakes a standalone map, the first file; the second file is its roughness map.
    Map(map::Request),
}

/// The header of a response.
#[derive(Serialize)]
#[serde(untagged, rename_all_fields = "camelCase")]
pub enum Reply {
    /// The names of the files that a document names.
    Files { names: Vec<String>, has_bumps: bool },
    /// The report of a run, and the note that it gets if some lobes are anisotropic.
    Run { report: RunReport, on_anisotropy: Option<Note> },
    /// A baked document, the first file, with the names of files that did not change.
    Baked { copies: Vec<String>, run: RunReport, report: AssetReport },
    /// A baked standalone map.
    Map { report: MapReport },
    /// Why a request is not answered, for a person.
    Refused { error: String },
}

/// The header and the files of a response.
pub type Response = (Reply, Vec<(String, Vec<u8>)>);

/// Why a request is not answered, for a person.
pub type Refusal = String;

/// Answers a request; `progress` takes the share of the work that is done. A failure is a response, too.
pub fn answer(request: &[u8], progress: &dyn Fn(f32)) -> Vec<u8> {
    let response =
        message::read(request).map_err(|error| error.to_string()).and_then(
            |(header, files)| match serde_json::from_str(header).map_err(|error| error.to_string())? {
                Command::Files => list_files(&files),
                Command::Run { settings } => start_run(&settings),
                Command::Bake(request) => bake::bake(&request, &files, progress),
                Command::Map(request) => map::bake(&request, &files),
            },
        );
    let (reply, files) = response.unwrap_or_else(|error| (Reply::Refused { error }, Vec::new()));
    // Only maps with keys that are no text cannot be written as JSON, and no reply has any.
    message::write(&reply, &files).unwrap_or_default()
}

/// Returns the first file.
pub fn first<'m>(files: &[File<'m>]) -> Result<File<'m>, Refusal> {
    files.first().copied().ok_or_else(|| "expected a file, found none; name one".to_owned())
}

/// Returns the settings that `values` sets over the defaults. The values of an engine's preset yield to the others.
pub fn settings(values: &Values) -> Result<Settings, SettingsError> {
    let preset = values.engine.map(|engine| Values::of_engine(engine, values.profile.unwrap_or_default()));
    Values::defaults().overridden_by(&preset.unwrap_or_default()).overridden_by(values).settings()
}

fn list_files(files: &[File<'_>]) -> Result<Response, Refusal> {
    let document = Document::parse(first(files)?.bytes).map_err(|error| error.to_string())?;
    let planned = planned_files(&document).map_err(|error| error.to_string())?;
    let names = planned.files.iter().map(|path| path.display().to_string()).collect();
    Ok((Reply::Files { names, has_bumps: planned.has_bumps }, Vec::new()))
}

fn start_run(values: &Values) -> Result<Response, Refusal> {
    let settings = settings(values).map_err(|error| error.to_string())?;
    let on_anisotropy = values.leaves_engine_open(values.max_model.is_some()).then(unnamed_engine);
    Ok((Reply::Run { report: run_report(values, &settings), on_anisotropy }, Vec::new()))
}

/// Returns the report, without assets, of a run with `settings`, which `values` set.
pub fn run_report(values: &Values, settings: &Settings) -> RunReport {
    let notes = values.engine.map(|engine| engine.notes(settings)).unwrap_or_default();
    RunReport::new(RecordedSettings::new(settings, settings.model), Vec::new(), notes, None)
}
