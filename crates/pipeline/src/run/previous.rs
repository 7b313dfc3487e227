//! The output document of an earlier bake: its source, and its files that no document names any more.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use crate::bake::DocumentProvenance;
use crate::digest::Digest;
use crate::gltf::document::Container;
use crate::gltf::uri::relative_path;
use crate::input_file::{check_file, holds};
use crate::output::Guard;
use crate::project::{GLB_MAGIC, recorded};
use crate::run::error::RunError;
use crate::run::job::Job;

/// An output document with provenance.
pub struct Previous {
    path: PathBuf,
    provenance: DocumentProvenance,
}

impl Previous {
    /// Reads the document at `path`; returns `None` where there is no document that Roughcast baked with provenance.
    pub fn at(path: &Path) -> Option<Self> {
        let provenance = recorded(path)?;
        Some(Self { path: path.to_owned(), provenance })
    }

    /// Checks that the document may be replaced by the output of `job`.
    ///
    /// # Errors
    /// [`RunError::OtherSource`] where the document was baked from another source. Without this check, bakes of the two
    /// sources would overwrite each other in turn. A document that the user names may be replaced.
    /// [`RunError::Changed`] where the source, which was read before, cannot be read any more.
    pub fn check(&self, job: &Job) -> Result<(), RunError> {
        let Some(found) = self.provenance.source.as_ref().filter(|_| job.name.is_none()) else { return Ok(()) };
        let mut magic = Vec::new();
        let opened = check_file(&job.source).and_then(|_| File::open(&job.source));
        opened
            .and_then(|file| file.take(4).read_to_end(&mut magic))
            .map_err(|_| RunError::Changed { path: job.source.clone() })?;
        let container = if magic == GLB_MAGIC { Container::Glb } else { Container::Gltf };
        let source_name = DocumentProvenance::source_name(&job.source_stem(), container);
        if *found == source_name {
            return Ok(());
        }
        Err(RunError::OtherSource { path: self.path.clone(), found: found.clone(), source_name })
    }

    /// Removes files of the earlier document whose digests are as the document recorded them. Outputs of this run,
    /// which `guard` knows, and inputs of `job` stay. Returns the removed files.
    pub fn remove_stale(&self, job: &Job, guard: &mut Guard) -> Vec<PathBuf> {
        let folder = PathBuf::from(format!("{}.roughcast", job.output_stem()));
        let textures = job.output.join(&folder);
        // A link may lead to a folder of somebody else.
        if !fs::symlink_metadata(&textures).is_ok_and(|facts| facts.is_dir()) {
            return Vec::new();
        }
        let inputs: Vec<PathBuf> = job.inputs.iter().filter_map(|input| fs::canonicalize(&input.path).ok()).collect();
        let mut is_stale = |path: &Path, blake3: Digest| {
            !guard.is_registered(path)
                && fs::symlink_metadata(path).is_ok_and(|facts| facts.is_file())
                && fs::canonicalize(path).is_ok_and(|real| !inputs.contains(&real))
                && holds(path, blake3)
        };
        let mut removed = Vec::new();
        for output in &self.provenance.outputs {
            let Some(name) = name_in(&folder, &output.uri) else { continue };
            let path = textures.join(name);
            if is_stale(&path, output.blake3) && fs::remove_file(&path).is_ok() {
                removed.push(path);
            }
        }
        // Fails where the folder holds anything else.
        let _ = fs::remove_dir(&textures);
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
