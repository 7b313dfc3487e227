//! The inputs of an action, as a tree of digests.

use std::collections::BTreeMap;
use std::path::{Component, Path};

use super::api;
use super::digest::{Blob, Digest};

/// A folder. Names are sorted by their bytes, as the API asks.
#[derive(Debug, Default)]
pub struct Tree {
    files: BTreeMap<String, (Digest, bool)>,
    folders: BTreeMap<String, Tree>,
}

impl Tree {
    /// Adds a file at `path`, which is relative and without dots.
    pub fn file(&mut self, path: &Path, digest: Digest, is_executable: bool) {
        let folder = self.folder(path.parent().unwrap_or(Path::new("")));
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        folder.files.insert(name, (digest, is_executable));
    }

    /// Returns the folder at `path`, which is relative and without dots. Missing folders are added.
    pub fn folder(&mut self, path: &Path) -> &mut Self {
        path.components().fold(self, |folder, part| match part {
            Component::Normal(name) => folder.folders.entry(name.to_string_lossy().into_owned()).or_default(),
            _ => folder,
        })
    }

    /// Returns the digest of the folder, and adds the blobs of the folder and its subfolders to `blobs`. The recursion
    /// is not deep, since paths of existing files are short.
    pub fn blobs(&self, blobs: &mut Vec<Blob>) -> Digest {
        let files = self.files.iter().map(|(name, (digest, is_executable))| api::FileNode {
            name: name.clone(),
            digest: Some(digest.to_api()),
            is_executable: *is_executable,
            node_properties: None,
        });
        let files = files.collect();
        let mut directories = Vec::with_capacity(self.folders.len());
        for (name, folder) in &self.folders {
            let digest = folder.blobs(blobs);
            directories.push(api::DirectoryNode { name: name.clone(), digest: Some(digest.to_api()) });
        }
        let blob = Blob::of_message(&api::Directory { files, directories, ..api::Directory::default() });
        let digest = blob.digest;
        blobs.push(blob);
        digest
    }
}
