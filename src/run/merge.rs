//! What became of a plan that was run in parts.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::digest::Digest;
use crate::run::Plan;
use crate::run::job::Job;

/// What the report of a part (`schemas/report.schema.json`) tells of jobs.
#[derive(Debug, Deserialize)]
pub struct PartReport {
    assets: Vec<Asset>,
}

#[derive(Debug, Deserialize)]
struct Asset {
    /// Absent where the asset could not be planned.
    job: Option<Digest>,
    input: String,
    error: Option<String>,
    #[serde(default)]
    retry: bool,
}

/// All parts together (`schemas/merge.schema.json`).
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Merged {
    /// Number of jobs.
    pub jobs: usize,
    /// Number of those whose outputs are there.
    pub done: usize,
    /// Those that fail, however often they are run.
    pub failed: Vec<Open>,
    /// Those to be run, or run again.
    pub missing: Vec<Open>,
}

/// A job without outputs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Open {
    /// Its id.
    pub id: Digest,
    /// Its source.
    pub source: String,
    /// Why.
    pub reason: String,
}

/// What several reports together say of a job: the later variant wins.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Word<'t> {
    Passing(&'t str),
    Failed(&'t str),
    Done,
}

impl PartReport {
    /// Whether it is about other jobs than those of `plan` only.
    pub fn is_foreign(&self, plan: &Plan) -> bool {
        let is_known = |asset: &Asset| plan.jobs.iter().any(|job| Some(job.id) == asset.job);
        !self.assets.is_empty() && !self.assets.iter().any(is_known)
    }
}

impl Merged {
    /// Goes by `reports`, unless there are none, and `looks` for the declared outputs of jobs that are said to be done.
    pub fn new(plan: &Plan, reports: &[PartReport], looks: bool) -> Self {
        let mut words = BTreeMap::new();
        for asset in reports.iter().flat_map(|report| &report.assets) {
            let word = match &asset.error {
                None => Word::Done,
                Some(error) if asset.retry => Word::Passing(error),
                Some(error) => Word::Failed(error),
            };
            // The same asset in two folders is one id with two sources.
            let known = words.entry((asset.job, asset.input.as_str())).or_insert_with(|| word.clone());
            *known = word.max(known.clone());
        }
        let mut merged = Self { jobs: plan.jobs.len(), done: 0, failed: Vec::new(), missing: Vec::new() };
        for job in &plan.jobs {
            let source = job.source.display().to_string();
            let (list, reason) = match words.get(&(Some(job.id), source.as_str())) {
                Some(Word::Failed(error)) => (&mut merged.failed, (*error).to_owned()),
                Some(Word::Passing(error)) => (&mut merged.missing, (*error).to_owned()),
                None if !reports.is_empty() => (&mut merged.missing, "no report tells of it".to_owned()),
                Some(Word::Done) | None => match job.missing_output().filter(|_| looks) {
                    None => {
                        merged.done += 1;
                        continue;
                    }
                    Some(path) => {
                        let reason = format!("expected {}, found nothing there", path.display());
                        (&mut merged.missing, reason)
                    }
                },
            };
            list.push(Open { id: job.id, source, reason });
        }
        merged
    }

    /// A plan of what is missing of `plan`.
    pub fn rest(&self, plan: &Plan) -> Plan {
        let mut missing = self.missing.iter().peekable();
        let is_missing = |job: &&Job| {
            missing.next_if(|open| open.id == job.id && job.source.display().to_string() == open.source).is_some()
        };
        Plan { version: plan.version.clone(), jobs: plan.jobs.iter().filter(is_missing).cloned().collect() }
    }
}
