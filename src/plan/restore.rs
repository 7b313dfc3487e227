//! Outputs from the cache. What is in place already stays untouched.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::error::RunError;
use super::job::{Job, beside};
use crate::bake::{Places, PublishError, claim, hash_file, read_file, write_file};
use crate::cache::{Cache, CacheError, Entry, RelativePath, Stored};
use crate::digest::{Digest, digest};

/// What a cache knows of a job, before anything is fetched.
#[derive(Debug)]
pub struct Lookup<'c> {
    pub(super) cache: &'c Cache,
    /// The entry, and which of its outputs are to be written.
    entry: Option<(Entry, Vec<RelativePath>)>,
    pub(super) warnings: Vec<CacheError>,
}

/// All that a job is to write.
#[derive(Debug)]
pub struct Found {
    entry: Entry,
    /// Which of its outputs are not in place.
    absent: Vec<RelativePath>,
    /// The bytes of those that are no copies.
    contents: BTreeMap<RelativePath, Vec<u8>>,
}

impl<'c> Lookup<'c> {
    /// Looks `job` up and hashes outputs that are there. Jobs may be looked up side by side.
    pub fn new(job: &Job, cache: &'c Cache) -> Self {
        let mut warnings = Vec::new();
        let entry = cache.entry(job.id, &|entry| job.fits(entry), &mut |error| warnings.push(error));
        let entry = entry.and_then(|entry| {
            let digests: Option<Vec<Digest>> = entry.copies.iter().map(|copy| planned(job, copy.as_path())).collect();
            let copies = entry.copies.iter().zip(digests?);
            let outputs = copies.chain(entry.stored().map(|stored| (&stored.path, stored.blake3)));
            let absent = outputs.filter(|(path, digest)| !holds(&job.output.join(path.as_path()), *digest));
            let absent = absent.map(|(path, _)| path.clone()).collect();
            Some((entry, absent))
        });
        Self { cache, entry, warnings }
    }

    /// Puts what was found into the store that machines share: somebody else has baked it.
    pub fn share(&mut self) {
        if let Some((entry, _)) = &self.entry {
            self.cache.share(entry, &mut |error| self.warnings.push(error));
        }
    }

    /// Fetches what is to be written, if the cache has it all.
    pub(super) fn fetch(&mut self) -> Option<Found> {
        let (entry, absent) = self.entry.take()?;
        let wanted: Vec<&Stored> = entry.stored().filter(|stored| absent.contains(&stored.path)).collect();
        let blobs = self.cache.blobs(&wanted, &mut |error| self.warnings.push(error))?;
        let contents = wanted.iter().map(|stored| stored.path.clone()).zip(blobs).collect();
        self.cache.touch(&entry);
        Some(Found { entry, absent, contents })
    }
}

/// Writes what was `found` of `job`; returns what was known of it.
pub fn restore(job: &Job, places: &mut Places, found: Found) -> Result<Entry, RunError> {
    let Found { entry, absent, contents } = found;
    let document = job.output.join(entry.document.path.as_path());
    let files: Vec<&Path> = entry.files.iter().map(|file| file.path.as_path()).collect();
    let copies: Vec<PathBuf> = entry.copies.iter().map(|copy| copy.as_path().to_owned()).collect();
    claim(&files, &copies, &document, &job.source, places)?;
    for copy in entry.copies.iter().filter(|copy| absent.contains(copy)) {
        let copy = copy.as_path();
        let (from, to) = (beside(&job.source, copy), job.output.join(copy));
        let content = read_file(&from).map_err(|error| PublishError::Copy { path: from.clone(), error })?;
        if planned(job, copy) != Some(digest(&content)) {
            return Err(RunError::Changed { path: from });
        }
        write_file(&to, &content)?;
    }
    for stored in entry.stored() {
        if let Some(content) = contents.get(&stored.path) {
            write_file(&job.output.join(stored.path.as_path()), content)?;
        }
    }
    Ok(entry)
}

/// Returns the digest of what the document refers to as `file`, as it was when the job was planned.
fn planned(job: &Job, file: &Path) -> Option<Digest> {
    job.input(file)?.blake3
}

/// Whether the file at `path` has the bytes whose digest is `blake3`.
pub fn holds(path: &Path, blake3: Digest) -> bool {
    hash_file(path).is_ok_and(|(found, _)| found == blake3)
}
