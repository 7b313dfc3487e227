//! A job with paths that depend on its id only, so that equal jobs of different machines are equal.

use std::path::{Path, PathBuf};

use crate::bake::planned_files;
use crate::digest::digest;
use crate::input_file::read_file;
use crate::run::error::RunError;
use crate::run::job::{Job, JobInput, JobOutput, normal_path, parsed};

/// A job below `in/<id>` and `out/<id>`.
#[derive(Clone, Debug)]
pub struct Moved {
    /// The job with its new paths.
    pub job: Job,
    /// The new paths of the input files, each with the current path.
    pub files: Vec<(PathBuf, PathBuf)>,
    /// Folders that must exist: a file that the document calls `a/../b` needs `a`.
    pub folders: Vec<PathBuf>,
}

impl Job {
    /// Returns the job with paths below `in/<id>` and `out/<id>`. Reads the document.
    ///
    /// # Errors
    /// [`RunError::Changed`] if the document changed since it was planned. [`RunError::NotMovable`] where a path leads
    /// out of the folder of the asset or of its outputs.
    pub fn moved(&self) -> Result<Moved, RunError> {
        let bytes = read_file(&self.source).map_err(RunError::Read)?;
        if self.inputs.first().and_then(|input| input.blake3) != Some(digest(&bytes)) {
            return Err(RunError::Changed { path: self.source.clone() });
        }
        let facts = planned_files(&parsed(&bytes)?)?;
        let id = self.id.to_string();
        let (from, to) = (Path::new("in").join(&id), Path::new("out").join(&id));
        let source = from.join(self.source.file_name().unwrap_or_default().to_string_lossy().as_ref());
        let names = [source.clone()].into_iter().chain(facts.files.iter().map(|file| from.join(file)));
        let (mut inputs, mut files, mut folders) = (Vec::new(), Vec::<(PathBuf, PathBuf)>::new(), Vec::new());
        for (name, input) in names.zip(&self.inputs) {
            let path = normal_path(&name);
            if input.blake3.is_some() {
                folders.extend(name.ancestors().skip(1).map(normal_path).filter(|folder| folder.starts_with(&from)));
                match files.iter().find(|(moved, _)| *moved == path) {
                    Some((_, other)) if *other != input.path => {
                        return Err(RunError::NotMovable { path: input.path.clone() });
                    }
                    Some(_) => {}
                    None => files.push((path.clone(), input.path.clone())),
                }
            }
            inputs.push(JobInput { path, ..input.clone() });
        }
        let root = normal_path(&self.output);
        let mut outputs = Vec::with_capacity(self.outputs.len());
        for output in &self.outputs {
            let path = normal_path(&output.path);
            let below = path.strip_prefix(&root).map_err(|_| RunError::NotMovable { path: output.path.clone() })?;
            outputs.push(JobOutput { path: to.join(below), kind: output.kind });
        }
        // The command line works on this machine only.
        let job = Self { source, output: to, inputs, outputs, command: Vec::new(), ..self.clone() };
        Ok(Moved { job, files, folders })
    }
}
