//! Running a job: from the cache if it is there, else by baking; either way all declared outputs are there afterwards.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::error::RunError;
use super::job::{Job, beside};
use super::restore::{Found, Lookup, restore};
use crate::bake::report::AssetReport;
use crate::bake::{Baked, Places, Source, bake, publish, read_file};
use crate::cache::{CacheError, Warn};
use crate::digest::digest;
use crate::gltf::document::{Container, Document};

/// What a job did.
#[derive(Clone, Debug)]
pub struct Done {
    /// The output document.
    pub output: PathBuf,
    /// Bytes of all outputs.
    pub bytes: u64,
    /// All outputs, the document last.
    pub written: Vec<Written>,
    /// What is in them.
    pub report: AssetReport,
    /// Whether they were baked before.
    pub is_cached: bool,
}

/// An output.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Where it is.
    pub path: PathBuf,
    /// The file that it is a copy of, or itself.
    pub source: PathBuf,
    /// BLAKE3 of its bytes in hex.
    pub blake3: String,
}

impl Written {
    /// A new file in the job's output folder.
    pub fn new(job: &Job, path: &Path, blake3: String) -> Self {
        let path = job.output.join(path);
        Self { source: path.clone(), path, blake3 }
    }

    /// A copy of what the document refers to as `file`.
    pub fn copy(job: &Job, file: &Path) -> Self {
        let source = beside(&job.source, file);
        let input = job.inputs.iter().find(|input| input.path == source);
        let blake3 = input.and_then(|input| input.blake3.clone()).unwrap_or_default();
        Self { path: job.output.join(file), source, blake3 }
    }
}

/// The part of a job that needs neither the places of outputs nor other jobs.
pub struct Prepared {
    outputs: Result<Outputs, RunError>,
    warnings: Vec<CacheError>,
}

enum Outputs {
    Found(Box<Found>),
    Baked(Box<Baked>),
}

/// Fetches the outputs of `job` if its `lookup` found it, and else bakes them and puts them into the cache, all in memory. Jobs
/// may be prepared side by side; `advance` is as in [`bake`].
pub fn prepare(job: &Job, mut lookup: Option<Lookup<'_>>, advance: &dyn Fn(f32)) -> Prepared {
    let outputs = match lookup.as_mut().and_then(|lookup| lookup.fetch(job)) {
        Some(found) => Ok(Outputs::Found(Box::new(found))),
        None => baked(job, advance).map(|baked| {
            if let Some(Lookup { cache, warnings, .. }) = &mut lookup {
                cache.put(&job.id, &document(job, &baked), &baked, &mut |error| warnings.push(error));
            }
            Outputs::Baked(Box::new(baked))
        }),
    };
    Prepared { outputs, warnings: lookup.map(|lookup| lookup.warnings).unwrap_or_default() }
}

/// Writes what was prepared; `warn` is told what is wrong with the cache.
///
/// # Errors
/// [`RunError`], also of the bake; other jobs are not concerned.
pub fn finish(job: &Job, prepared: Prepared, places: &mut Places, warn: Warn<'_>) -> Result<Done, RunError> {
    prepared.warnings.into_iter().for_each(warn);
    let done = match prepared.outputs? {
        Outputs::Found(found) => restore(job, places, *found)?,
        Outputs::Baked(baked) => written(job, &baked, places)?,
    };
    match job.missing_output() {
        None => Ok(done),
        Some(path) => Err(RunError::NoOutput { path: path.to_owned() }),
    }
}

fn baked(job: &Job, advance: &dyn Fn(f32)) -> Result<Baked, RunError> {
    let settings = job.typed_settings()?;
    let inputs = Inputs::new(job);
    let result: Result<_, RunError> = (|| {
        let document = Document::parse(&inputs.read(&job.source).map_err(RunError::Read)?)?;
        let read = |file: &Path| inputs.read(&beside(&job.source, file));
        let stem = job.stem();
        Ok(bake(&Source { stem: &stem, document: &document, read: &read }, &settings, advance)?)
    })();
    // Whatever else went wrong, half of a file that was being written explains it.
    match inputs.changed() {
        Some(path) => Err(RunError::Changed { path }),
        None => result,
    }
}

/// Where the document goes.
fn document(job: &Job, baked: &Baked) -> PathBuf {
    let extension = if baked.container == Container::Glb { "glb" } else { "gltf" };
    job.output.join(format!("{}.{extension}", job.stem()))
}

fn written(job: &Job, baked: &Baked, places: &mut Places) -> Result<Done, RunError> {
    let output = document(job, baked);
    let bytes = publish(baked, &output, &job.source, places)?;
    let copies = baked.copies.iter().map(|copy| Written::copy(job, copy));
    let files = baked.files.iter().map(|file| Written::new(job, &file.path, digest(&file.bytes)));
    let document = Written { path: output.clone(), source: output.clone(), blake3: digest(&baked.document) };
    let written = copies.chain(files).chain([document]).collect();
    Ok(Done { output, bytes, written, report: baked.report.clone(), is_cached: false })
}

/// The files of a job: what is read must be what was hashed.
struct Inputs<'j> {
    digests: BTreeMap<&'j Path, Option<&'j str>>,
    changed: Mutex<Option<PathBuf>>,
}

impl<'j> Inputs<'j> {
    fn new(job: &'j Job) -> Self {
        let digests = job.inputs.iter().map(|input| (input.path.as_path(), input.blake3.as_deref())).collect();
        Self { digests, changed: Mutex::new(None) }
    }

    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let read = read_file(path);
        let found = read.as_ref().ok().map(|bytes| digest(bytes));
        let planned = self.digests.get(path).copied().flatten();
        // What was there and is gone has changed, too; what was not there is missed by who needs it.
        let is_as_planned = found.as_deref() == planned;
        if !is_as_planned && let Ok(mut changed) = self.changed.lock() {
            changed.get_or_insert_with(|| path.to_owned());
        }
        read
    }

    fn changed(&self) -> Option<PathBuf> {
        self.changed.lock().ok().and_then(|changed| changed.clone())
    }
}
