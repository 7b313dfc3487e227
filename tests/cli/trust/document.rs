//! What documents contain after a bake, which documents are refused, and how much work large ones take.

mod hostile;
mod leftovers;
mod refused;

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use super::super::process::{bake, copy, files, fixtures, roughcast};

/// A copy of the brushed sphere, for tests to change.
struct Sphere {
    folder: TempDir,
}

impl Sphere {
    fn new() -> Self {
        let folder = tempdir().expect("a folder");
        copy(&fixtures().join("brushed"), &folder.path().join("in"));
        Self { folder }
    }

    /// Returns the path of a file of the asset.
    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join("in").join(name)
    }

    fn output(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn edit(&self, edit: impl FnOnce(&mut Value)) {
        let path = self.file("brushed.gltf");
        let mut root = document(&path);
        edit(&mut root);
        fs::write(path, root.to_string()).expect("a writable file");
    }

    /// Bakes the asset, expects a failure, and returns the error.
    fn error_line(&self, options: &[&str]) -> String {
        error_line(&self.file("brushed.gltf"), &self.output(), options)
    }

    /// Bakes the asset and returns its document.
    fn baked(&self, options: &[&str]) -> Value {
        bake(&self.file("brushed.gltf"), &self.output(), options);
        document(&self.output().join("brushed.gltf"))
    }
}

/// Bakes `input`, expects a failure, and returns the only line of the error.
fn error_line(input: &Path, output: &Path, options: &[&str]) -> String {
    let paths = ["bake".as_ref(), input.as_os_str(), "-o".as_ref(), output.as_os_str()];
    let run = roughcast(paths.into_iter().chain(options.iter().map(AsRef::as_ref)));
    let line = run.err.trim_end_matches('\n').to_owned();
    assert_eq!(run.code, 1, "{line}");
    assert!(line.starts_with("error: ") && !line.contains('\n'), "expected one line, found:\n{line}");
    assert!(!output.exists(), "something was written");
    line
}

fn document(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("a document")).expect("JSON")
}

/// Reads the JSON and the BIN chunk of a GLB.
fn glb(path: &Path) -> (Value, Vec<u8>) {
    let bytes = fs::read(path).expect("a GLB");
    let length = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
    let json = length(12);
    let root = serde_json::from_slice(&bytes[20..20 + json]).expect("JSON");
    (root, bytes.get(28 + json..).unwrap_or_default().to_vec())
}

/// Returns a GLB of `root` and `bin`.
fn to_glb(root: &Value, bin: &[u8]) -> Vec<u8> {
    let mut json = root.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let chunk = |kind: &[u8], data: &[u8]| [&(data.len() as u32).to_le_bytes(), kind, data].concat();
    let body = [chunk(b"JSON", &json), chunk(b"BIN\0", &bin)].concat();
    [&b"glTF"[..], &2u32.to_le_bytes(), &(12 + body.len() as u32).to_le_bytes(), &body].concat()
}
