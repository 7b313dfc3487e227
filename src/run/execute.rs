//! Running a job: from the cache if it is there, else by baking; either way all declared outputs are there afterwards.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use crate::bake::{Baked, Files, Source, bake};
use crate::cache::{CacheError, Entry, Warn};
use crate::digest::{Digest, digest};
use crate::gltf::document::Container;
use crate::input_file::read_file;
use crate::output::Guard;
use crate::report::AssetReport;
use crate::run::budget::MemoryBudget;
use crate::run::error::RunError;
use crate::run::job::{Job, JobInput, beside, parsed};
use crate::run::outputs;
use crate::run::outputs::{New, Outputs};
use crate::run::restore::{Found, Lookup};
use crate::settings::Settings;

/// What a job did.
#[derive(Clone, Debug)]
pub struct Done {
    /// The output document.
    pub output: PathBuf,
    /// Bytes of all outputs.
    pub bytes: u64,
    /// All outputs, the document last.
    pub written: Vec<Written>,
    /// Files of an earlier bake of the asset that were removed, since its new document does not name them.
    pub removed: Vec<PathBuf>,
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
    /// The digest of its bytes.
    pub blake3: Digest,
}

impl Done {
    /// Describes what was written: the files that `entry` lists. Copies have the digests that were planned.
    fn new(job: &Job, entry: Entry, removed: Vec<PathBuf>, is_cached: bool) -> Self {
        let copies = entry.copies.iter().filter_map(|copy| {
            let copy = copy.as_path();
            let input = job.input(copy)?;
            let (path, source) = (job.output.join(copy), beside(&job.source, copy));
            Some((Written { path, source, blake3: input.blake3? }, input.bytes))
        });
        let files = entry.stored().map(|stored| {
            let path = job.output.join(stored.path.as_path());
            (Written { source: path.clone(), path, blake3: stored.blake3 }, stored.bytes)
        });
        let (written, bytes): (Vec<Written>, Vec<u64>) = copies.chain(files).unzip();
        let output = job.output.join(entry.document.path.as_path());
        Self { output, bytes: bytes.iter().sum(), written, removed, report: entry.report, is_cached }
    }
}

/// The part of a job that needs neither the places of outputs nor other jobs.
pub struct Prepared {
    outputs: Result<Ready, RunError>,
    warnings: Vec<CacheError>,
}

enum Ready {
    Found(Box<Found>),
    /// With its entry, if there is a cache.
    Baked(Box<(Option<Entry>, Baked)>),
}

/// Fetches the outputs of `job` if its `lookup` found it, and else bakes them and puts them into the cache, all in memory. Jobs
/// may be prepared side by side, as far as there is `room` for those that are baked; `advance` is as in [`bake`].
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

/// Writes what was prepared where `guard` allows it; `warn` is told what is wrong with the cache.
///
/// # Errors
/// [`RunError`], also of the bake; other jobs are not concerned.
pub fn finish(job: &Job, prepared: Prepared, guard: &mut Guard, warn: Warn<'_>) -> Result<Done, RunError> {
    prepared.warnings.into_iter().for_each(warn);
    let done = match prepared.outputs? {
        Ready::Found(found) => {
            let removed = outputs::write(job, &found.outputs(), guard)?;
            Done::new(job, found.into_entry(), removed, true)
        }
        Ready::Baked(baked) => {
            let (entry, baked) = *baked;
            let name = name(job, &baked);
            // Outputs are hashed while the disk is waited for.
            let (removed, entry) = rayon::join(
                || outputs::write(job, &baked_outputs(&name, &baked), guard),
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

/// Returns all that is to be written of `baked`, whose document is called `name`.
fn baked_outputs<'b>(name: &'b Path, baked: &'b Baked) -> Outputs<'b> {
    let new = |path, bytes| New { path, bytes: Some(bytes) };
    Outputs {
        copies: baked.copies.iter().map(|copy| (copy.as_path(), true)).collect(),
        files: baked.files.iter().map(|file| new(file.path.as_path(), file.bytes.as_slice())).collect(),
        document: new(name, &baked.document),
    }
}

fn baked(job: &Job, budget: &MemoryBudget, advance: &dyn Fn(f32)) -> Result<Baked, RunError> {
    let settings = job.typed_settings()?;
    let permit = budget.acquire(job);
    match attempt(job, &settings, advance) {
        // What others took meanwhile may be enough.
        Err(error) if error.is_out_of_memory() && !permit.is_alone() => {
            drop(permit);
            let _seat = budget.acquire_all();
            attempt(job, &settings, advance)
        }
        ended => ended,
    }
}

fn attempt(job: &Job, settings: &Settings, advance: &dyn Fn(f32)) -> Result<Baked, RunError> {
    let inputs = Inputs::new(job);
    let result: Result<_, RunError> = (|| {
        let document = parsed(&inputs.document().map_err(RunError::Read)?)?;
        let stem = job.stem();
        Ok(bake(&Source { stem: &stem, document: &document, files: &inputs }, settings, advance)?)
    })();
    // Whatever else went wrong, half of a file that was being written explains it.
    match inputs.changed() {
        Some(path) => Err(RunError::Changed { path }),
        None => result,
    }
}

/// The name of the document.
fn name(job: &Job, baked: &Baked) -> PathBuf {
    let extension = if baked.container == Container::Glb { "glb" } else { "gltf" };
    format!("{}.{extension}", job.stem()).into()
}

/// The files of a job: what is read must be what was hashed.
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

    /// The document.
    fn document(&self) -> io::Result<Vec<u8>> {
        self.checked(self.source)
    }

    /// What is at `path`, and it is known whether that changed.
    fn checked(&self, path: &Path) -> io::Result<Vec<u8>> {
        let bytes = self.unchecked(path)?;
        self.check(path, Some(digest(&bytes)));
        Ok(bytes)
    }

    /// What is at `path`; where there is nothing, it is known whether that changed. A file that does not fit into memory has
    /// not changed.
    fn unchecked(&self, path: &Path) -> io::Result<Vec<u8>> {
        read_file(path).inspect_err(|error| {
            if error.kind() != io::ErrorKind::OutOfMemory {
                self.check(path, None);
            }
        })
    }

    fn check(&self, path: &Path, found: Option<Digest>) {
        let planned = self.planned.get(path).and_then(|input| input.blake3);
        // What was there and is gone has changed, too; what was not there is missed by who needs it.
        if found != planned
            && let Ok(mut changed) = self.changed.lock()
        {
            // Images are read side by side: of all that changed, the first by name is told.
            if changed.as_deref().is_none_or(|told| path < told) {
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

    /// The job's id rests on the digests of the plan: a file with another is not copied.
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
mod tests {
    use super::*;

    #[test]
    fn of_all_that_changed_the_first_by_name_is_told() {
        let paths = ["b.png", "a.png", "c.png"];
        let input =
            |path: &&str| JobInput { path: path.into(), blake3: Some(digest(b"a file that is gone")), bytes: 1 };
        let planned: Vec<JobInput> = paths.iter().map(input).collect();
        let planned = planned.iter().map(|input| (input.path.as_path(), input)).collect();
        let inputs = Inputs { source: Path::new("asset.gltf"), planned, changed: Mutex::new(None) };
        for path in paths {
            assert!(inputs.read(Path::new(path)).is_err());
        }
        assert_eq!(inputs.changed(), Some("a.png".into()));
    }

    #[test]
    fn what_its_reader_hashes_is_compared_too() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, "as planned").unwrap();
        let planned = JobInput { path: path.clone(), blake3: Some(digest(b"as planned")), bytes: 10 };
        let source = folder.path().join("asset.gltf");
        let inputs =
            || Inputs { source: &source, planned: [(path.as_path(), &planned)].into(), changed: Mutex::new(None) };
        for (hashed, changed) in [(&b"as planned"[..], None), (b"another", Some(path.clone()))] {
            let inputs = inputs();
            assert_eq!(inputs.read_to_hash(Path::new("a.png")).unwrap(), b"as planned");
            assert_eq!(inputs.changed(), None);
            inputs.hashed(Path::new("a.png"), digest(hashed));
            assert_eq!(inputs.changed(), changed);
        }
    }

    #[test]
    fn files_that_change_after_planning_are_told() {
        let folder = tempfile::tempdir().unwrap();
        for file in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/brushed")).unwrap() {
            let file = file.unwrap();
            std::fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
        }
        let source = folder.path().join("brushed.gltf");
        let job = Job::new(&source, &folder.path().join("baked"), &serde_json::Map::new()).unwrap();
        let bake = || {
            let prepared = prepare(&job, None, &MemoryBudget::new(1), &|_| ());
            finish(&job, prepared, &mut Guard::default(), &mut |_| ())
        };
        assert!(bake().is_ok());
        assert_eq!(job.inputs.len(), 5);
        for input in &job.inputs {
            let path = &input.path;
            let planned = std::fs::read(path).unwrap();
            std::fs::write(path, [&planned[..], b"\n"].concat()).unwrap();
            let told = bake().err();
            assert!(
                matches!(&told, Some(RunError::Changed { path: changed }) if changed == path),
                "{path:?}: {told:?}"
            );
            std::fs::write(path, planned).unwrap();
        }
    }
}
