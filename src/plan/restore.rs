//! Outputs from the cache. What is in place already stays untouched.

use std::path::Path;

use super::error::RunError;
use super::job::{Job, JobInput, beside};
use super::run::{Done, Written};
use crate::bake::{Places, PublishError, claim, read_file, write_file};
use crate::cache::{Cache, CacheError, Entry, Stored};

/// What a cache knows of a job.
#[derive(Debug)]
pub struct Lookup {
    entry: Result<Option<Entry>, CacheError>,
    /// Whether the outputs are there already.
    is_in_place: bool,
}

impl Lookup {
    /// Looks `job` up and hashes outputs that are there. Jobs may be looked up side by side.
    pub fn new(job: &Job, cache: &Cache) -> Self {
        let entry = cache.entry(&job.id);
        let is_in_place = entry.as_ref().is_ok_and(|entry| entry.as_ref().is_some_and(|entry| is_in_place(job, entry)));
        Self { entry, is_in_place }
    }

    /// Whether the cache has an entry of use.
    pub fn is_found(&self) -> bool {
        matches!(self.entry, Ok(Some(_)))
    }
}

fn is_in_place(job: &Job, entry: &Entry) -> bool {
    let copies = entry.copies.iter().all(|copy| {
        let digest = input(job, copy).and_then(|input| input.blake3.as_deref());
        digest.is_some_and(|digest| holds(&job.output.join(copy), digest))
    });
    copies && entry.files.iter().chain([&entry.document]).all(|file| holds(&job.output.join(&file.path), &file.blake3))
}

/// The input that the document refers to as `file`.
fn input<'j>(job: &'j Job, file: &Path) -> Option<&'j JobInput> {
    let path = beside(&job.source, file);
    job.inputs.iter().find(|input| input.path == path)
}

/// The outputs of `job`, if the cache has them all.
pub fn restore(
    job: &Job,
    places: &mut Places,
    cache: &Cache,
    lookup: Lookup,
    warn: &mut dyn FnMut(&CacheError),
) -> Result<Option<Done>, RunError> {
    let entry = match lookup.entry {
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
        let Some((input, digest)) = input(job, copy).and_then(|input| Some((input, input.blake3.as_deref()?))) else {
            return Ok(None);
        };
        bytes += input.bytes;
        if !lookup.is_in_place && !holds(&to, digest) {
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
        if !lookup.is_in_place && !holds(&to, blake3) {
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
    let copies = entry.copies.iter().map(|copy| Written::copy(job, copy));
    let files = entry.files.iter().chain([&entry.document]);
    let written = copies.chain(files.map(|file| Written::new(job, &file.path, file.blake3.clone()))).collect();
    Ok(Some(Done { output: document, bytes, written, report: entry.report, is_cached: true }))
}

/// Whether the file at `path` has these bytes.
fn holds(path: &Path, digest: &str) -> bool {
    read_file(path).is_ok_and(|bytes| blake3::hash(&bytes).to_hex().as_str() == digest)
}
