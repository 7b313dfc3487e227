//! An asset as it was, and as it is planned anew.

use std::path::PathBuf;
use std::time::SystemTime;

use serde_json::{Map, Value};

use crate::digest::Digest;
use crate::project::{Input, Resolved};
use crate::run::{Job, RunError, Written};
use crate::watch::{Look, Seen};

/// Files, as they look.
pub type Looks = Vec<(PathBuf, Option<Look>)>;

/// An asset as it was when it was last planned.
pub struct Asset {
    /// Output folder.
    pub output: PathBuf,
    /// Settings.
    pub values: Map<String, Value>,
    /// The job's id; `None` where there can be no job.
    pub id: Option<Digest>,
    /// The files that it read.
    pub seen: Vec<(PathBuf, Seen)>,
    /// What became of it.
    pub state: State,
}

/// What became of an asset.
pub enum State {
    /// It has these outputs.
    Done(Vec<Written>),
    /// It cannot be baked as it is.
    Failed {
        /// Why.
        error: String,
        /// Whether to try at every look, since it does not depend on the asset's files alone.
        again: bool,
        /// Outputs of its last good bake, which stay.
        kept: Vec<Written>,
    },
}

impl Asset {
    /// Returns its outputs: those of the asset as it is, or of its last good bake.
    pub fn outputs(&self) -> &[Written] {
        match &self.state {
            State::Done(written) => written,
            State::Failed { kept, .. } => kept,
        }
    }

    /// Files that look other than they did; `None` where there is no reason to plan the asset.
    pub fn changed(&self, input: &Input, resolved: &Resolved) -> Option<Looks> {
        let mut is_certain = self.output == input.folder && self.values == resolved.values;
        is_certain &= !matches!(self.state, State::Failed { again: true, .. });
        let mut changed = Vec::new();
        for (path, seen) in &self.seen {
            let look = Look::at(path);
            is_certain &= seen.is_still(look);
            if !seen.looks_like(look) {
                changed.push((path.clone(), look));
            }
        }
        (!is_certain).then_some(changed)
    }

    /// Whether `planned` comes to the same as it did.
    pub fn is_as(&self, planned: &Planned, input: &Input) -> bool {
        let id = planned.job.as_ref().ok().map(|job| job.id);
        let is_open = matches!(self.state, State::Failed { again: true, .. });
        id.is_some() && id == self.id && self.output == input.folder && !is_open
    }

    /// Whether it failed for the reason `error` with files that looked like `seen`.
    pub fn has_failed_so(&self, error: &str, seen: &[(PathBuf, Seen)]) -> bool {
        let same_look = |((a, was), (b, is)): (&(PathBuf, Seen), &(PathBuf, Seen))| a == b && was.look() == is.look();
        let is_same = self.seen.len() == seen.len() && self.seen.iter().zip(seen).all(same_look);
        is_same && matches!(&self.state, State::Failed { error: before, .. } if before == error)
    }
}

/// An asset that was planned anew.
pub struct Planned {
    /// Its job.
    pub job: Result<Job, RunError>,
    /// The files that were read for it.
    pub seen: Vec<(PathBuf, Seen)>,
}

impl Planned {
    /// Plans the asset: reads and hashes its files.
    pub fn new(input: &Input, resolved: &Resolved) -> Self {
        let since = SystemTime::now();
        let job = Job::new(&input.path, &input.folder, &resolved.values);
        let seen = |path: &PathBuf, was_found| (path.clone(), Seen::new(Look::at(path), was_found, since));
        let seen = match &job {
            Ok(job) => job.inputs.iter().map(|input| seen(&input.path, input.blake3.is_some())).collect(),
            Err(error) => vec![seen(&input.path, !matches!(error, RunError::Read(_)))],
        };
        Self { job, seen }
    }

    /// Files beside the document that `known` did not read, as they look.
    pub fn new_files(&self, input: &Input, known: Option<&Asset>) -> Looks {
        let known = known.map_or(&[][..], |known| &known.seen);
        let is_new = |path: &PathBuf| *path != input.path && known.iter().all(|(known, _)| known != path);
        let paths = self.seen.iter().map(|(path, _)| path).filter(|path| is_new(path));
        paths.map(|path| (path.clone(), Look::at(path))).collect()
    }
}
