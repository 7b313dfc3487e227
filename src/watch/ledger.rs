//! Outputs that we wrote, and removing those that no asset has any more.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::digest::Digest;
use crate::input_file::holds;
use crate::run::{Written, roughened};

/// Who has which outputs.
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
    /// Where it was.
    pub path: PathBuf,
    /// The asset that had it.
    pub asset: PathBuf,
}

impl Ledger {
    /// `asset` has the outputs `written` below `base`, and no others.
    pub fn set(&mut self, asset: &Path, base: &Path, written: &[Written]) {
        let mut paths: Vec<PathBuf> = written.iter().map(|file| roughened(&file.path)).collect();
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

    /// Removes outputs that no asset has, if they are as we wrote them, and folders that are empty without them.
    pub fn sweep(&mut self) -> Vec<Removed> {
        let mut removed = Vec::new();
        for (path, asset) in std::mem::take(&mut self.orphans) {
            let Some(Output { blake3, base, .. }) = self.outputs.remove(&path) else { continue };
            if !holds(&path, blake3) || fs::remove_file(&path).is_err() {
                continue;
            }
            let base = roughened(&base);
            let folders = path.ancestors().skip(1).take_while(|folder| folder.starts_with(&base) && *folder != base);
            // The first that holds anything else stays, and so do those above it.
            let _ = folders.map(fs::remove_dir).take_while(Result::is_ok).count();
            removed.push(Removed { path, asset });
        }
        removed
    }
}

#[cfg(test)]
mod tests {
    use tempfile::{TempDir, tempdir};

    use super::*;

    fn written(folder: &TempDir, name: &str) -> Written {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(&path, name).expect("a file");
        Written { source: path.clone(), path, blake3: crate::digest::digest(name.as_bytes()) }
    }

    fn names(folder: &TempDir, removed: &[Removed]) -> Vec<String> {
        let name = |removed: &Removed| removed.path.strip_prefix(folder.path()).expect("below").display().to_string();
        removed.iter().map(name).collect()
    }

    #[test]
    fn outputs_go_with_their_last_owner() {
        let folder = tempdir().expect("a folder");
        let (a, b) = (Path::new("a.gltf"), Path::new("b.gltf"));
        let [own, shared, other] = ["a/a.bin", "t/s.png", "b.bin"].map(|name| written(&folder, name));
        // The same file by another way.
        let again = Written { path: folder.path().join("a/../t/s.png"), ..shared.clone() };
        let mut ledger = Ledger::default();
        ledger.set(a, folder.path(), &[own.clone(), again]);
        ledger.set(b, folder.path(), &[shared.clone(), other.clone()]);
        ledger.set(a, folder.path(), &[]);
        assert_eq!(names(&folder, &ledger.sweep()), ["a/a.bin"]);
        assert!(!folder.path().join("a").exists() && shared.path.exists());
        ledger.set(b, folder.path(), &[other]);
        assert_eq!(names(&folder, &ledger.sweep()), ["t/s.png"]);
        ledger.set(b, folder.path(), &[]);
        assert_eq!(names(&folder, &ledger.sweep()), ["b.bin"]);
        assert!(folder.path().exists(), "the output folder itself");
    }

    #[test]
    fn what_someone_else_wrote_stays() {
        let folder = tempdir().expect("a folder");
        let [edited, kept] = ["x/edited.png", "x/kept.png"].map(|name| written(&folder, name));
        let mut ledger = Ledger::default();
        ledger.set(Path::new("a.gltf"), folder.path(), &[edited.clone(), kept.clone()]);
        fs::write(&edited.path, "by hand").expect("a file");
        fs::write(folder.path().join("x/foreign.txt"), "").expect("a file");
        ledger.set(Path::new("a.gltf"), folder.path(), &[]);
        assert_eq!(names(&folder, &ledger.sweep()), ["x/kept.png"]);
        assert!(edited.path.exists() && folder.path().join("x/foreign.txt").exists());
    }

    #[test]
    fn an_output_that_moves_to_another_asset_stays() {
        let folder = tempdir().expect("a folder");
        let file = written(&folder, "s.png");
        let mut ledger = Ledger::default();
        ledger.set(Path::new("a.gltf"), folder.path(), std::slice::from_ref(&file));
        ledger.set(Path::new("a.gltf"), folder.path(), &[]);
        ledger.set(Path::new("b.gltf"), folder.path(), std::slice::from_ref(&file));
        assert_eq!(ledger.sweep(), []);
        assert!(file.path.exists());
    }
}
