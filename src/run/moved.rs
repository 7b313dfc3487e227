//! A job in a place of its own: where its paths tell nothing of the machine that planned it, equal jobs are equal.

use std::path::{Path, PathBuf};

use crate::bake::survey;
use crate::digest::digest;
use crate::input_file::read_file;
use crate::run::error::RunError;
use crate::run::job::{Job, JobInput, JobOutput, parsed, roughened};

/// A job below `in/<id>` and `out/<id>`.
#[derive(Clone, Debug)]
pub struct Moved {
    /// The same job.
    pub job: Job,
    /// Files that must be there, and where they are now.
    pub files: Vec<(PathBuf, PathBuf)>,
    /// Folders that must be there: what the document calls `a/../b` needs `a`.
    pub folders: Vec<PathBuf>,
}

impl Job {
    /// The job in a place of its own. Reads the document.
    ///
    /// # Errors
    /// [`RunError::Changed`] if the document is not as it was planned; [`RunError::NotMovable`] where a path leads elsewhere.
    pub fn moved(&self) -> Result<Moved, RunError> {
        let bytes = read_file(&self.source).map_err(RunError::Read)?;
        if self.inputs.first().and_then(|input| input.blake3) != Some(digest(&bytes)) {
            return Err(RunError::Changed { path: self.source.clone() });
        }
        let survey = survey(&parsed(&bytes)?)?;
        let id = self.id.to_string();
        let (from, to) = (Path::new("in").join(&id), Path::new("out").join(&id));
        let source = from.join(self.source.file_name().unwrap_or_default().to_string_lossy().as_ref());
        let names = [source.clone()].into_iter().chain(survey.files.iter().map(|file| from.join(file)));
        let (mut inputs, mut files, mut folders) = (Vec::new(), Vec::<(PathBuf, PathBuf)>::new(), Vec::new());
        for (name, input) in names.zip(&self.inputs) {
            let path = roughened(&name);
            if input.blake3.is_some() {
                folders.extend(name.ancestors().skip(1).map(roughened).filter(|folder| folder.starts_with(&from)));
                match files.iter().find(|(there, _)| *there == path) {
                    Some((_, other)) if *other != input.path => {
                        return Err(RunError::NotMovable { path: input.path.clone() });
                    }
                    Some(_) => {}
                    None => files.push((path.clone(), input.path.clone())),
                }
            }
            inputs.push(JobInput { path, ..input.clone() });
        }
        let root = roughened(&self.output);
        let mut outputs = Vec::with_capacity(self.outputs.len());
        for output in &self.outputs {
            let path = roughened(&output.path);
            let below = path.strip_prefix(&root).map_err(|_| RunError::NotMovable { path: output.path.clone() })?;
            outputs.push(JobOutput { path: to.join(below), kind: output.kind });
        }
        // Another machine has no use for the command line that works here.
        let job = Self { source, output: to, inputs, outputs, command: Vec::new(), ..self.clone() };
        Ok(Moved { job, files, folders })
    }
}
