//! Where the jobs of a plan may write. Others may have edited the file of a plan, and ids do not cover output folders.

use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use crate::run::Plan;

/// Why no job of a plan is run.
#[derive(Debug, thiserror::Error)]
pub enum Misplaced {
    /// An output folder that the user did not name.
    #[error(
        "expected output folders in the working folder, found {}; name the folder with -o if it is right",
        output.display()
    )]
    Outside {
        /// The folder.
        output: PathBuf,
    },
    /// An output folder that is a source folder or holds one.
    #[error(
        "expected output folders apart from the sources, found that {} is or holds the folder of {}; plan again",
        output.display(), source_file.display()
    )]
    OverSource {
        /// The folder.
        output: PathBuf,
        /// A source of the plan.
        source_file: PathBuf,
    },
    /// A folder that cannot be looked up.
    #[error("expected a working folder that can be read, found: {0}; run in a folder that exists and is readable")]
    Io(#[from] io::Error),
}

/// Checks the output folders of all jobs of `plan`. Each must lie below the working folder, or below the folder `named`
/// by the user, and none may be or hold the folder of a source.
///
/// # Errors
/// [`Misplaced`]; then no job of the plan may run.
pub fn confine(plan: &Plan, named: Option<&Path>) -> Result<(), Misplaced> {
    let mut folders = Folders::new()?;
    let mut allowed = vec![folders.working.clone()];
    allowed.extend(named.map(|named| folders.real(named)));
    let mut sources = BTreeMap::new();
    for job in &plan.jobs {
        let folder = folders.real(job.source.parent().unwrap_or(Path::new("")));
        sources.entry(folder).or_insert(&job.source);
    }
    for job in &plan.jobs {
        let output = folders.real(&job.output);
        if !allowed.iter().any(|allowed| output.starts_with(allowed)) {
            return Err(Misplaced::Outside { output: job.output.clone() });
        }
        // In the order of paths, the folders below a folder follow it directly.
        if let Some((folder, source)) = sources.range(output.clone()..).next()
            && folder.starts_with(&output)
        {
            return Err(Misplaced::OverSource { output: job.output.clone(), source_file: source.to_path_buf() });
        }
    }
    Ok(())
}

/// Folders without links and dots, each looked up once.
struct Folders {
    working: PathBuf,
    known: HashMap<PathBuf, PathBuf>,
}

impl Folders {
    fn new() -> io::Result<Self> {
        Ok(Self { working: fs::canonicalize(".")?, known: HashMap::new() })
    }

    /// Returns `folder` without links and dots, as it will be when missing folders on the way exist.
    fn real(&mut self, folder: &Path) -> PathBuf {
        if let Some(real) = self.known.get(folder) {
            return real.clone();
        }
        let mut real = self.working.clone();
        for part in folder.components() {
            match part {
                Component::CurDir => {}
                Component::ParentDir => drop(real.pop()),
                part => {
                    real.push(part);
                    real = fs::canonicalize(&real).unwrap_or(real);
                }
            }
        }
        self.known.insert(folder.to_owned(), real.clone());
        real
    }
}
