//! From the results of a worker to entries of the caller's disk cache, with checks of each part.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

use prost::Message;

use super::action::RESULTS;
use super::api;
use super::client::Client;
use super::digest::Digest;
use super::download::{fetch, fetch_one};
use super::error::RemoteError;
use crate::cache::{DiskCache, Entry, Stored};
use crate::digest::{self, digest};
use crate::remote::JobFailure;
use crate::report::{PartAsset, PartReport};
use crate::run::{Job, Moved};

/// A job that was sent with an action.
pub struct Sent<'a> {
    /// The job with its local paths.
    pub job: &'a Job,
    /// The job with its paths on the worker.
    pub moved: &'a Moved,
}

/// Largest directory tree, entry or text that is read, in bytes.
const MAX_BYTES: u64 = 64 << 20;

/// Stores the outputs of `jobs` from `result` in `disk_cache`. Returns for each job why it failed, or `None` if it did
/// not.
///
/// # Errors
/// [`RemoteError`] if a job has neither outputs nor a reason of its failure.
pub async fn collect(
    result: &api::ActionResult,
    jobs: &[Sent<'_>],
    disk_cache: &DiskCache,
    client: &Client,
) -> Result<Vec<Option<JobFailure>>, RemoteError> {
    let text = |raw: &[u8], digest: &Option<api::Digest>| {
        let (raw, digest) = (raw.to_vec(), digest.as_ref().and_then(Digest::from_api));
        async move {
            match digest {
                Some(digest) if raw.is_empty() && digest.bytes <= MAX_BYTES => fetch_one(digest, client).await,
                _ => Ok(raw),
            }
        }
    };
    let reasons = match result.exit_code {
        0 => HashMap::new(),
        1 | 4 => reasons(&text(&result.stdout_raw, &result.stdout_digest).await?)?,
        code => {
            let text = text(&result.stderr_raw, &result.stderr_digest).await?;
            return Err(RemoteError::Tool { code, text: last_lines(&text) });
        }
    };
    let outputs = outputs(result, client).await?;
    let entries = entries(&outputs, jobs, client).await?;
    let mut failures = Vec::with_capacity(jobs.len());
    for (sent, entry) in jobs.iter().zip(&entries) {
        let reason = reasons.get(sent.moved.job.source.to_string_lossy().as_ref());
        failures.push(match (entry, reason) {
            (Some(_), _) => None,
            (None, None) => return Err(RemoteError::NoOutputs),
            (None, Some(reason)) => {
                Some(JobFailure { message: with_local_paths(&reason.message, sent), is_transient: reason.is_transient })
            }
        });
    }
    let mut blobs: BTreeMap<Digest, &Stored> = BTreeMap::new();
    for stored in entries.iter().flatten().flat_map(|entry| entry.stored()) {
        let sent = outputs.blobs.get(&stored.blake3).filter(|sent| sent.bytes == stored.bytes);
        blobs.insert(*sent.ok_or(RemoteError::NoOutputs)?, stored);
    }
    let digests: Vec<Digest> = blobs.keys().copied().collect();
    let cache_error = |error: crate::cache::CacheError| RemoteError::Cache(error.to_string());
    let mut keep = |sent: Digest, content: &[u8]| {
        let Some(stored) = blobs.get(&sent) else { return Ok(()) };
        if digest(content) != stored.blake3 {
            return Err(RemoteError::Damaged { digest: stored.blake3.to_string() });
        }
        disk_cache.put_blob(stored, content).map_err(cache_error)
    };
    fetch(&digests, client, &mut keep).await?;
    // Entries are stored last, so that the blobs of an entry exist.
    entries.iter().flatten().try_for_each(|entry| disk_cache.put_entry(entry)).map_err(cache_error)?;
    Ok(failures)
}

/// The disk cache that an action wrote: digests of files by their names. Files whose names are not digests are left
/// out.
#[derive(Default)]
struct Outputs {
    jobs: HashMap<digest::Digest, Digest>,
    blobs: HashMap<digest::Digest, Digest>,
}

async fn outputs(result: &api::ActionResult, client: &Client) -> Result<Outputs, RemoteError> {
    let folder = result.output_directories.iter().find(|folder| folder.path == RESULTS);
    let digest = folder.and_then(|folder| folder.tree_digest.as_ref()).and_then(Digest::from_api);
    let Some(digest) = digest.filter(|digest| digest.bytes <= MAX_BYTES) else { return Ok(Outputs::default()) };
    let bytes = fetch_one(digest, client).await?;
    let tree = api::Tree::decode(bytes.as_slice())
        .map_err(|error| RemoteError::Malformed { expected: "a tree of outputs", found: error.to_string() })?;
    let folders: HashMap<Digest, &api::Directory> =
        tree.children.iter().map(|folder| (Digest::of(&folder.encode_to_vec()), folder)).collect();
    let below = |folder: &api::Directory| {
        let digests = folder.directories.iter().filter_map(|below| Digest::from_api(below.digest.as_ref()?));
        digests.filter_map(|digest| folders.get(&digest).copied()).collect::<Vec<_>>()
    };
    // Paths are `jobs/<2 digits>/<id>` and `blobs/<2 digits>/<digest>`.
    let root = tree.root.unwrap_or_default();
    let named = |name: &str| -> HashMap<digest::Digest, Digest> {
        let kinds = root.directories.iter().filter(|kind| kind.name == name);
        let kinds = kinds.filter_map(|kind| folders.get(&Digest::from_api(kind.digest.as_ref()?)?).copied());
        let files = kinds.flat_map(below).flat_map(|folder| &folder.files);
        files.filter_map(|file| Some((file.name.parse().ok()?, Digest::from_api(file.digest.as_ref()?)?))).collect()
    };
    Ok(Outputs { jobs: named("jobs"), blobs: named("blobs") })
}

/// Returns the worker's entry of each job. Invalid entries, and entries that do not fit their job, count as absent.
async fn entries(outputs: &Outputs, jobs: &[Sent<'_>], client: &Client) -> Result<Vec<Option<Entry>>, RemoteError> {
    let digest_of =
        |sent: &Sent<'_>| outputs.jobs.get(&sent.job.id).copied().filter(|digest| digest.bytes <= MAX_BYTES);
    let digests: BTreeSet<Digest> = jobs.iter().filter_map(digest_of).collect();
    let mut found = HashMap::new();
    let mut take = |digest, content: &[u8]| {
        found.insert(digest, content.to_vec());
        Ok(())
    };
    fetch(&digests.into_iter().collect::<Vec<_>>(), client, &mut take).await?;
    let entry_of = |sent: &Sent<'_>| {
        let content = found.get(&digest_of(sent)?)?;
        Entry::read(content, sent.job.id, &|entry| sent.job.fits(entry)).ok()
    };
    Ok(jobs.iter().map(entry_of).collect())
}

/// Returns the reasons why jobs failed, by their sources, from the report of the tool.
fn reasons(report: &[u8]) -> Result<HashMap<String, JobFailure>, RemoteError> {
    let report = PartReport::parse(report)
        .map_err(|error| RemoteError::Malformed { expected: "the report of the tool", found: error.to_string() })?;
    let reason =
        |asset: PartAsset| Some((asset.input, JobFailure { message: asset.error?, is_transient: asset.retry }));
    Ok(report.assets.into_iter().filter_map(reason).collect())
}

/// Returns `reason` with the local paths of the job's files.
fn with_local_paths(reason: &str, sent: &Sent<'_>) -> String {
    let folder = |path: &Path| match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => format!("{}/", parent.display()),
        _ => String::new(),
    };
    let text = reason.replace(&folder(&sent.moved.job.source), &folder(&sent.job.source));
    let text = text.replace(&*sent.moved.job.output.to_string_lossy(), &sent.job.output.to_string_lossy());
    without_controls(&text, 4000)
}

/// Returns the last three lines of the tool's messages.
fn last_lines(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text);
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    without_controls(&lines[lines.len().saturating_sub(3)..].join("; "), 1000)
}

/// Returns at most `length` characters of `text`, without control characters other than line breaks.
fn without_controls(text: &str, length: usize) -> String {
    text.chars().filter(|c| !c.is_control() || *c == '\n').take(length).collect()
}
