//! The plan of a run (`schemas/plan.schema.json`).

use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::input_file::{Unreadable, read_file};
use crate::report::{FormatError, check_format};
use crate::run::job::Job;

/// The format version of plans.
pub const PLAN_FORMAT: u32 = 1;

/// The jobs of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Plan {
    /// The format version, [`PLAN_FORMAT`].
    pub format_version: u32,
    /// The version of the tool that is to run the jobs.
    pub version: String,
    /// The jobs, in the order of the inputs.
    pub jobs: Vec<Job>,
}

/// The member of a plan that is read before the others.
#[derive(Deserialize)]
struct Head {
    version: String,
}

/// Why a plan cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The file cannot be read.
    #[error("{}: expected a readable file, found: {}", path.display(), Unreadable(error))]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// A plan of another format.
    #[error("{}: {error}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The two format versions.
        error: FormatError,
    },
    /// No plan.
    #[error("{}: expected a plan as `roughcast plan --json` writes it, found: {reason}; plan again", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What the JSON reader reports.
        reason: String,
    },
    /// A plan of another version of the tool, in which all jobs have other ids.
    #[error(
        "{}: expected a plan of version {}, found one of {version}; plan again",
        path.display(), env!("CARGO_PKG_VERSION")
    )]
    OtherVersion {
        /// The file.
        path: PathBuf,
        /// The version that wrote the plan.
        version: String,
    },
}

impl Plan {
    /// Returns a plan of this version of the tool.
    pub fn new(jobs: Vec<Job>) -> Self {
        Self { format_version: PLAN_FORMAT, version: env!("CARGO_PKG_VERSION").to_owned(), jobs }
    }

    /// Reads a plan of this version of the tool.
    ///
    /// # Errors
    /// [`PlanError`].
    pub fn read(path: &Path) -> Result<Self, PlanError> {
        let owned = || path.to_owned();
        let bytes = read_file(path).map_err(|error| PlanError::Read { path: owned(), error })?;
        check_format(&bytes, "plan", PLAN_FORMAT, "plan again with this version of Roughcast")
            .map_err(|error| PlanError::Format { path: owned(), error })?;
        let malformed = |error: serde_json::Error| PlanError::Malformed { path: owned(), reason: error.to_string() };
        // The version comes first: a plan of another version may have settings that this version does not know.
        let Head { version } = serde_json::from_slice(&bytes).map_err(malformed)?;
        if version != env!("CARGO_PKG_VERSION") {
            return Err(PlanError::OtherVersion { path: owned(), version });
        }
        serde_json::from_slice(&bytes).map_err(malformed)
    }
}

#[cfg(test)]
mod tests;
