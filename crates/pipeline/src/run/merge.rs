//! The merged result of a plan that was run in parts.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::digest::Digest;
use crate::report::{PartAsset, PartReport};
use crate::run::job::Job;
use crate::run::plan_file::Plan;

/// The format version of merged results.
pub const MERGE_FORMAT: u32 = 1;

/// The results of all parts (`schemas/merge.schema.json`).
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Merged {
    /// The format version, [`MERGE_FORMAT`].
    pub format_version: u32,
    /// The version of the tool.
    pub version: &'static str,
    /// Number of jobs.
    pub jobs: usize,
    /// Number of jobs whose outputs exist.
    pub done: usize,
    /// Jobs that fail, however often they are run.
    pub failed: Vec<OpenJob>,
    /// Jobs to be run, or to be run again.
    pub missing: Vec<OpenJob>,
}

/// A job without outputs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct OpenJob {
    /// The id.
    pub id: Digest,
    /// The source.
    pub source: String,
    /// Why there are no outputs.
    pub reason: String,
}

/// What several reports record of one job; the greatest variant wins.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Recorded<'t> {
    Transient(&'t str),
    Failed(&'t str),
    Done,
}

impl Recorded<'_> {
    fn of(asset: &PartAsset) -> Recorded<'_> {
        match &asset.error {
            None => Recorded::Done,
            Some(error) if asset.retry => Recorded::Transient(error),
            Some(error) => Recorded::Failed(error),
        }
    }
}

/// How a job of the plan ended.
enum Ended {
    Done,
    Failed(String),
    Missing(String),
}

impl Merged {
    /// Merges `reports` of parts of `plan`. If `looks` is true, jobs are only done if their declared outputs exist.
    /// Without reports, the declared outputs alone decide.
    pub fn new(plan: &Plan, reports: &[PartReport], looks: bool) -> Self {
        let mut records = BTreeMap::new();
        for asset in reports.iter().flat_map(|report| &report.assets) {
            let record = Recorded::of(asset);
            // An asset that lies in two folders is one id with two sources.
            let known = records.entry((asset.job, asset.input.as_str())).or_insert_with(|| record.clone());
            *known = record.max(known.clone());
        }
        let mut merged = Self {
            format_version: MERGE_FORMAT,
            version: env!("CARGO_PKG_VERSION"),
            jobs: plan.jobs.len(),
            done: 0,
            failed: Vec::new(),
            missing: Vec::new(),
        };
        for job in &plan.jobs {
            let source = job.source.display().to_string();
            let ended = match records.get(&(Some(job.id), source.as_str())) {
                Some(Recorded::Failed(error)) => Ended::Failed((*error).to_owned()),
                Some(Recorded::Transient(error)) => Ended::Missing((*error).to_owned()),
                None if !reports.is_empty() => Ended::Missing("no report names the job".to_owned()),
                Some(Recorded::Done) | None => by_outputs(job, looks),
            };
            match ended {
                Ended::Done => merged.done += 1,
                Ended::Failed(reason) => merged.failed.push(OpenJob { id: job.id, source, reason }),
                Ended::Missing(reason) => merged.missing.push(OpenJob { id: job.id, source, reason }),
            }
        }
        merged
    }

    /// Returns a plan of the missing jobs of `plan`.
    pub fn rest(&self, plan: &Plan) -> Plan {
        let mut missing = self.missing.iter().peekable();
        let is_missing = |job: &&Job| {
            missing.next_if(|open| open.id == job.id && job.source.display().to_string() == open.source).is_some()
        };
        Plan::new(plan.jobs.iter().filter(is_missing).cloned().collect())
    }
}

/// Returns how `job` ended by its declared outputs, if `looks` is true.
fn by_outputs(job: &Job, looks: bool) -> Ended {
    match job.missing_output().filter(|_| looks) {
        None => Ended::Done,
        Some(path) => Ended::Missing(format!("expected {}, found nothing there", path.display())),
    }
}

impl Plan {
    /// Returns whether `report` has assets, and none of them is a job of this plan.
    pub fn is_foreign(&self, report: &PartReport) -> bool {
        let is_known = |asset: &PartAsset| self.jobs.iter().any(|job| Some(job.id) == asset.job);
        !report.assets.is_empty() && !report.assets.iter().any(is_known)
    }
}
