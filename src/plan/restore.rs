//! Outputs from the cache. What is in place already stays untouched.

use std::path::Path;

use super::error::RunError;
use super::job::{Job, beside};
use super::run::Done;
use crate::bake::{Places, PublishError, claim, read_file, write_file};
use crate::cache::{Cache, CacheError, Stored};

/// The outputs of `job`, if the cache has them all.
pub fn restore(
    job: &Job,
    places: &mut Places,
    cache: &Cache,
    warn: &mut dyn FnMut(&CacheError),
) -> Result<Option<Done>, RunError> {
    let entry = match cache.entry(&job.id) {
        Ok(Some(entry)) => entry,
        Ok(None) => return Ok(None),
        Err(error) => {
            warn(&error);
            return Ok(None);
        }
    };
    let document = job.output.join(&entry.document.path);
    let files: Vec<&Path> = entry.files.iter().map(|file| file.path.as_path()).collect();
    claim(&files, &entry.copies, &document, &job.source, places)?;
    let mut bytes = 0;
    for copy in &entry.copies {
        let (from, to) = (beside(&job.source, copy), job.output.join(copy));
        let input = job.inputs.iter().find(|input| input.path == from);
        let Some(digest) = input.and_then(|input| input.blake3.as_deref()) else { return Ok(None) };
        bytes += input.map_or(0, |input| input.bytes);
        if !holds(&to, digest) {
            let content = read_file(&from).map_err(|error| PublishError::Copy { path: from.clone(), error })?;
            if blake3::hash(&content).to_hex().as_str() != digest {
                return Err(RunError::Changed { path: from });
            }
            write_file(&to, &content)?;
        }
    }
    // The document comes last: whoever sees it sees everything that it names.
    for Stored { path, blake3, bytes: length } in entry.files.iter().chain([&entry.document]) {
        let to = job.output.join(path);
        bytes += length;
        if !holds(&to, blake3) {
            match cache.blob(blake3) {
                Ok(Some(content)) => write_file(&to, &content)?,
                Ok(None) => return Ok(None),
                Err(error) => {
                    warn(&error);
                    return Ok(None);
                }
            };
        }
    }
    cache.touch(&job.id, &entry);
    Ok(Some(Done { output: document, bytes, report: entry.report, is_cached: true }))
}

/// Whether the file at `path` has these bytes.
fn holds(path: &Path, digest: &str) -> bool {
    read_file(path).is_ok_and(|bytes| blake3::hash(&bytes).to_hex().as_str() == digest)
}
