//! A job: one asset, and all that decides on what becomes of it.

use std::fs;
use std::path::{Component, Path, PathBuf};

use rayon::prelude::*;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value, json};

use crate::bake::{Survey, output_stem, portable_stem, survey};
use crate::digest::{Digest, digest};
use crate::gltf::document::{Container, Document};
use crate::input_file::{hash_file, read_file};
use crate::memory;
use crate::output::Guard;
use crate::project::Values;
use crate::run::error::RunError;
use crate::settings::Settings;

/// The bake of one asset. Paths are relative to the working folder, if the command line's are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Job {
    /// The digest of inputs, settings and tool version. The same asset in another folder is the same job.
    pub id: Digest,
    /// The .gltf or .glb file.
    #[serde(deserialize_with = "relative")]
    pub source: PathBuf,
    /// Folder of the outputs. The id does not cover it; [`crate::run::confine`] checks that of a plan.
    #[serde(deserialize_with = "relative")]
    pub output: PathBuf,
    /// Every setting, by its name in `roughcast.toml`.
    pub settings: Map<String, Value>,
    /// Files that are read, the source first.
    pub inputs: Vec<JobInput>,
    /// What must be there afterwards.
    pub outputs: Vec<JobOutput>,
    /// Bytes of the inputs, if anything is to be baked: time grows with them.
    pub cost: u64,
    /// The command line that bakes this asset alone.
    pub command: Vec<String>,
}

/// A file that a job reads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct JobInput {
    /// Where it is.
    #[serde(deserialize_with = "relative")]
    pub path: PathBuf,
    /// The digest of its bytes; absent where it cannot be read, which the job will say if it needs it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blake3: Option<Digest>,
    /// Its length.
    pub bytes: u64,
}

/// What a job must have written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct JobOutput {
    /// Where it must be.
    #[serde(deserialize_with = "relative")]
    pub path: PathBuf,
    /// What it must be.
    pub kind: OutputKind,
}

/// A kind of output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OutputKind {
    /// A file.
    File,
    /// A folder with files whose names the bake decides on.
    Folder,
}

/// Parses a document, once there is memory for the copies of a .glb's chunks that a bake makes.
pub(super) fn parsed(bytes: &[u8]) -> Result<Document, RunError> {
    memory::check(3 * bytes.len() as u64)?;
    Ok(Document::parse(bytes)?)
}

impl Job {
    /// Plans the bake of `source` into the folder `output` with `settings`: reads and hashes its files, and decodes none.
    ///
    /// # Errors
    /// [`RunError`] where the document cannot be read or understood.
    pub fn new(source: &Path, output: &Path, settings: &Map<String, Value>) -> Result<Self, RunError> {
        let bytes = read_file(source).map_err(RunError::Read)?;
        let document = parsed(&bytes)?;
        let survey = survey(&document)?;
        let stem = stem(source);
        // Without what has no meaning, such as a slash at the end.
        let output: &Path = &output.components().collect::<PathBuf>();
        let mut inputs =
            vec![JobInput { path: source.to_owned(), blake3: Some(digest(&bytes)), bytes: bytes.len() as u64 }];
        inputs.par_extend(survey.files.par_iter().map(|file| {
            let path = beside(source, file);
            let (blake3, bytes) = hash_file(&path).ok().unzip();
            JobInput { path, blake3, bytes: bytes.unwrap_or(0) }
        }));
        let names = survey.files.iter().map(|file| file.to_string_lossy());
        let files: Vec<(String, Option<Digest>)> = [stem.clone().into()]
            .into_iter()
            .chain(names)
            .map(|name| name.into_owned())
            .zip(inputs.iter().map(|input| input.blake3))
            .collect();
        let identity = json!({ "version": env!("CARGO_PKG_VERSION"), "settings": settings, "files": files });
        let typed = typed(settings)?;
        Ok(Self {
            id: digest(identity.to_string().as_bytes()),
            outputs: outputs(&survey, &typed, &stem, output),
            cost: if survey.has_bumps { inputs.iter().map(|input| input.bytes).sum() } else { 0 },
            command: command(source, output, settings),
            source: source.to_owned(),
            output: output.to_owned(),
            settings: settings.clone(),
            inputs,
        })
    }

    /// The settings.
    ///
    /// # Errors
    /// [`RunError`] where those of a plan are none.
    pub fn typed_settings(&self) -> Result<Settings, RunError> {
        typed(&self.settings)
    }

    /// Plans the job again and checks that it is the same one.
    ///
    /// # Errors
    /// [`RunError::NotAsPlanned`] if the files make another job now; [`RunError::Edited`] if they make this one, and what the
    /// plan says beside the id is something else.
    pub fn check(&self) -> Result<(), RunError> {
        let now = Self::new(&self.source, &self.output, &self.settings)?;
        if now.id != self.id {
            let changed = now.inputs.iter().find(|input| !self.inputs.contains(input));
            let reason = changed.map_or_else(
                || "the plan is of another version, or was edited".to_owned(),
                |input| format!("{} is not as it was", input.path.display()),
            );
            return Err(RunError::NotAsPlanned { planned: self.id, found: now.id, reason });
        }
        for (member, is_same) in [("inputs", now.inputs == self.inputs), ("outputs", now.outputs == self.outputs)] {
            if !is_same {
                return Err(RunError::Edited { member });
            }
        }
        Ok(())
    }

    /// Checks that a plan can name the files of the job: JSON is UTF-8.
    ///
    /// # Errors
    /// [`RunError::NotUtf8`].
    pub fn check_names(&self) -> Result<(), RunError> {
        let own = [&self.source, &self.output].into_iter();
        let mut paths = own
            .chain(self.inputs.iter().map(|input| &input.path))
            .chain(self.outputs.iter().map(|output| &output.path));
        match paths.find(|path| path.to_str().is_none()) {
            Some(path) => Err(RunError::NotUtf8 { path: path.clone() }),
            None => Ok(()),
        }
    }

    /// The first declared output that is not there.
    pub fn missing_output(&self) -> Option<&Path> {
        let is_there = |output: &JobOutput| match output.kind {
            OutputKind::File => output.path.is_file(),
            OutputKind::Folder => output.path.is_dir(),
        };
        self.outputs.iter().find(|output| !is_there(output)).map(|output| output.path.as_path())
    }

    /// Tells `guard` which files the job reads and which it will write.
    pub fn protect(&self, guard: &mut Guard) {
        self.inputs.iter().for_each(|input| guard.add_source(&input.path));
        self.outputs.iter().for_each(|output| guard.declare(&output.path));
    }

    /// The input that the document refers to as `file`.
    pub fn input(&self, file: &Path) -> Option<&JobInput> {
        let path = beside(&self.source, file);
        self.inputs.iter().find(|input| input.path == path)
    }

    /// Name of the asset without its extension; outputs are named after it.
    pub fn stem(&self) -> String {
        stem(&self.source)
    }
}

/// Reads a path of a plan. It is relative to the working folder, since a plan is for other machines too.
fn relative<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PathBuf, D::Error> {
    let path = PathBuf::deserialize(deserializer)?;
    let is_rooted = path.components().any(|part| matches!(part, Component::Prefix(_) | Component::RootDir));
    if is_rooted || path.as_os_str().is_empty() || path.as_os_str().as_encoded_bytes().contains(&0) {
        return Err(D::Error::custom(format!("expected a path relative to the working folder, found {path:?}")));
    }
    Ok(path)
}

fn stem(source: &Path) -> String {
    output_stem(&source.file_stem().unwrap_or_default().to_string_lossy())
}

fn typed(settings: &Map<String, Value>) -> Result<Settings, RunError> {
    let values: Values =
        serde_json::from_value(Value::Object(settings.clone())).map_err(|e| RunError::Settings(e.to_string()))?;
    Ok(values.settings()?)
}

fn outputs(survey: &Survey, settings: &Settings, stem: &str, folder: &Path) -> Vec<JobOutput> {
    let file = |path: PathBuf| JobOutput { path, kind: OutputKind::File };
    let is_glb = if survey.has_bumps { settings.glb } else { survey.container == Container::Glb };
    let mut outputs = vec![file(folder.join(format!("{stem}.{}", if is_glb { "glb" } else { "gltf" })))];
    if survey.has_bumps && !is_glb {
        let name = format!("{}.roughcast", portable_stem(stem));
        outputs.push(JobOutput { path: folder.join(name), kind: OutputKind::Folder });
    }
    if !is_glb {
        outputs.extend(survey.buffers.iter().map(|buffer| file(roughened(&folder.join(buffer)))));
    }
    outputs
}

/// The flags are the names of the settings; what is not set has no default.
fn command(source: &Path, output: &Path, settings: &Map<String, Value>) -> Vec<String> {
    let path = |path: &Path| path.to_string_lossy().into_owned();
    let mut words = vec!["roughcast".to_owned(), "bake".to_owned(), path(source), "-o".to_owned(), path(output)];
    words.push("--no-config".to_owned());
    let has_view = settings.contains_key("nearest");
    for (name, value) in settings {
        match (name.as_str(), value) {
            ("provenance", Value::Bool(true)) | ("glb" | "trim", Value::Bool(false)) => {}
            ("provenance", _) => words.push("--no-provenance".to_owned()),
            ("fov" | "aspect", _) if !has_view => {}
            (_, Value::Bool(truth)) => words.push(format!("--{name}={truth}")),
            (_, Value::String(text)) => words.push(format!("--{name}={text}")),
            (_, Value::Array(list)) => {
                let list: Vec<String> = list.iter().map(Value::to_string).collect();
                words.push(format!("--{name}={}", list.join(",")));
            }
            (_, number) => words.push(format!("--{name}={number}")),
        }
    }
    words
}

/// Where a file is that `source` refers to as `file`: one file, one path, unless links make another of it.
pub fn beside(source: &Path, file: &Path) -> PathBuf {
    let path = source.parent().unwrap_or(Path::new("")).join(file);
    let short = roughened(&path);
    let is_same = || matches!((fs::canonicalize(&path), fs::canonicalize(&short)), (Ok(a), Ok(b)) if a == b);
    if short == path || is_same() { short } else { path }
}

/// Without `.`, and without `..` where a name stands before it: one file, one path.
pub fn roughened(path: &Path) -> PathBuf {
    let mut roughened = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(roughened.components().next_back(), Some(Component::Normal(_))) => {
                roughened.pop();
            }
            part => roughened.push(part),
        }
    }
    roughened
}
