//! The choice of the documents to show, as `npm/roughcast/lib/cli/view.js` makes it.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use walkdir::WalkDir;

use super::error::ViewerError;
use super::variant::Variant;
use crate::gltf::document::{Document, DocumentError};
use crate::input_file::{check_file, read_file};
use crate::output::is_same_file;

/// The documents to show.
#[derive(Debug, Default, PartialEq)]
pub struct Chosen {
    /// The document of each variant.
    pub files: BTreeMap<Variant, PathBuf>,
    /// The number of documents of other assets in the folders.
    pub others: usize,
}

/// Chooses the documents that `inputs` name, and from the folders among them those of one asset, which have one name:
/// that of the first named document, else the name of which there are the most. `original` is shown as the original,
/// whatever it is.
///
/// # Errors
/// [`ViewerError`] for inputs that cannot be shown, and for two documents of one variant.
pub fn choose(inputs: &[PathBuf], original: Option<&Path>) -> Result<Chosen, ViewerError> {
    let (mut named, mut found) = (Vec::new(), Vec::new());
    for input in inputs {
        if input.is_dir() {
            for path in documents_below(input)? {
                found.push(described(path)?);
            }
        } else {
            named.push(described(input.clone())?);
        }
    }
    let shown = named.first().map(|(path, _)| stem(path)).or_else(|| most_frequent_stem(&found));
    let shown = shown.map(OsStr::to_owned);
    let (of_asset, others): (Vec<_>, Vec<_>) =
        found.into_iter().partition(|(path, _)| Some(stem(path)) == shown.as_deref());
    let mut files = BTreeMap::new();
    for (path, variant) in named.into_iter().chain(of_asset) {
        match files.entry(variant) {
            Entry::Vacant(free) => {
                free.insert(path);
            }
            // A file that is named may lie in a folder that is named, too.
            Entry::Occupied(first) if is_same_file(first.get(), &path) => {}
            Entry::Occupied(first) => {
                return Err(ViewerError::Twice { variant, first: first.remove(), second: path });
            }
        }
    }
    if let Some(path) = original {
        check_file(path).map_err(|reason| ViewerError::Original { path: path.to_owned(), reason })?;
        files.insert(Variant::Original, path.to_owned());
    }
    Ok(Chosen { files, others: others.len() })
}

/// Returns the .gltf and .glb files below a folder in the order of their names. Links are not followed.
fn documents_below(folder: &Path) -> Result<Vec<PathBuf>, ViewerError> {
    let is_document = |path: &Path| {
        let extension = path.extension().unwrap_or_default();
        ["gltf", "glb"].iter().any(|name| extension.eq_ignore_ascii_case(name))
    };
    let mut documents = Vec::new();
    for entry in WalkDir::new(folder).sort_by_file_name() {
        let entry = entry.map_err(|reason| ViewerError::Walk { path: folder.to_owned(), reason })?;
        if entry.file_type().is_file() && is_document(entry.path()) {
            documents.push(entry.into_path());
        }
    }
    if documents.is_empty() { Err(ViewerError::EmptyFolder { path: folder.to_owned() }) } else { Ok(documents) }
}

/// Reads which variant the document at `path` is.
fn described(path: PathBuf) -> Result<(PathBuf, Variant), ViewerError> {
    let bytes = match read_file(&path) {
        Ok(bytes) => bytes,
        Err(reason) => return Err(ViewerError::Read { path, reason }),
    };
    match Document::parse(&bytes).and_then(|document| Variant::of(&document).map_err(DocumentError::from)) {
        Ok(variant) => Ok((path, variant)),
        Err(reason) => Err(ViewerError::Document { path, reason: Box::new(reason) }),
    }
}

/// Returns the name of a file without its extension.
fn stem(path: &Path) -> &OsStr {
    path.file_stem().unwrap_or_default()
}

/// Returns the stem of which there are the most documents; the first of several such stems.
fn most_frequent_stem(documents: &[(PathBuf, Variant)]) -> Option<&OsStr> {
    let mut counts: Vec<(&OsStr, usize)> = Vec::new();
    for (path, _) in documents {
        match counts.iter_mut().find(|(other, _)| *other == stem(path)) {
            Some((_, count)) => *count += 1,
            None => counts.push((stem(path), 1)),
        }
    }
    // `max_by_key` returns the last maximum.
    counts.into_iter().rev().max_by_key(|(_, count)| *count).map(|(stem, _)| stem)
}
