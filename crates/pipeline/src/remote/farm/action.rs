//! The action that runs a group of jobs. Its inputs are the tool, a plan of the jobs, and exactly the files that the
//! jobs list.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::api;
use super::digest::{Blob, Digest};
use super::error::RemoteError;
use super::tree::Tree;
use crate::digest::{self, digest};
use crate::input_file::read_file;
use crate::remote::Options;
use crate::run::{Moved, Plan};

/// The folder of an action's results, which has the layout of a disk cache.
pub const RESULTS: &str = "cache";

/// The name of the tool on a worker.
const TOOL: &str = "roughcast";

/// The name of the plan on a worker.
const PLAN: &str = "plan.json";

/// An action, ready to be sent.
pub struct Action {
    /// The digest of the action. Equal jobs have equal actions, wherever their files are.
    pub digest: Digest,
    /// All blobs that the action needs, including the action.
    pub blobs: Vec<Blob>,
}

/// The SHA-256 of files by their BLAKE3, so that a file that many jobs read is hashed once.
#[derive(Default)]
pub struct Digests(Mutex<HashMap<digest::Digest, Digest>>);

impl Digests {
    fn of(&self, path: &Path, blake3: digest::Digest) -> Result<Digest, RemoteError> {
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(digest) = known().get(&blake3) {
            return Ok(*digest);
        }
        let bytes =
            read_file(path).map_err(|error| RemoteError::Read { path: path.to_owned(), error: error.into() })?;
        if digest(&bytes) != blake3 {
            return Err(RemoteError::Changed { path: path.to_owned() });
        }
        let digest = Digest::of(&bytes);
        known().insert(blake3, digest);
        Ok(digest)
    }
}

/// Returns the action of `jobs`, which are in the order of their ids.
///
/// # Errors
/// [`RemoteError::Read`], [`RemoteError::Changed`].
pub fn assemble(jobs: &[&Moved], tool: &Blob, options: &Options, digests: &Digests) -> Result<Action, RemoteError> {
    let (mut tree, mut blobs) = (Tree::default(), vec![tool.clone()]);
    tree.file(Path::new(TOOL), tool.digest, true);
    for moved in jobs {
        for folder in &moved.folders {
            tree.folder(folder);
        }
        let digest_of =
            |path: &PathBuf| moved.job.inputs.iter().find(|input| input.path == *path).and_then(|input| input.blake3);
        for (worker_path, local_path) in &moved.files {
            let Some(blake3) = digest_of(worker_path) else { continue };
            let digest = digests.of(local_path, blake3)?;
            tree.file(worker_path, digest, false);
            blobs.push(Blob::with_digest(local_path, digest));
        }
    }
    let mut plan = Plan::new(jobs.iter().map(|moved| moved.job.clone()).collect());
    // One asset in several folders is one job.
    plan.jobs.dedup_by(|a, b| a.id == b.id);
    let plan = serde_json::to_vec(&plan)
        .map_err(|error| RemoteError::Malformed { expected: "names in UTF-8", found: error.to_string() })?;
    let plan = Blob::of_bytes(plan);
    tree.file(Path::new(PLAN), plan.digest, false);
    blobs.push(plan);
    let root = tree.blobs(&mut blobs);
    let tool = format!("./{TOOL}");
    let arguments = [tool.as_str(), "bake", "--plan", PLAN, "--cache", RESULTS, "--cache-size", "1024T", "--json"];
    let command = Blob::of_message(&api::Command {
        arguments: arguments.map(str::to_owned).to_vec(),
        output_paths: vec![RESULTS.to_owned()],
        ..api::Command::default()
    });
    let seconds = options.timeout.map(|limit| i64::try_from(limit.as_secs()).unwrap_or(i64::MAX));
    let action = Blob::of_message(&api::Action {
        command_digest: Some(command.digest.to_api()),
        input_root_digest: Some(root.to_api()),
        timeout: seconds.map(|seconds| api::Duration { seconds, nanos: 0 }),
        platform: platform(options),
        ..api::Action::default()
    });
    let digest = action.digest;
    blobs.extend([command, action]);
    Ok(Action { digest, blobs })
}

/// Returns the platform properties, sorted by name as the API asks.
fn platform(options: &Options) -> Option<api::Platform> {
    let mut properties: Vec<api::platform::Property> = options
        .platform
        .iter()
        .map(|(name, value)| api::platform::Property { name: name.clone(), value: value.clone() })
        .collect();
    properties.sort_by(|a, b| (&a.name, &a.value).cmp(&(&b.name, &b.value)));
    (!properties.is_empty()).then_some(api::Platform { properties })
}
