//! Reserves the paths of all outputs of an asset at once.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::PublishError;
use super::guard::Guard;
use super::path::{OutputPath, folder_of};
use super::write::{Staged, publish};
use crate::input_file::check_file;

/// The outputs of an asset.
#[derive(Clone, Copy, Debug)]
pub struct Outputs<'a> {
    /// The asset.
    pub source: &'a Path,
    /// The output document.
    pub document: &'a Path,
    /// New files, relative to the document.
    pub files: &'a [&'a Path],
    /// Files to be copied. Their paths relative to the source and relative to the document are the same.
    pub copies: &'a [PathBuf],
}

/// The reserved output paths of an asset, in the order of [`Outputs`]. If this value is dropped before it is published,
/// new folders are removed: an asset that fails leaves nothing behind.
#[derive(Debug)]
pub struct Reserved {
    /// Paths of copies.
    pub copies: Vec<OutputPath>,
    /// Paths of new files.
    pub files: Vec<OutputPath>,
    /// Path of the document.
    pub document: OutputPath,
    new_folders: Vec<PathBuf>,
}

impl Reserved {
    /// Publishes staged files, and then the document, if any. All files are on the disk before the document appears, so
    /// that a visible document never names a missing file.
    ///
    /// # Errors
    /// [`PublishError::Write`]. New files are removed again.
    pub fn publish(mut self, files: Vec<Staged>, document: Option<Staged>) -> Result<(), PublishError> {
        publish(files, document)?;
        self.new_folders.clear();
        Ok(())
    }
}

impl Drop for Reserved {
    fn drop(&mut self) {
        // The deepest folder comes first. A folder that is not empty stays.
        self.new_folders.iter().rev().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}

impl Guard {
    /// Checks that all of `outputs` may be written, and reserves their paths.
    ///
    /// # Errors
    /// [`PublishError`] for the first output that may not be written, and for a copy whose source cannot be read.
    pub fn reserve(&mut self, outputs: &Outputs<'_>) -> Result<Reserved, PublishError> {
        let Outputs { source, document, files, copies } = *outputs;
        let (source_folder, folder) = (folder_of(source), folder_of(document));
        self.add_source(source);
        copies.iter().for_each(|copy| self.add_source(&source_folder.join(copy)));
        let named: Vec<PathBuf> =
            copies.iter().map(PathBuf::as_path).chain(files.iter().copied()).map(|p| folder.join(p)).collect();
        let places = named.iter().map(PathBuf::as_path).chain([document]);
        let places: Vec<PathBuf> = places.map(|path| self.output(path, folder)).collect::<Result<_, _>>()?;
        for copy in copies {
            let path = source_folder.join(copy);
            check_file(&path).map_err(|error| PublishError::Copy { path, error })?;
        }
        let mut places = places.into_iter();
        for (path, (copy, place)) in named.iter().zip(copies.iter().zip(&mut places)) {
            let path_of_copy = source_folder.join(copy);
            let source = self.real_file(&path_of_copy).unwrap_or(path_of_copy);
            self.register(path, place, source)?;
        }
        for (path, place) in named.iter().skip(copies.len()).map(PathBuf::as_path).chain([document]).zip(places) {
            self.register(path, place.clone(), place)?;
        }
        let mut new_folders: Vec<PathBuf> =
            named.iter().map(PathBuf::as_path).chain([document]).flat_map(missing).collect();
        new_folders.sort();
        new_folders.dedup();
        let places = |paths: &[PathBuf]| paths.iter().map(|path| OutputPath::new(path)).collect();
        let (copies, files) = named.split_at(copies.len());
        Ok(Reserved { copies: places(copies), files: places(files), document: OutputPath::new(document), new_folders })
    }
}

/// Returns the folders above `path` that do not exist.
fn missing(path: &Path) -> impl Iterator<Item = PathBuf> {
    let folders = path.ancestors().skip(1).take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    folders.map(Path::to_owned)
}
