//! Writing what a job makes: copies of its inputs, then new files, then the document.

use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::output::{Guard, OutputPath, Outputs as Wanted, PublishError, Staged};
use crate::run::error::RunError;
use crate::run::job::{Job, beside};
use crate::run::previous::Previous;

/// All outputs of a job, by their paths in its output folder.
pub struct Outputs<'o> {
    /// Inputs that the document still refers to, and whether each is to be copied: it may be in place.
    pub copies: Vec<(&'o Path, bool)>,
    /// New files.
    pub files: Vec<New<'o>>,
    /// The document.
    pub document: New<'o>,
}

/// A new file.
pub struct New<'o> {
    /// Where it belongs.
    pub path: &'o Path,
    /// Its bytes; `None` where it is in place.
    pub bytes: Option<&'o [u8]>,
}

/// Writes `outputs` of `job` where `guard` allows it, the document last: whoever sees it sees everything that it names. Either all
/// outputs are there afterwards, or none that was not there before. Returns which files of an earlier bake of the asset were
/// removed, since its new document does not name them.
///
/// # Errors
/// [`RunError`]; no source is ever overwritten: see [`Guard`]. Inputs are copied as they were planned, or not at all.
pub fn write(job: &Job, outputs: &Outputs<'_>, guard: &mut Guard) -> Result<Vec<PathBuf>, RunError> {
    let Outputs { copies, files, document } = outputs;
    let target = job.output.join(document.path);
    let names: Vec<&Path> = files.iter().map(|file| file.path).collect();
    let copied: Vec<PathBuf> = copies.iter().map(|(copy, _)| (*copy).to_owned()).collect();
    let wanted = Wanted { source: &job.source, document: &target, files: &names, copies: &copied };
    let reserved = guard.reserve(&wanted).map_err(|error| gone(job, error))?;
    let previous = document.bytes.and_then(|_| Previous::at(&target));
    if let Some(previous) = &previous {
        previous.check(job)?;
    }
    // Each waits for its own disk blocks. If several fail, the error of the first one is returned.
    let absent = copies.par_iter().zip(&reserved.copies).filter(|((_, is_absent), _)| *is_absent);
    let staged: Vec<Result<Staged, RunError>> = absent.map(|((file, _), place)| copy(job, file, place)).collect();
    let mut staged = staged.into_iter().collect::<Result<Vec<_>, _>>()?;
    let stage = |(file, place): (&New<'_>, &OutputPath)| Some(place.stage(file.bytes?));
    let new: Vec<Result<Staged, PublishError>> = files.par_iter().zip(&reserved.files).filter_map(stage).collect();
    for file in new {
        staged.push(file?);
    }
    let document = document.bytes.map(|bytes| reserved.document.stage(bytes)).transpose()?;
    reserved.show(staged, document)?;
    match previous {
        Some(previous) if job.typed_settings()?.provenance => Ok(previous.remove_stale(job, guard)),
        _ => Ok(Vec::new()),
    }
}

/// Copies an input that the document refers to as `file` beside `place`, if it is as it was planned.
fn copy(job: &Job, file: &Path, place: &OutputPath) -> Result<Staged, RunError> {
    let from = beside(&job.source, file);
    let staged = match job.input(file).and_then(|input| input.blake3) {
        Some(planned) => place.stage_copy(&from, planned).map_err(|error| gone(job, error))?,
        // It came after the plan.
        None => None,
    };
    staged.ok_or(RunError::Changed { path: from })
}

/// Tells an input that went away since it was planned from one that was never there.
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
