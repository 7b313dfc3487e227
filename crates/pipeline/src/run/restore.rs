//! Outputs from the cache. Outputs that are already in place are not written again.

use std::collections::BTreeMap;
use std::path::Path;

use crate::cache::{Cache, CacheError, Entry, RelativePath, Stored};
use crate::digest::Digest;
use crate::input_file::holds;
use crate::run::job::Job;
use crate::run::write_outputs::{New, Outputs};

/// What a cache has of a job, before anything is fetched.
#[derive(Debug)]
pub struct Lookup<'c> {
    pub(super) cache: &'c Cache,
    /// The entry, and the outputs that are to be written.
    entry: Option<(Entry, Vec<RelativePath>)>,
    pub(super) warnings: Vec<CacheError>,
}

/// The outputs of a job from the cache.
#[derive(Debug)]
pub struct Found {
    entry: Entry,
    /// The outputs that are not in place.
    absent: Vec<RelativePath>,
    /// The bytes of absent outputs that are no copies.
    contents: BTreeMap<RelativePath, Vec<u8>>,
}

impl<'c> Lookup<'c> {
    /// Looks `job` up and hashes its existing outputs. Jobs may be looked up in parallel.
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

    /// Puts the entry into the object store, since somebody else baked the job.
    pub fn share(&mut self) {
        if let Some((entry, _)) = &self.entry {
            self.cache.share(entry, &mut |error| self.warnings.push(error));
        }
    }

    /// Fetches the outputs that are to be written; returns `None` unless the cache has all of them.
    pub(super) fn fetch(&mut self) -> Option<Found> {
        let (entry, absent) = self.entry.take()?;
        let wanted: Vec<&Stored> = entry.stored().filter(|stored| absent.contains(&stored.path)).collect();
        let blobs = self.cache.blobs(&wanted, &mut |error| self.warnings.push(error))?;
        let contents = wanted.iter().map(|stored| stored.path.clone()).zip(blobs).collect();
        self.cache.touch(&entry);
        Some(Found { entry, absent, contents })
    }
}

impl Found {
    /// Returns the entry.
    pub(super) fn into_entry(self) -> Entry {
        self.entry
    }

    /// Returns the outputs, with the bytes of those that are not in place.
    pub(super) fn outputs(&self) -> Outputs<'_> {
        Outputs {
            copies: self.entry.copies.iter().map(|copy| (copy.as_path(), self.absent.contains(copy))).collect(),
            files: self.entry.files.iter().map(|file| self.new_file(file)).collect(),
            document: self.new_file(&self.entry.document),
        }
    }

    fn new_file<'f>(&'f self, stored: &'f Stored) -> New<'f> {
        New { path: stored.path.as_path(), bytes: self.contents.get(&stored.path).map(Vec::as_slice) }
    }
}

/// Returns the planned digest of the file that the document refers to as `file`.
fn planned(job: &Job, file: &Path) -> Option<Digest> {
    job.input(file)?.blake3
}
