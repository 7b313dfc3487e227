//! A job: the bake of one asset, and everything that decides on its outputs.

use std::fs;
use std::path::{Component, Path, PathBuf};

use rayon::prelude::*;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::json;

use crate::bake::{PlannedFiles, output_stem_of, planned_files, portable_stem};
use crate::digest::{Digest, digest};
use crate::gltf::document::{Container, Document};
use crate::input_file::{hash_file, read_file};
use crate::memory;
use crate::output::Guard;
use crate::project::Values;
use crate::run::error::RunError;

/// The bake of one asset. Paths are relative to the working folder, if the command line's are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Job {
    /// The digest of inputs, settings and tool version. A copy of the asset in another folder has an equal id.
    pub id: Digest,
    /// The .gltf or .glb file.
    #[serde(deserialize_with = "relative")]
    pub source: PathBuf,
    /// Folder of the outputs. The id does not cover it; [`crate::run::confine`] checks that of a plan.
    #[serde(deserialize_with = "relative")]
    pub output: PathBuf,
    /// The name of the output document without extension; absent if it is that of the source.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "file_name")]
    pub name: Option<String>,
    /// Every setting that has a value.
    pub settings: Values,
    /// The files that the job reads, the source first.
    pub inputs: Vec<JobInput>,
    /// The outputs that must exist afterwards.
    pub outputs: Vec<JobOutput>,
    /// Bytes of the inputs, or 0 if nothing is to be baked. The time of a bake grows with them.
    pub cost: u64,
    /// The command line that bakes only this asset.
    pub command: Vec<String>,
}

/// A file that a job reads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct JobInput {
    /// The path.
    #[serde(deserialize_with = "relative")]
    pub path: PathBuf,
    /// The digest of the bytes; absent where the file cannot be read. The job fails if it needs such a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blake3: Option<Digest>,
    /// The length in bytes.
    pub bytes: u64,
}

/// An output that must exist after a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct JobOutput {
    /// The path.
    #[serde(deserialize_with = "relative")]
    pub path: PathBuf,
    /// The kind.
    pub kind: OutputKind,
}

/// A kind of output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OutputKind {
    /// A file.
    File,
    /// A folder with files that the bake names.
    Folder,
}

/// Parses a document, after a check that memory suffices for the copies of .glb chunks that a bake makes.
pub(super) fn parsed(bytes: &[u8]) -> Result<Document, RunError> {
    memory::check(3 * bytes.len() as u64)?;
    Ok(Document::parse(bytes)?)
}

impl Job {
    /// Plans the bake of `source` into the folder `output` with `settings`: reads and hashes its files, and decodes
    /// none. The output document is called `name`, or as the source.
    ///
    /// # Errors
    /// [`RunError`] where the document cannot be read or understood.
    pub fn new(source: &Path, output: &Path, name: Option<&str>, settings: &Values) -> Result<Self, RunError> {
        let bytes = read_file(source).map_err(RunError::Read)?;
        let document = parsed(&bytes)?;
        let facts = planned_files(&document)?;
        let stem = output_stem_of(source);
        let name = name.filter(|name| *name != stem);
        // Removes parts without meaning, such as a slash at the end.
        let output: &Path = &output.components().collect::<PathBuf>();
        let mut inputs =
            vec![JobInput { path: source.to_owned(), blake3: Some(digest(&bytes)), bytes: bytes.len() as u64 }];
        inputs.par_extend(facts.files.par_iter().map(|file| {
            let path = beside(source, file);
            let (blake3, bytes) = hash_file(&path).ok().unzip();
            JobInput { path, blake3, bytes: bytes.unwrap_or(0) }
        }));
        let names = facts.files.iter().map(|file| file.to_string_lossy());
        let files: Vec<(String, Option<Digest>)> = [stem.clone().into()]
            .into_iter()
            .chain(names)
            .map(|name| name.into_owned())
            .zip(inputs.iter().map(|input| input.blake3))
            .collect();
        let version = env!("CARGO_PKG_VERSION");
        let mut identity = json!({ "version": version, "settings": settings, "files": files });
        if let Some(name) = name {
            identity["name"] = json!(name);
        }
        let container = settings.settings()?.container(facts.container);
        let writes_textures =
            facts.may_write_textures(settings.profile.unwrap_or_default(), settings.textures.unwrap_or_default());
        let stem = name.unwrap_or(&stem);
        Ok(Self {
            id: digest(identity.to_string().as_bytes()),
            outputs: outputs(&facts, writes_textures, container, stem, output),
            cost: if writes_textures { inputs.iter().map(|input| input.bytes).sum() } else { 0 },
            command: command(source, &named_output(output, name, container), settings),
            source: source.to_owned(),
            output: output.to_owned(),
            name: name.map(str::to_owned),
            settings: settings.clone(),
            inputs,
        })
    }

    /// Plans the job again and checks that the result is equal.
    ///
    /// # Errors
    /// [`RunError::NotAsPlanned`] if the files make another job now. [`RunError::Edited`] if the id is right and
    /// another member of the job is wrong.
    pub fn check(&self) -> Result<(), RunError> {
        let now = Self::new(&self.source, &self.output, self.name.as_deref(), &self.settings)?;
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
        let mut paths = [&self.source, &self.output]
            .into_iter()
            .chain(self.inputs.iter().map(|input| &input.path))
            .chain(self.outputs.iter().map(|output| &output.path));
        match paths.find(|path| path.to_str().is_none()) {
            Some(path) => Err(RunError::NotUtf8 { path: path.clone() }),
            None => Ok(()),
        }
    }

    /// Returns the first declared output that does not exist.
    pub fn missing_output(&self) -> Option<&Path> {
        let exists = |output: &JobOutput| match output.kind {
            OutputKind::File => output.path.is_file(),
            OutputKind::Folder => output.path.is_dir(),
        };
        self.outputs.iter().find(|output| !exists(output)).map(|output| output.path.as_path())
    }

    /// Registers the inputs and declared outputs of the job in `guard`.
    pub fn protect(&self, guard: &mut Guard) {
        self.inputs.iter().for_each(|input| guard.add_source(&input.path));
        self.outputs.iter().for_each(|output| guard.declare(&output.path));
    }

    /// Returns the input that the document refers to as `file`.
    pub fn input(&self, file: &Path) -> Option<&JobInput> {
        let path = beside(&self.source, file);
        self.inputs.iter().find(|input| input.path == path)
    }

    /// Returns whether the output at `path` is a buffer of the document. The document is declared first.
    pub fn is_buffer(&self, path: &Path) -> bool {
        let path = normal_path(path);
        self.outputs.iter().skip(1).any(|output| output.kind == OutputKind::File && normal_path(&output.path) == path)
    }

    /// Returns the name of the source without its extension, which provenance records.
    pub fn source_stem(&self) -> String {
        output_stem_of(&self.source)
    }

    /// Returns the name of the output document without its extension, from which the names of other outputs are made.
    pub fn output_stem(&self) -> String {
        self.name.clone().unwrap_or_else(|| self.source_stem())
    }
}

/// Reads a path of a plan, which is relative to the working folder, since a plan is for other machines too.
fn relative<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PathBuf, D::Error> {
    let path = PathBuf::deserialize(deserializer)?;
    let is_rooted = path.components().any(|part| matches!(part, Component::Prefix(_) | Component::RootDir));
    if is_rooted || path.as_os_str().is_empty() || path.as_os_str().as_encoded_bytes().contains(&0) {
        return Err(D::Error::custom(format!("expected a path relative to the working folder, found {path:?}")));
    }
    Ok(path)
}

/// Reads the name of an output document, which may lead into no other folder.
fn file_name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    let name = String::deserialize(deserializer)?;
    let mut parts = Path::new(&name).components();
    let is_plain = matches!((parts.next(), parts.next()), (Some(Component::Normal(part)), None) if part == &*name);
    // On Unix, `\` is a character like any other, and the plan may be run on Windows.
    if is_plain && !name.contains(['\\', '\0']) {
        return Ok(Some(name));
    }
    Err(D::Error::custom(format!("expected the name of a file without folders, found {name:?}")))
}

fn outputs(
    facts: &PlannedFiles,
    writes_textures: bool,
    container: Container,
    stem: &str,
    folder: &Path,
) -> Vec<JobOutput> {
    let file = |path: PathBuf| JobOutput { path, kind: OutputKind::File };
    let mut outputs = vec![file(folder.join(format!("{stem}.{}", container.extension())))];
    if container == Container::Gltf {
        if writes_textures || facts.has_bin {
            let name = format!("{}.roughcast", portable_stem(stem));
            outputs.push(JobOutput { path: folder.join(name), kind: OutputKind::Folder });
        }
        outputs.extend(facts.buffers.iter().map(|buffer| file(normal_path(&folder.join(buffer)))));
    }
    outputs
}

/// Returns what `-o` names: the folder of the outputs, or the document if it has a `name` of its own.
fn named_output(folder: &Path, name: Option<&str>, container: Container) -> PathBuf {
    name.map_or_else(|| folder.to_owned(), |name| folder.join(format!("{name}.{}", container.extension())))
}

/// Returns the command line of the job. Flags have the names of the settings, and settings without a value have no
/// flag.
fn command(source: &Path, output: &Path, settings: &Values) -> Vec<String> {
    let path = |path: &Path| path.to_string_lossy().into_owned();
    let mut words = vec!["roughcast".to_owned(), "bake".to_owned(), path(source), "-o".to_owned(), path(output)];
    words.push("--no-config".to_owned());
    for (name, text) in settings.texts() {
        match (name.as_str(), text.as_str()) {
            ("provenance", "true") | ("trim", "false") => {}
            ("provenance", _) => words.push("--no-provenance".to_owned()),
            ("fov" | "aspect", _) if settings.nearest.is_none() => {}
            // Flags take names and lists without the quotes and brackets of JSON.
            (_, text) => words.push(format!("--{name}={}", text.trim_matches(['"', '[', ']']))),
        }
    }
    words
}

/// Returns the path of the file that `source` refers to as `file`, in normal form unless links make that another file.
pub fn beside(source: &Path, file: &Path) -> PathBuf {
    let path = source.parent().unwrap_or(Path::new("")).join(file);
    let short = normal_path(&path);
    let is_same = || matches!((fs::canonicalize(&path), fs::canonicalize(&short)), (Ok(a), Ok(b)) if a == b);
    if short == path || is_same() { short } else { path }
}

/// Returns `path` in normal form: without `.`, and without `..` behind a name.
pub fn normal_path(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(normal.components().next_back(), Some(Component::Normal(_))) => {
                normal.pop();
            }
            part => normal.push(part),
        }
    }
    normal
}

#[cfg(test)]
mod tests;
