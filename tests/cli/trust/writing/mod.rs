//! Tests that no run overwrites its inputs, writes outside of its output folders, or leaves half-written files.

mod folders;
mod long_names;
mod named;
mod packs;
mod whole;

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::{TempDir, tempdir};
use walkdir::WalkDir;

use crate::process::{Run, copy, done, fixtures, hashes, run};

/// Writes a folder with the brushed sphere in `A`.
fn scene() -> TempDir {
    let folder = tempdir().expect("a folder");
    copy(&fixtures().join("brushed"), &folder.path().join("A"));
    folder
}

/// Replaces `old` by `new` in the document of the scene.
fn edit(folder: &Path, old: &str, new: &str) {
    let path = folder.join("A/brushed.gltf");
    let text = fs::read_to_string(&path).expect("a document");
    assert!(text.contains(old), "{old:?} is not in the document");
    fs::write(path, text.replace(old, new)).expect("a writable file");
}

/// Runs `line`. Expects exit code `code`, all `parts` in the error, and no change of any file in `A`.
fn refused(folder: &Path, line: &str, code: i32, parts: &[&str]) -> Run {
    let before = hashes(&folder.join("A"));
    let run = run(folder, line);
    assert_eq!(hashes(&folder.join("A")), before, "{line}: a source changed");
    assert_eq!(run.code, code, "{line}: {}", run.err);
    assert!(parts.iter().all(|part| run.err.contains(part)), "{line}: {}", run.err);
    run
}

/// Every writer goes through module `output`, which decides whether a path may be written.
#[test]
fn only_module_output_writes_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources = ["src", "crates/core/src", "crates/pipeline/src"].map(|folder| root.join(folder));
    let calls = [
        "fs::write(",
        "File::create",
        "create_new",
        ".write(true)",
        ".append(true)",
        "create_dir",
        ".persist(",
        "fs::copy(",
    ];
    let mut writers: Vec<PathBuf> = Vec::new();
    for entry in sources.iter().flat_map(WalkDir::new).map(|entry| entry.expect("a source")) {
        let path = entry.path();
        let is_test = path.file_stem().is_some_and(|stem| stem.to_string_lossy().ends_with("tests"));
        let is_writer = path.components().any(|part| part.as_os_str() == "output");
        let is_source = path.extension().is_some_and(|extension| extension == "rs");
        if !is_source || is_test || is_writer || path.components().any(|p| p.as_os_str() == "tests") {
            continue;
        }
        let text = fs::read_to_string(path).expect("a source");
        let code: String = text
            .lines()
            .take_while(|line| *line != "#[cfg(test)]")
            .filter(|line| !line.trim_start().starts_with("//"))
            .collect();
        if calls.iter().any(|call| code.contains(call)) {
            writers.push(path.strip_prefix(root).expect("below").to_owned());
        }
    }
    assert!(writers.is_empty(), "{writers:?}");
}
