//! Configurations by their folders, each read once.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use super::error::SelectionError;
use crate::input_file::read_file;
use crate::output;
use crate::project::destination::named_container;
use crate::project::file::{Config, FILE_NAME};
use crate::project::trust::{NamedServer, is_harmless, is_working_folder};

/// A configuration that was read.
pub struct FoundConfig {
    /// The content.
    pub config: Config,
    /// The folder that globs are relative to, without links.
    root: PathBuf,
    /// Whether the user chose the configuration: see [`crate::project::trust`].
    is_trusted: bool,
}

impl FoundConfig {
    /// Returns `asset` relative to the folder of the configuration, or `asset` itself where it lies elsewhere.
    pub fn relative(&self, asset: &Path) -> PathBuf {
        let folder = real(asset.parent().unwrap_or(Path::new("")));
        let path = folder.join(asset.file_name().unwrap_or_default());
        path.strip_prefix(&self.root).map_or_else(|_| asset.to_owned(), Path::to_owned)
    }

    /// Returns the output folder that the configuration names.
    ///
    /// # Errors
    /// [`SelectionError::OutputElsewhere`] where an untrusted configuration may not name the folder, and
    /// [`SelectionError::NamedInConfig`] where the name is that of a document.
    pub fn output_folder(&self) -> Result<Option<PathBuf>, SelectionError> {
        let Some(output) = &self.config.output else { return Ok(None) };
        let path = self.folder().join(output);
        if named_container(output).is_some() {
            return Err(SelectionError::NamedInConfig { config: self.config.path.clone(), path });
        }
        if self.is_trusted || is_harmless(&path) {
            return Ok(Some(path));
        }
        Err(SelectionError::OutputElsewhere { config: self.config.path.clone(), path })
    }

    /// Returns the server that the configuration names.
    pub fn remote(&self) -> Option<NamedServer> {
        let values = self.config.remote.clone()?.in_folder(self.folder());
        Some(NamedServer { values, config: self.config.path.clone(), is_trusted: self.is_trusted })
    }

    /// Returns the folder of the configuration, as it was named.
    fn folder(&self) -> &Path {
        self.config.path.parent().unwrap_or(Path::new(""))
    }
}

/// Configurations by their folders.
#[derive(Default)]
pub struct Configs(BTreeMap<PathBuf, Option<FoundConfig>>);

impl Configs {
    /// Returns the configuration at `path`, which the user named.
    ///
    /// # Errors
    /// [`SelectionError`] where the file cannot be read or has wrong content.
    pub fn named(&mut self, path: &Path) -> Result<Option<&FoundConfig>, SelectionError> {
        let root = real(path.parent().unwrap_or(Path::new("")));
        if !self.0.contains_key(&root) {
            self.0.insert(root.clone(), Some(read(path, &root, true)?));
        }
        Ok(self.0.get(&root).and_then(Option::as_ref))
    }

    /// Returns the configuration in `folder`, or in the nearest folder above that has one.
    ///
    /// # Errors
    /// [`SelectionError`] where the file cannot be read or has wrong content.
    pub fn above(&mut self, folder: &Path) -> Result<Option<&FoundConfig>, SelectionError> {
        let start = real(folder);
        if !self.0.contains_key(&start) {
            let root = start.ancestors().find(|root| root.join(FILE_NAME).is_file());
            let read = |root: &Path| read(&relative_to_here(&root.join(FILE_NAME)), root, is_working_folder(root));
            let found = root.map(read).transpose()?;
            self.0.insert(start.clone(), found);
        }
        Ok(self.0.get(&start).and_then(Option::as_ref))
    }

    /// Returns the paths of all configurations that were read.
    pub fn into_paths(self) -> Vec<PathBuf> {
        self.0.into_values().flatten().map(|found| found.config.path).collect()
    }
}

fn read(path: &Path, root: &Path, is_trusted: bool) -> Result<FoundConfig, SelectionError> {
    let failed = |error| SelectionError::Read { path: path.to_owned(), error };
    let bytes = read_file(path).map_err(failed)?;
    let text = String::from_utf8(bytes).map_err(|e| failed(io::Error::new(io::ErrorKind::InvalidData, e)))?;
    let config = Config::parse(&text, path).map_err(|error| SelectionError::Config { path: path.to_owned(), error })?;
    Ok(FoundConfig { config, root: root.to_owned(), is_trusted })
}

/// Returns `path` relative to the working folder where `path` lies below: that is what the user would write, and it is
/// equal on every machine.
fn relative_to_here(path: &Path) -> PathBuf {
    path.strip_prefix(real(Path::new(""))).map_or_else(|_| path.to_owned(), Path::to_owned)
}

/// Returns `folder` without links and dots, or `folder` itself where it cannot be resolved.
fn real(folder: &Path) -> PathBuf {
    output::real(folder).unwrap_or_else(|_| folder.to_owned())
}
