//! Whether an entry of a cache has exactly the outputs of a job. Caches are not trusted: others can write to them.

use std::collections::{BTreeSet, HashSet};
use std::path::{Path, PathBuf};

use crate::cache::{Entry, Unusable};
use crate::run::job::{Job, JobOutput, OutputKind, beside, normal_path};

impl Job {
    /// Checks that `entry` has the document of the job, files only where the job writes them, copies only of files that
    /// the job reads, and every declared output.
    ///
    /// # Errors
    /// [`Unusable`] for the first violation.
    pub fn fits(&self, entry: &Entry) -> Result<(), Unusable> {
        let at = |path: &Path| normal_path(&self.output.join(path));
        let declared: Vec<(PathBuf, OutputKind)> =
            self.outputs.iter().map(|JobOutput { path, kind }| (normal_path(path), *kind)).collect();
        let mut written = BTreeSet::new();
        let document = at(entry.document.path.as_path());
        if declared.first().is_none_or(|(path, _)| *path != document) {
            return Err(Unusable::Document(entry.document.path.clone()));
        }
        written.insert(document);
        for file in &entry.files {
            let path = at(file.path.as_path());
            let is_declared = declared.iter().any(|(output, kind)| match kind {
                OutputKind::File => path == *output,
                OutputKind::Folder => path != *output && path.starts_with(output),
            });
            if !is_declared || !written.insert(path) {
                return Err(Unusable::File(file.path.clone()));
            }
        }
        let read: HashSet<&Path> = self.inputs.iter().map(|input| input.path.as_path()).collect();
        for copy in &entry.copies {
            let path = at(copy.as_path());
            let is_read = read.contains(beside(&self.source, copy.as_path()).as_path());
            if !is_read || !written.insert(path) {
                return Err(Unusable::Copy(copy.clone()));
            }
        }
        let is_written = |(output, kind): &&(PathBuf, OutputKind)| match kind {
            OutputKind::File => written.contains(output),
            OutputKind::Folder => written.range(output.clone()..).next().is_some_and(|path| path.starts_with(output)),
        };
        match declared.iter().find(|output| !is_written(output)) {
            Some((path, _)) => Err(Unusable::Missing(path.clone())),
            None => Ok(()),
        }
    }
}
