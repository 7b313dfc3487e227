//! Writing what a job makes: copies of its inputs, then new files, then the document.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::error::RunError;
use super::job::{Job, beside};
use super::previous::Previous;
use crate::bake::{Places, PublishError, claim, copy_file, sweep, write_file};

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

/// Writes `outputs` of `job`, the document last: whoever sees it sees everything that it names. Returns which files of an
/// earlier bake of the asset were removed, since its new document does not name them.
///
/// # Errors
/// [`RunError`]; no source is ever overwritten: see [`claim`]. Inputs are copied as they were planned, or not at all.
pub fn write(job: &Job, outputs: &Outputs<'_>, places: &mut Places) -> Result<Vec<PathBuf>, RunError> {
    let Outputs { copies, files, document } = outputs;
    let target = job.output.join(document.path);
    let names: Vec<&Path> = files.iter().map(|file| file.path).collect();
    let copied: Vec<PathBuf> = copies.iter().map(|(copy, _)| (*copy).to_owned()).collect();
    claim(&names, &copied, &target, &job.source, places).map_err(|error| gone(job, error))?;
    let previous = document.bytes.and_then(|_| Previous::at(&target));
    if let Some(previous) = &previous {
        previous.check(job)?;
    }
    let below = names.iter().filter_map(|file| file.parent()).chain([Path::new("")]);
    let below: BTreeSet<PathBuf> = below.map(|below| Path::new(".").join(&job.output).join(below)).collect();
    below.iter().for_each(|folder| sweep(folder));
    let absent: Vec<&Path> = copies.iter().filter(|(_, is_absent)| *is_absent).map(|(copy, _)| *copy).collect();
    // Each waits for its own disk blocks. Of all failures the first file's is told.
    let copied: Vec<_> = absent.par_iter().map(|file| copy(job, file)).collect();
    copied.into_iter().collect::<Result<(), _>>()?;
    let put = |file: &New<'_>| file.bytes.map_or(Ok(()), |bytes| write_file(&job.output.join(file.path), bytes));
    let written: Vec<_> = files.par_iter().map(put).collect();
    written.into_iter().collect::<Result<(), _>>()?;
    put(document)?;
    match previous {
        Some(previous) if job.typed_settings()?.provenance => Ok(previous.remove_stale(job, places)),
        _ => Ok(Vec::new()),
    }
}

/// Copies an input that the document refers to as `file`, if it is as it was planned.
fn copy(job: &Job, file: &Path) -> Result<(), RunError> {
    let (from, to) = (beside(&job.source, file), job.output.join(file));
    let is_planned = match job.input(file).and_then(|input| input.blake3) {
        Some(planned) => copy_file(&from, &to, planned).map_err(|error| gone(job, error))?,
        // It came after the plan.
        None => false,
    };
    if is_planned { Ok(()) } else { Err(RunError::Changed { path: from }) }
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
