//! The output document of an earlier bake: what it was made from, and which of its files nothing names any more.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use crate::bake::DocumentProvenance;
use crate::digest::Digest;
use crate::gltf::document::{Container, Document};
use crate::gltf::json::Json;
use crate::gltf::uri::relative_path;
use crate::input_file::{check_file, holds};
use crate::output::Guard;
use crate::run::error::RunError;
use crate::run::job::Job;

/// What an output document records.
pub struct Previous {
    path: PathBuf,
    provenance: DocumentProvenance,
}

impl Previous {
    /// Reads what is at `path`; `None` where that is nothing, or nothing that Roughcast baked with provenance.
    pub fn at(path: &Path) -> Option<Self> {
        let provenance = recorded(path)?;
        Some(Self { path: path.to_owned(), provenance })
    }

    /// Checks that the document may be replaced by what `job` makes.
    ///
    /// # Errors
    /// [`RunError::OtherSource`] where it was baked from another source: the two take turns in one place otherwise.
    pub fn check(&self, job: &Job) -> Result<(), RunError> {
        let Some(found) = &self.provenance.source else { return Ok(()) };
        let mut magic = Vec::new();
        let opened = check_file(&job.source).and_then(|_| File::open(&job.source));
        opened.and_then(|file| file.take(4).read_to_end(&mut magic)).map_err(RunError::Read)?;
        let container = if magic == GLB { Container::Glb } else { Container::Gltf };
        let source_name = DocumentProvenance::source_name(&job.stem(), container);
        if *found == source_name {
            return Ok(());
        }
        Err(RunError::OtherSource { path: self.path.clone(), found: found.clone(), source_name })
    }

    /// Removes files of the earlier document that are as it recorded them, unless they are outputs of this run, which `guard`
    /// knows, or inputs of `job`. Returns those that were removed.
    pub fn remove_stale(&self, job: &Job, guard: &mut Guard) -> Vec<PathBuf> {
        let folder = PathBuf::from(format!("{}.roughcast", job.stem()));
        let own = job.output.join(&folder);
        // What a link leads to is not ours.
        if !fs::symlink_metadata(&own).is_ok_and(|facts| facts.is_dir()) {
            return Vec::new();
        }
        let inputs: Vec<PathBuf> = job.inputs.iter().filter_map(|input| fs::canonicalize(&input.path).ok()).collect();
        let mut is_stale = |path: &Path, blake3: Digest| {
            !guard.is_taken(path)
                && fs::symlink_metadata(path).is_ok_and(|facts| facts.is_file())
                && fs::canonicalize(path).is_ok_and(|real| !inputs.contains(&real))
                && holds(path, blake3)
        };
        let mut removed = Vec::new();
        for output in &self.provenance.outputs {
            let Some(name) = name_in(&folder, &output.uri) else { continue };
            let path = own.join(name);
            if is_stale(&path, output.blake3) && fs::remove_file(&path).is_ok() {
                removed.push(path);
            }
        }
        // Fails where anything else is in it.
        let _ = fs::remove_dir(&own);
        removed
    }
}

/// Returns the name of the file in `folder` that `uri` refers to; `None` where it refers to anything else.
fn name_in(folder: &Path, uri: &str) -> Option<PathBuf> {
    let path = relative_path(uri).ok()?;
    let mut below = path.strip_prefix(folder).ok()?.components();
    match (below.next(), below.next()) {
        (Some(Component::Normal(name)), None) => Some(name.into()),
        _ => None,
    }
}

const GLB: &[u8] = b"glTF";

/// Returns what the document at `path` records of its making; `None` where nothing does, or nothing that can be read. Of a
/// .glb the JSON alone is read.
pub fn recorded(path: &Path) -> Option<DocumentProvenance> {
    let json = json(path).ok()?;
    // Most documents are none of ours: parsing them would cost more than reading them.
    if !std::str::from_utf8(&json).is_ok_and(|text| text.contains("\"roughcast\"")) {
        return None;
    }
    DocumentProvenance::read(&Document::gltf(Json::parse(&json).ok()?))
}

/// Returns the JSON of the document at `path`.
fn json(path: &Path) -> io::Result<Vec<u8>> {
    /// Header of the file and of its first chunk, the JSON.
    const HEADER: u64 = 20;
    let length = check_file(path)?;
    let mut file = File::open(path)?;
    let mut bytes = Vec::new();
    file.by_ref().take(HEADER).read_to_end(&mut bytes)?;
    let chunk = bytes.get(12..16).and_then(<[u8]>::first_chunk).map(|length| u32::from_le_bytes(*length));
    let rest = match chunk {
        Some(chunk) if bytes.starts_with(GLB) => {
            bytes.clear();
            u64::from(chunk)
        }
        _ => length,
    };
    file.take(rest).read_to_end(&mut bytes)?;
    Ok(bytes)
}
