//! Running of a job, from the cache or by baking. Either way all declared outputs exist afterwards.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use crate::bake::{BakedAsset, Files, Source, bake_asset};
use crate::cache::{CacheError, Entry, RelativePath, Warn};
use crate::digest::{Digest, digest};
use crate::input_file::read_file;
use crate::output::Guard;
use crate::report::{AssetReport, OutputSizes};
use crate::run::budget::MemoryBudget;
use crate::run::error::RunError;
use crate::run::job::{Job, JobInput, beside, parsed};
use crate::run::restore::{Found, Lookup};
use crate::run::write_outputs;
use crate::run::write_outputs::{New, Outputs};
use crate::settings::Settings;

/// What a job did.
#[derive(Clone, Debug)]
pub struct Done {
    /// The output document.
    pub output: PathBuf,
    /// Bytes of all inputs.
    pub inputs: u64,
    /// Bytes of all outputs.
    pub bytes: u64,
    /// All outputs, the document last.
    pub written: Vec<Written>,
    /// Files of an earlier bake of the asset that were removed, since its new document does not name them.
    pub removed: Vec<PathBuf>,
    /// What the outputs contain.
    pub report: AssetReport,
    /// Whether the outputs came from the cache.
    pub is_cached: bool,
}

/// An output.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The path.
    pub path: PathBuf,
    /// The file that the output is a copy of, else the output itself.
    pub source: PathBuf,
    /// The digest of the bytes.
    pub blake3: Digest,
}

impl Done {
    /// Returns the result of a job whose outputs `entry` lists. Copies have the planned digests.
    fn new(job: &Job, entry: Entry, removed: Vec<PathBuf>, is_cached: bool) -> Self {
        let (mut written, mut bytes, mut report) = (Vec::new(), 0, entry.report.clone());
        for copy in entry.copies.iter().map(RelativePath::as_path) {
            let Some((input, blake3)) = job.input(copy).and_then(|input| Some((input, input.blake3?))) else {
                continue;
            };
            let (path, source) = (job.output.join(copy), beside(&job.source, copy));
            let mut copied = OutputSizes::default();
            *if job.is_buffer(&path) { &mut copied.geometry } else { &mut copied.images } = input.bytes;
            report.sizes = report.sizes + copied;
            bytes += input.bytes;
            written.push(Written { path, source, blake3 });
        }
        for stored in entry.stored() {
            let path = job.output.join(stored.path.as_path());
            bytes += stored.bytes;
            written.push(Written { source: path.clone(), path, blake3: stored.blake3 });
        }
        let output = job.output.join(entry.document.path.as_path());
        let inputs = job.inputs.iter().map(|input| input.bytes).sum();
        Self { output, inputs, bytes, written, removed, report, is_cached }
    }
}

/// The outputs of a job in memory, before they are written.
pub struct Prepared {
    outputs: Result<Ready, RunError>,
    warnings: Vec<CacheError>,
}

enum Ready {
    Found(Box<Found>),
    /// The baked outputs, with their entry if there is a cache.
    Baked(Box<(Option<Entry>, BakedAsset)>),
}

/// Fetches the outputs of `job` if its `lookup` found them. Otherwise bakes them and puts them into the cache.
///
/// Writes no output. Jobs may be prepared in parallel; `budget` bounds the memory of those that are baked. `advance` is
/// called as by [`bake_asset`](crate::bake::bake_asset).
pub fn prepare(job: &Job, mut lookup: Option<Lookup<'_>>, budget: &MemoryBudget, advance: &dyn Fn(f32)) -> Prepared {
    let outputs = match lookup.as_mut().and_then(Lookup::fetch) {
        Some(found) => Ok(Ready::Found(Box::new(found))),
        None => baked(job, budget, advance).and_then(|baked| {
            let entry = match lookup.as_mut() {
                None => None,
                Some(Lookup { cache, warnings, .. }) => {
                    let entry = Entry::new(job.id, &name(job, &baked), &baked)?;
                    cache.put(&entry, &baked, &mut |error| warnings.push(error));
                    Some(entry)
                }
            };
            Ok(Ready::Baked(Box::new((entry, baked))))
        }),
    };
    Prepared { outputs, warnings: lookup.map(|lookup| lookup.warnings).unwrap_or_default() }
}

/// Writes the prepared outputs where `guard` allows it. Reports problems of the cache to `warn`.
///
/// # Errors
/// [`RunError`], also that of the bake. Other jobs are not affected.
pub fn finish(job: &Job, prepared: Prepared, guard: &mut Guard, warn: Warn<'_>) -> Result<Done, RunError> {
    prepared.warnings.into_iter().for_each(warn);
    let done = match prepared.outputs? {
        Ready::Found(found) => {
            let removed = write_outputs::write(job, &found.outputs(), guard)?;
            Done::new(job, found.into_entry(), removed, true)
        }
        Ready::Baked(baked) => {
            let (entry, baked) = *baked;
            let name = name(job, &baked);
            // The outputs are hashed while the disk writes.
            let (removed, entry) = rayon::join(
                || write_outputs::write(job, &baked_outputs(&name, &baked), guard),
                || entry.map_or_else(|| Entry::new(job.id, &name, &baked), Ok),
            );
            Done::new(job, entry?, removed?, false)
        }
    };
    match job.missing_output() {
        None => Ok(done),
        Some(path) => {
            let was_written = done.written.iter().any(|file| file.path.starts_with(path)) && !path.exists();
            Err(RunError::NoOutput { path: path.to_owned(), was_written })
        }
    }
}

/// Returns the outputs of `baked`, whose document is called `name`.
fn baked_outputs<'b>(name: &'b Path, baked: &'b BakedAsset) -> Outputs<'b> {
    let new = |path, bytes| New { path, bytes: Some(bytes) };
    Outputs {
        copies: baked.copies.iter().map(|copy| (copy.as_path(), true)).collect(),
        files: baked.files.iter().map(|file| new(file.path.as_path(), file.bytes.as_slice())).collect(),
        document: new(name, &baked.document),
    }
}

fn baked(job: &Job, budget: &MemoryBudget, advance: &dyn Fn(f32)) -> Result<BakedAsset, RunError> {
    let settings = job.settings.settings()?;
    let permit = budget.acquire(job);
    match attempt(job, &settings, advance) {
        // The memory that other jobs took meanwhile may be enough.
        Err(error) if error.is_out_of_memory() && !permit.is_alone() => {
            drop(permit);
            let _permit = budget.acquire_all();
            attempt(job, &settings, advance)
        }
        ended => ended,
    }
}

fn attempt(job: &Job, settings: &Settings, advance: &dyn Fn(f32)) -> Result<BakedAsset, RunError> {
    let inputs = Inputs::new(job);
    let result: Result<_, RunError> = (|| {
        let document = parsed(&inputs.document().map_err(RunError::Read)?)?;
        let (stem, output_stem) = (job.source_stem(), job.output_stem());
        let source = Source { stem: &stem, output_stem: &output_stem, document: &document, files: &inputs };
        Ok(bake_asset(&source, settings, advance)?)
    })();
    // A file that was being written explains every other error.
    match inputs.changed() {
        Some(path) => Err(RunError::Changed { path }),
        None => result,
    }
}

/// Returns the file name of the document.
fn name(job: &Job, baked: &BakedAsset) -> PathBuf {
    format!("{}.{}", job.output_stem(), baked.container.extension()).into()
}

/// The files of a job. The bytes that are read must have the planned digests.
struct Inputs<'j> {
    source: &'j Path,
    planned: BTreeMap<&'j Path, &'j JobInput>,
    changed: Mutex<Option<PathBuf>>,
}

impl<'j> Inputs<'j> {
    fn new(job: &'j Job) -> Self {
        let planned = job.inputs.iter().map(|input| (input.path.as_path(), input)).collect();
        Self { source: &job.source, planned, changed: Mutex::new(None) }
    }

    /// Reads the document.
    fn document(&self) -> io::Result<Vec<u8>> {
        self.checked(self.source)
    }

    /// Reads the file at `path` and compares it with the plan.
    fn checked(&self, path: &Path) -> io::Result<Vec<u8>> {
        let bytes = self.unchecked(path)?;
        self.check(path, Some(digest(&bytes)));
        Ok(bytes)
    }

    /// Reads the file at `path`. A file that cannot be read is compared with the plan, unless it does not fit into
    /// memory.
    fn unchecked(&self, path: &Path) -> io::Result<Vec<u8>> {
        read_file(path).inspect_err(|error| {
            if error.kind() != io::ErrorKind::OutOfMemory {
                self.check(path, None);
            }
        })
    }

    fn check(&self, path: &Path, found: Option<Digest>) {
        let planned = self.planned.get(path).and_then(|input| input.blake3);
        // A file that was removed has changed, too. A file that was missing from the start is an error of its reader.
        if found != planned
            && let Ok(mut changed) = self.changed.lock()
        {
            // Images are read in parallel. If several changed, the first by name is reported.
            if changed.as_deref().is_none_or(|reported| path < reported) {
                *changed = Some(path.to_owned());
            }
        }
    }

    /// Returns length and BLAKE3 of what the document refers to as `file`, as it was planned.
    fn planned(&self, file: &Path) -> Option<(u64, Digest)> {
        let input = self.planned.get(beside(self.source, file).as_path())?;
        Some((input.bytes, input.blake3?))
    }

    fn changed(&self) -> Option<PathBuf> {
        self.changed.lock().ok().and_then(|changed| changed.clone())
    }
}

impl Files for Inputs<'_> {
    fn read(&self, file: &Path) -> io::Result<Vec<u8>> {
        self.checked(&beside(self.source, file))
    }

    /// Returns the planned digest: the id of the job covers it, and a file with another digest is not copied.
    fn digest(&self, file: &Path) -> io::Result<Digest> {
        match self.planned(file) {
            Some((_, blake3)) => Ok(blake3),
            None => self.read(file).map(|bytes| digest(&bytes)),
        }
    }

    fn known_length(&self, file: &Path) -> Option<u64> {
        self.planned(file).map(|(bytes, _)| bytes)
    }

    fn read_to_hash(&self, file: &Path) -> io::Result<Vec<u8>> {
        self.unchecked(&beside(self.source, file))
    }

    fn hashed(&self, file: &Path, blake3: Digest) {
        self.check(&beside(self.source, file), Some(blake3));
    }

    fn is_missing(&self, file: &Path) -> bool {
        let path = beside(self.source, file);
        let is_missing = matches!(fs::metadata(&path), Err(error) if error.kind() == io::ErrorKind::NotFound);
        if is_missing {
            self.check(&path, None);
        }
        is_missing
    }
}

#[cfg(test)]
mod tests;
