//! The files to check, and the assets that they should have been baked from.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use walkdir::WalkDir;

use crate::bake::output_stem_of;
use crate::gltf::document::{Container, Document};
use crate::input_file::read_file;
use crate::output::{folder_of, is_same_file};
use crate::project::{Input, InputError, Resolved, Selection, SelectionError, named_container, recorded};
use crate::settings::Form;

/// A file to check.
pub struct CheckedFile {
    /// The path.
    pub path: PathBuf,
    /// The path below the argument that led to the file. The source has this path below the source folder.
    pub below: PathBuf,
}

impl CheckedFile {
    /// Returns whether the file lies in a folder `<stem>.roughcast`, where `bake` puts the textures of a document.
    pub fn is_of_document(&self) -> bool {
        self.below.parent().is_some_and(|folder| has_extension(folder, "roughcast"))
    }

    /// Returns the document of a texture that is checked without it: the one that has the name of the texture's folder.
    pub fn unchecked_document(&self) -> Option<PathBuf> {
        let folder = self.path.parent().filter(|folder| has_extension(folder, "roughcast"))?;
        ["gltf", "glb"].map(|extension| folder.with_extension(extension)).into_iter().find(|path| path.is_file())
    }

    /// Returns whether the file is a texture.
    pub fn is_texture(&self) -> bool {
        has_extension(&self.path, "ktx2")
    }

    /// Returns the key of the asset of `sources` whose output the file is. If no asset has that name, the document may
    /// record the name of its source.
    pub fn key(&self, sources: &Sources) -> PathBuf {
        let key = self.path.with_extension("");
        if sources.folder.is_none() || sources.assets.contains_key(&key) {
            return key;
        }
        let recorded = recorded_source(&self.path).map(|source| self.path.with_file_name(output_stem_of(&source)));
        recorded.filter(|recorded| sources.assets.contains_key(recorded)).unwrap_or(key)
    }
}

/// Finds documents and textures at `argument`, in a fixed order.
///
/// # Errors
/// When there are none, or when a folder cannot be read.
pub fn find_checked_files(argument: &Path) -> io::Result<Vec<CheckedFile>> {
    if !fs::metadata(argument)?.is_dir() {
        let known = ["gltf", "glb", "ktx2"].iter().any(|e| has_extension(argument, e));
        let name = argument.file_name().map(PathBuf::from).filter(|_| known);
        let below = name.ok_or_else(|| io::Error::other("a file that is neither .gltf, .glb nor .ktx2"))?;
        return Ok(vec![CheckedFile { path: argument.to_owned(), below }]);
    }
    let mut targets = Vec::new();
    for entry in WalkDir::new(argument).follow_links(true).sort_by_file_name() {
        let entry = entry?;
        if entry.file_type().is_file() && ["gltf", "glb", "ktx2"].iter().any(|e| has_extension(entry.path(), e)) {
            let below = entry.path().strip_prefix(argument).unwrap_or(entry.path()).to_owned();
            targets.push(CheckedFile { path: entry.into_path(), below });
        }
    }
    if targets.is_empty() { Err(io::Error::other("no .gltf, .glb or .ktx2 files in it")) } else { Ok(targets) }
}

/// An asset of the source folder.
pub struct SourceAsset {
    /// The asset, and where its output belongs.
    pub input: Input,
    /// The current settings of the asset.
    pub resolved: Resolved,
}

impl SourceAsset {
    /// Returns the asset and its settings for a bake to `output`. A document that exists keeps its name, and its
    /// container if the settings leave that open: the user may have chosen both with `-o`.
    pub fn baked_to(&self, output: &Path) -> (Input, Resolved) {
        let (mut input, mut resolved) = (self.input.clone(), self.resolved.clone());
        let named = named_container(output).zip(output.file_stem().and_then(|stem| stem.to_str()));
        if let Some((container, stem)) = named.filter(|_| output.is_file()) {
            input.stem = stem.to_owned();
            let settings = &mut resolved.settings;
            let default = named_container(&input.path).map(|source| settings.container(source));
            if settings.glb.is_none() && settings.gltf != Form::Dual && default != Some(container) {
                let glb = Some(container == Container::Glb);
                (settings.glb, resolved.values.glb) = (glb, glb);
            }
        }
        (input, resolved)
    }
}

/// The assets of the source folder, by the paths of their outputs without extension.
#[derive(Default)]
pub struct Sources {
    /// The source folder; `None` where the user names none.
    pub folder: Option<PathBuf>,
    /// All assets.
    pub assets: BTreeMap<PathBuf, SourceAsset>,
    /// Keys of the assets whose outputs must be among the checked files, since their whole output folder is checked.
    pub expected: Vec<PathBuf>,
    /// Whether a flag or a file sets any value.
    pub is_configured: bool,
    /// Why outputs must not be written.
    pub unsafe_output: Option<InputError>,
}

impl Sources {
    /// Finds the assets of `source`, a folder or one document, that belong to `baked`.
    ///
    /// # Errors
    /// [`SelectionError`] where settings contradict each other or a configuration cannot be read.
    pub fn find(source: &Path, baked: &[PathBuf], selection: &Selection) -> Result<Self, SelectionError> {
        let folder = if source.is_file() { folder_of(source) } else { source };
        let folder = Some(folder.to_owned());
        let mut sources = Self { folder, is_configured: selection.is_explicit(), ..Self::default() };
        for argument in baked {
            let is_folder = argument.is_dir();
            // A missing source is a finding of the output that needs the source.
            let selected = if is_folder {
                selection.find_into(&[source.to_owned()], argument)?
            } else {
                selection.find_named(source_file_of(argument, source).as_slice(), argument)?
            };
            sources.is_configured |= !selected.configs.is_empty();
            let is_unsafe = |error: &InputError| matches!(error, InputError::OutputIsInput { .. });
            sources.unsafe_output = sources.unsafe_output.or(selected.errors.into_iter().find(is_unsafe));
            for (input, resolved) in selected.assets {
                let key = if is_folder { input.folder.join(&input.stem) } else { argument.with_extension("") };
                if is_folder {
                    sources.expected.push(key.clone());
                }
                sources.assets.insert(key, SourceAsset { input, resolved });
            }
        }
        Ok(sources)
    }
}

/// Reads the document that `path` was baked from: it has the same name, in either container.
///
/// # Errors
/// Why there is no such document, for a message.
pub fn source_document(path: &Path) -> Result<Document, String> {
    let existing = source_file(path).ok_or("no .gltf or .glb of that name")?;
    let bytes = read_file(&existing).map_err(|e| e.to_string())?;
    Document::parse(&bytes).map_err(|e| e.to_string())
}

/// Returns the file of `source`, a folder or one document, that `baked` was baked from: by what it records, else by its
/// name. The folders that lead to `baked` may stand in the source folder, too: the more of them, the better. No file is
/// its own source.
fn source_file_of(baked: &Path, source: &Path) -> Option<PathBuf> {
    if source.is_file() {
        return Some(source.to_owned());
    }
    let names: Vec<PathBuf> = recorded_source(baked).into_iter().chain(baked.file_name().map(PathBuf::from)).collect();
    folders_of(baked).into_iter().find_map(|folder| {
        let file = names.iter().find_map(|name| source_file(&source.join(&folder).join(name)));
        file.filter(|file| !is_same_file(file, baked))
    })
}

/// Returns the folders that lead to `path`, then without the first one, and so on; last an empty path.
fn folders_of(path: &Path) -> Vec<PathBuf> {
    let names = folder_of(path).components().rev().take_while(|name| matches!(name, Component::Normal(_)));
    let mut names: Vec<_> = names.collect();
    names.reverse();
    (0..=names.len()).map(|first| names[first..].iter().collect()).collect()
}

/// Returns where the source of `document` is in `folder`, or should be. The document itself is not checked.
pub fn source_of_unchecked(document: &Path, folder: &Path) -> PathBuf {
    let expected = || folder.join(document.file_name().unwrap_or_default());
    source_file_of(document, folder).unwrap_or_else(expected)
}

/// Returns where the source of `target` should be in `folder`, which has no asset for it.
pub fn expected_source(target: &CheckedFile, folder: &Path) -> PathBuf {
    let named = folder.join(&target.below);
    let recorded = recorded_source(&target.path).filter(|_| is_same_file(&named, &target.path));
    match recorded {
        Some(name) => named.with_file_name(name),
        None => named,
    }
}

/// Returns the file name of its source that the document at `baked` records.
fn recorded_source(baked: &Path) -> Option<PathBuf> {
    let source = PathBuf::from(recorded(baked)?.source?);
    // The record may be anybody's, so that folders in it do not count.
    source.file_name().map(PathBuf::from)
}

fn source_file(path: &Path) -> Option<PathBuf> {
    let candidates = [path.to_owned(), path.with_extension("gltf"), path.with_extension("glb")];
    candidates.into_iter().find(|c| c.is_file() && !has_extension(c, "ktx2"))
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}
