//! Writing of the outputs of a job: copies of its inputs, then new files, then the document.

use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::output::{Guard, OutputPath, Outputs as Wanted, PublishError, Staged, folder_of, real};
use crate::run::error::RunError;
use crate::run::job::{Job, beside};
use crate::run::previous::Previous;

/// All outputs of a job, by their paths in the output folder.
pub struct Outputs<'o> {
    /// Inputs that the document still refers to, and whether each is to be copied: a copy may already be in place.
    pub copies: Vec<(&'o Path, bool)>,
    /// New files.
    pub files: Vec<New<'o>>,
    /// The document.
    pub document: New<'o>,
}

/// A new file.
pub struct New<'o> {
    /// The path.
    pub path: &'o Path,
    /// The bytes; `None` where the file is already in place.
    pub bytes: Option<&'o [u8]>,
}

/// Writes `outputs` of `job` where `guard` allows it. The document is written last, so that a reader of the document
/// finds every file that it names. Either all outputs are written, or none. Returns the files of an earlier bake of the
/// asset that were removed because the new document does not name them.
///
/// # Errors
/// [`RunError`]. No source is ever overwritten: see [`Guard`]. An input that changed since it was planned is not
/// copied.
pub fn write(job: &Job, outputs: &Outputs<'_>, guard: &mut Guard) -> Result<Vec<PathBuf>, RunError> {
    let Outputs { copies, files, document } = outputs;
    // An output that the user named may lie beside its source, and so do then the files that it would copy.
    let is_elsewhere = real(&job.output).ok() != real(folder_of(&job.source)).ok();
    let copies: Vec<&(&Path, bool)> = copies.iter().filter(|_| is_elsewhere).collect();
    let target = job.output.join(document.path);
    let names: Vec<&Path> = files.iter().map(|file| file.path).collect();
    let copied: Vec<PathBuf> = copies.iter().map(|(copy, _)| (*copy).to_owned()).collect();
    let wanted = Wanted { source: &job.source, document: &target, files: &names, copies: &copied };
    let reserved = guard.reserve(&wanted).map_err(|error| gone(job, error))?;
    let previous = document.bytes.and_then(|_| Previous::at(&target));
    if let Some(previous) = &previous {
        previous.check(job)?;
    }
    // Each copy waits for its own disk blocks. If several fail, the error of the first one is returned.
    let absent = copies.par_iter().zip(&reserved.copies).filter(|((_, is_absent), _)| *is_absent);
    let staged: Vec<Result<Staged, RunError>> = absent.map(|((file, _), path)| copy(job, file, path)).collect();
    let mut staged = staged.into_iter().collect::<Result<Vec<_>, _>>()?;
    let stage = |(file, path): (&New<'_>, &OutputPath)| Some(path.stage(file.bytes?));
    let new: Vec<Result<Staged, PublishError>> = files.par_iter().zip(&reserved.files).filter_map(stage).collect();
    for file in new {
        staged.push(file?);
    }
    let document = document.bytes.map(|bytes| reserved.document.stage(bytes)).transpose()?;
    reserved.publish(staged, document)?;
    match previous {
        Some(previous) if job.settings.settings()?.provenance => Ok(previous.remove_stale(job, guard)),
        _ => Ok(Vec::new()),
    }
}

/// Copies the input that the document refers to as `file` beside `path`, if it has the planned digest.
fn copy(job: &Job, file: &Path, path: &OutputPath) -> Result<Staged, RunError> {
    let from = beside(&job.source, file);
    let staged = match job.input(file).and_then(|input| input.blake3) {
        Some(planned) => path.stage_copy(&from, planned).map_err(|error| gone(job, error))?,
        // The file did not exist when the job was planned.
        None => None,
    };
    staged.ok_or(RunError::Changed { path: from })
}

/// Reports an input that was removed since it was planned as changed, and keeps all other errors.
fn gone(job: &Job, error: PublishError) -> RunError {
    match error {
        PublishError::Copy { path, error }
            if error.kind() == io::ErrorKind::NotFound
                && job.inputs.iter().any(|input| input.blake3.is_some() && input.path == path) =>
        {
            RunError::Changed { path }
        }
        error => error.into(),
    }
}
