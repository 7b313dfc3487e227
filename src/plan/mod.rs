//! What a run will do, before it does it: independent jobs, each named by all that decides on its outputs.
//!
//! A job is one asset. It reads the files that it lists and no others, by paths relative to the working folder, and knows
//! no clock, network or home folder: run anywhere, it writes the same bytes.

mod error;
mod in_order;
mod job;
mod moved;
mod restore;
mod run;

use serde::{Deserialize, Serialize};

pub use error::RunError;
pub use in_order::in_order;
pub use job::{Job, JobInput, JobOutput, OutputKind, folded};
pub use moved::Moved;
pub use restore::Lookup;
pub use run::{Done, Prepared, Written, finish, prepare};

/// The jobs of a run (`schemas/plan.schema.json`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Plan {
    /// Version of the tool that is to run them.
    pub version: String,
    /// In the order of the inputs.
    pub jobs: Vec<Job>,
}

/// One of several equal parts of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub index: u64,
    /// Number of parts.
    pub count: u64,
}

impl Shard {
    /// Whether `job` is in this part: by its id, so that it does not depend on the other jobs.
    pub fn has(&self, job: &Job) -> bool {
        let number = job.id.get(..16).and_then(|digits| u64::from_str_radix(digits, 16).ok()).unwrap_or(0);
        number % self.count + 1 == self.index
    }
}
