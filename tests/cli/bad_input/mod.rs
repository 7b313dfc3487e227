//! Tests that bad input gives one clear error and exit code 1, and that every other asset is still baked.

mod documents;
mod foreign;
mod images;
mod outputs;
mod paths;

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::{TempDir, tempdir};

use super::process::{Run, bad_and_good_asset, copy, fixtures, hashes, roughcast};

/// A bad asset (`in/bad`, the brushed sphere, for tests to damage) and a good one (`in/good`, the lake). Both are baked
/// to `out`.
struct Scene {
    folder: TempDir,
}

impl Scene {
    fn new() -> Self {
        Self { folder: bad_and_good_asset() }
    }

    /// Returns the path of a file of the bad asset.
    fn bad(&self, name: &str) -> PathBuf {
        self.folder.path().join("in/bad").join(name)
    }

    fn input(&self) -> PathBuf {
        self.folder.path().join("in")
    }

    fn output(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    /// Replaces `old` by `new` in the bad document.
    fn edit(&self, old: &str, new: &str) -> &Self {
        let path = self.bad("brushed.gltf");
        let text = fs::read_to_string(&path).expect("a document");
        assert!(text.contains(old), "{old:?} is not in the document");
        fs::write(path, text.replacen(old, new, 1)).expect("a writable file");
        self
    }

    /// Bakes both assets. Expects one error about the bad asset, outputs of the good one and no other files. Returns
    /// the error.
    fn error_line(&self, options: &[&str]) -> String {
        let before = hashes(&self.input());
        let run = self.bake(options);
        assert_eq!(hashes(&self.input()), before, "a source changed");
        assert!(self.output().join("good/waves.glb").is_file(), "the good asset is not baked: {}", run.err);
        let line = one_line(&run);
        assert!(!self.output().join("bad").exists(), "half an asset was left behind");
        line
    }

    fn bake(&self, options: &[&str]) -> Run {
        let (input, output) = (self.input(), self.output());
        let mut arguments = vec!["bake".as_ref(), input.as_os_str(), "-o".as_ref(), output.as_os_str()];
        arguments.extend(options.iter().map(AsRef::<std::ffi::OsStr>::as_ref));
        let run = roughcast(arguments);
        assert_no_leftovers(self.folder.path());
        run
    }
}

/// Returns the only line that a permanently failed run wrote to standard error.
fn one_line(run: &Run) -> String {
    let line = run.err.trim_end_matches('\n').to_owned();
    assert!(line.starts_with("error: ") && !line.contains('\n'), "expected one line, found:\n{}", run.err);
    assert_eq!(run.code, 1, "{line}");
    println!("{line}");
    line
}

/// Asserts that `line` contains all `parts` in this order.
fn assert_contains(line: &str, parts: &[&str]) {
    let mut rest = line;
    for part in parts {
        let at = rest.find(part).unwrap_or_else(|| panic!("expected {part:?} in its place in: {line}"));
        rest = &rest[at + part.len()..];
    }
}

/// Asserts that there is no temporary file below `folder`.
fn assert_no_leftovers(folder: &Path) {
    let leftovers: Vec<_> = hashes(folder).into_keys().filter(|name| name.contains(".roughcast-")).collect();
    assert!(leftovers.is_empty(), "{leftovers:?}");
}

/// Truncates a file to the first half of its bytes.
fn cut_in_half(path: &Path) {
    let bytes = fs::read(path).expect("a readable file");
    fs::write(path, &bytes[..bytes.len() / 2]).expect("a writable file");
}
