//! An asset as it was last planned, and as it is planned again.

use std::path::PathBuf;
use std::time::SystemTime;

use super::look::{Look, Seen};
use crate::digest::Digest;
use crate::project::{Input, Resolved, Values};
use crate::run::{Job, RunError, Written};

/// Files and their current looks.
pub type Looks = Vec<(PathBuf, Option<Look>)>;

/// An asset as it was when it was last planned.
pub struct KnownAsset {
    /// The output folder.
    pub output: PathBuf,
    /// The settings.
    pub values: Values,
    /// The id of the job; `None` where the asset could not be planned.
    pub id: Option<Digest>,
    /// The files that were read.
    pub seen: Vec<(PathBuf, Seen)>,
    /// How the bake ended.
    pub state: State,
}

/// How the bake of an asset ended.
pub enum State {
    /// The asset has these outputs.
    Done(Vec<Written>),
    /// The asset cannot be baked as it is.
    Failed {
        /// Why.
        error: String,
        /// Whether to try at every look, since the failure depends on more than the files of the asset.
        again: bool,
        /// The outputs of the last successful bake, which stay.
        kept: Vec<Written>,
    },
}

impl KnownAsset {
    /// Returns the outputs of the asset: the current ones, or those of the last successful bake.
    pub fn outputs(&self) -> &[Written] {
        match &self.state {
            State::Done(written) => written,
            State::Failed { kept, .. } => kept,
        }
    }

    /// Returns the files that look different from before; `None` where there is no reason to plan the asset again.
    pub fn changed(&self, input: &Input, resolved: &Resolved) -> Option<Looks> {
        let mut is_certain = self.output == input.folder && self.values == resolved.values;
        is_certain &= !matches!(self.state, State::Failed { again: true, .. });
        let mut changed = Vec::new();
        for (path, seen) in &self.seen {
            let look = Look::at(path);
            is_certain &= seen.is_unchanged(look);
            if !seen.looks_like(look) {
                changed.push((path.clone(), look));
            }
        }
        (!is_certain).then_some(changed)
    }

    /// Returns whether `planned` is the job that ended before, so that nothing is to be baked.
    pub fn has_job(&self, planned: &Planned, input: &Input) -> bool {
        let id = planned.job.as_ref().ok().map(|job| job.id);
        let is_open = matches!(self.state, State::Failed { again: true, .. });
        id.is_some() && id == self.id && self.output == input.folder && !is_open
    }

    /// Returns whether the asset failed before with the message `error`, for files that looked like `seen`.
    pub fn has_failed_before(&self, error: &str, seen: &[(PathBuf, Seen)]) -> bool {
        let is_same_look =
            |((a, was), (b, is)): (&(PathBuf, Seen), &(PathBuf, Seen))| a == b && was.look() == is.look();
        let is_same = self.seen.len() == seen.len() && self.seen.iter().zip(seen).all(is_same_look);
        is_same && matches!(&self.state, State::Failed { error: before, .. } if before == error)
    }
}

/// An asset that was planned again.
pub struct Planned {
    /// The job.
    pub job: Result<Job, RunError>,
    /// The files that were read for the plan.
    pub seen: Vec<(PathBuf, Seen)>,
}

impl Planned {
    /// Plans the asset: reads and hashes its files.
    pub fn new(input: &Input, resolved: &Resolved) -> Self {
        let since = SystemTime::now();
        let job = Job::new(&input.path, &input.folder, Some(&input.stem), &resolved.values);
        let seen = |path: &PathBuf, was_found| (path.clone(), Seen::new(Look::at(path), was_found, since));
        let seen = match &job {
            Ok(job) => job.inputs.iter().map(|input| seen(&input.path, input.blake3.is_some())).collect(),
            Err(error) => vec![seen(&input.path, !matches!(error, RunError::Read(_)))],
        };
        Self { job, seen }
    }

    /// Returns the files that were read for the plan and look different from what `known` read, with their looks. The
    /// document is among them if it changed after [`KnownAsset::changed`] looked at it.
    pub fn changed_files(&self, known: Option<&KnownAsset>) -> Looks {
        let known = known.map_or(&[][..], |known| &known.seen);
        let is_known = |path: &PathBuf, look| known.iter().any(|(known, seen)| known == path && seen.looks_like(look));
        let looks = self.seen.iter().map(|(path, seen)| (path.clone(), seen.look()));
        looks.filter(|(path, look)| !is_known(path, *look)).collect()
    }
}

#[cfg(test)]
mod tests;
