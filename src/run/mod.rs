//! What a run will do, before it does it: independent jobs, each named by all that decides on its outputs.
//!
//! A job is one asset. It reads the files that it lists and no others, by paths relative to the working folder, and knows
//! no clock, network or home folder: run anywhere, it writes the same bytes.

mod budget;
mod confine;
mod error;
mod execute;
mod fits;
mod in_order;
mod job;
mod merge;
mod moved;
mod outputs;
mod passing;
mod previous;
mod restore;
mod shard;

use serde::{Deserialize, Serialize};

pub use budget::{MemoryBudget, Permit};
pub use confine::{Misplaced, confine};
pub use error::RunError;
pub use execute::{Done, Prepared, Written, finish, prepare};
pub use in_order::in_order;
pub use job::{Job, JobInput, JobOutput, OutputKind, roughened};
pub use merge::{Merged, Open, PartReport};
pub use moved::Moved;
pub use previous::recorded;
pub use restore::Lookup;
pub use shard::Shard;

/// The jobs of a run (`schemas/plan.schema.json`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Plan {
    /// Version of the tool that is to run them.
    pub version: String,
    /// In the order of the inputs.
    pub jobs: Vec<Job>,
}
