//! What is to be checked, and the assets that it should have been baked from.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use walkdir::WalkDir;

use crate::bake::read_file;
use crate::cli::selection::{SelectionError, SettingOptions};
use crate::gltf::document::Document;
use crate::project::{Input, InputError, Resolved};

/// A file to check.
pub struct Target {
    /// Where it is.
    pub path: PathBuf,
    /// Its place below the argument: that of its source below the source folder.
    pub below: PathBuf,
}

impl Target {
    /// Whether `bake` would have put it there for a document: into a folder `<stem>.roughcast`.
    pub fn is_of_document(&self) -> bool {
        self.below.parent().is_some_and(|folder| has_extension(folder, "roughcast"))
    }

    /// Whether it is a texture.
    pub fn is_texture(&self) -> bool {
        has_extension(&self.path, "ktx2")
    }

    /// Which asset of [`Sources`] it is the output of.
    pub fn key(&self) -> PathBuf {
        self.path.with_extension("")
    }
}

/// Documents and textures at `argument`, in a fixed order.
pub fn find(argument: &Path) -> io::Result<Vec<Target>> {
    if !fs::metadata(argument)?.is_dir() {
        let known = ["gltf", "glb", "ktx2"].iter().any(|e| has_extension(argument, e));
        let name = argument.file_name().map(PathBuf::from).filter(|_| known);
        let below = name.ok_or_else(|| io::Error::other("a file that is neither .gltf, .glb nor .ktx2"))?;
        return Ok(vec![Target { path: argument.to_owned(), below }]);
    }
    let mut targets = Vec::new();
    for entry in WalkDir::new(argument).follow_links(true).sort_by_file_name() {
        let entry = entry?;
        if entry.file_type().is_file() && ["gltf", "glb", "ktx2"].iter().any(|e| has_extension(entry.path(), e)) {
            let below = entry.path().strip_prefix(argument).unwrap_or(entry.path()).to_owned();
            targets.push(Target { path: entry.into_path(), below });
        }
    }
    if targets.is_empty() { Err(io::Error::other("no .gltf, .glb or .ktx2 files in it")) } else { Ok(targets) }
}

/// An asset of the source folder.
pub struct Asset {
    /// The asset, and where its output belongs.
    pub input: Input,
    /// The settings that hold for it today.
    pub resolved: Resolved,
}

/// The assets of the source folder, by the paths of their outputs without extension.
#[derive(Default)]
pub struct Sources {
    /// All of them.
    pub assets: BTreeMap<PathBuf, Asset>,
    /// Those whose output must be among what is checked, since its whole folder is.
    pub expected: Vec<PathBuf>,
    /// Whether anything but defaults is said: by a flag, or by a file.
    pub is_configured: bool,
    /// Why outputs must not be written.
    pub unsafe_output: Option<InputError>,
}

impl Sources {
    /// Those of `source` that belong to `baked`.
    ///
    /// # Errors
    /// [`SelectionError`] where settings make no sense.
    pub fn find(source: &Path, baked: &[PathBuf], settings: &SettingOptions) -> Result<Self, SelectionError> {
        let mut sources = Self { is_configured: settings.is_explicit(), ..Self::default() };
        for argument in baked {
            let is_folder = argument.is_dir();
            let (inputs, output) = if is_folder {
                (vec![source.to_owned()], argument.as_path())
            } else {
                let name = argument.file_name().unwrap_or_default();
                (source_file(&source.join(name)).into_iter().collect(), argument.parent().unwrap_or(Path::new("")))
            };
            // Sources that are not there are told of by the outputs that need them.
            let selected = settings.find(&inputs, output)?;
            sources.is_configured |= !selected.configs.is_empty();
            let is_unsafe = |error: &InputError| matches!(error, InputError::OutputIsInput { .. });
            sources.unsafe_output = sources.unsafe_output.or(selected.errors.into_iter().find(is_unsafe));
            for (input, resolved) in selected.assets {
                let key = input.folder.join(&input.stem);
                if is_folder {
                    sources.expected.push(key.clone());
                }
                sources.assets.insert(key, Asset { input, resolved });
            }
        }
        Ok(sources)
    }
}

/// The document that `path` was baked from: of the same name, in either container.
pub fn source_document(path: &Path) -> Result<Document, String> {
    let existing = source_file(path).ok_or("no .gltf or .glb of that name")?;
    let bytes = read_file(&existing).map_err(|e| e.to_string())?;
    Document::parse(&bytes).map_err(|e| e.to_string())
}

fn source_file(path: &Path) -> Option<PathBuf> {
    let candidates = [path.to_owned(), path.with_extension("gltf"), path.with_extension("glb")];
    candidates.into_iter().find(|c| c.is_file() && !has_extension(c, "ktx2"))
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}
