//! Planning and running of jobs. A job is independent of other jobs and named by everything that decides on its
//! outputs.
//!
//! A job bakes one asset. It reads the files that it lists and no others, by paths relative to the working folder. It
//! depends on no clock, network or home folder, and so it writes the same bytes wherever it runs.

mod budget;
mod confine;
mod depfile;
mod error;
mod fits;
mod in_order;
mod job;
mod merge;
mod moved;
mod part;
mod plan_assets;
mod plan_file;
mod previous;
mod remote_outcome;
mod restore;
mod run_job;
mod schedule;
mod shard;
mod transient;
mod write_outputs;

pub use budget::{MemoryBudget, Permit};
pub use confine::{Misplaced, confine};
pub use depfile::{DepfileError, split_depfile};
pub use error::RunError;
pub use in_order::in_order;
pub use job::{Job, JobInput, JobOutput, OutputKind, normal_path};
pub use merge::{MERGE_FORMAT, Merged, OpenJob};
pub use moved::Moved;
pub use part::{Part, PartError};
pub use plan_assets::{PlannedAsset, UnknownJob, guard, keep_job, keep_shard, plan_assets};
pub use plan_file::{PLAN_FORMAT, Plan, PlanError};
pub use remote_outcome::{JobFailure, RemoteOutcome, Wait};
pub use restore::Lookup;
pub use run_job::{Done, Prepared, Written, finish, prepare};
pub use schedule::{Progress, RunEvents, Scheduler, uncached};
pub use shard::Shard;
