//! The outputs that were written, and the removal of those that no asset has any more.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::digest::Digest;
use crate::input_file::holds;
use crate::run::{Written, normal_path};

/// Which asset has which outputs.
#[derive(Debug, Default)]
pub struct Ledger {
    assets: BTreeMap<PathBuf, Vec<PathBuf>>,
    outputs: BTreeMap<PathBuf, Output>,
    /// Outputs without owners, and the last owner of each.
    orphans: BTreeMap<PathBuf, PathBuf>,
}

#[derive(Debug)]
struct Output {
    blake3: Digest,
    owners: usize,
    /// The output folder, which stays when it is empty.
    base: PathBuf,
}

/// A file that was removed.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    /// The path.
    pub path: PathBuf,
    /// The asset that had the file.
    pub asset: PathBuf,
}

impl Ledger {
    /// Records that `asset` has the outputs `written` below `base`, and no others.
    pub fn set(&mut self, asset: &Path, base: &Path, written: &[Written]) {
        let mut paths: Vec<PathBuf> = written.iter().map(|file| normal_path(&file.path)).collect();
        for (path, file) in paths.iter().zip(written) {
            let output = self.outputs.entry(path.clone()).or_insert_with(|| Output {
                blake3: file.blake3,
                owners: 0,
                base: base.to_owned(),
            });
            output.blake3 = file.blake3;
            output.owners += 1;
            self.orphans.remove(path);
        }
        if paths.is_empty() {
            paths = self.assets.remove(asset).unwrap_or_default();
        } else if let Some(before) = self.assets.insert(asset.to_owned(), paths) {
            paths = before;
        } else {
            return;
        }
        for path in paths {
            let Some(output) = self.outputs.get_mut(&path) else { continue };
            output.owners -= 1;
            if output.owners == 0 {
                self.orphans.insert(path, asset.to_owned());
            }
        }
    }

    /// Removes outputs that no asset has, if their bytes are those that were written, and folders that are empty then.
    /// Returns the removed files.
    pub fn sweep(&mut self) -> Vec<Removed> {
        let mut removed = Vec::new();
        for (path, asset) in std::mem::take(&mut self.orphans) {
            let Some(Output { blake3, base, .. }) = self.outputs.remove(&path) else { continue };
            if !holds(&path, blake3) || fs::remove_file(&path).is_err() {
                continue;
            }
            let base = normal_path(&base);
            let folders = path.ancestors().skip(1).take_while(|folder| folder.starts_with(&base) && *folder != base);
            // A folder that holds anything else stays, and so do the folders above.
            let _ = folders.map(fs::remove_dir).take_while(Result::is_ok).count();
            removed.push(Removed { path, asset });
        }
        removed
    }
}

#[cfg(test)]
mod tests;
