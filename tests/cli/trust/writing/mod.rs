//! No run writes over what it reads, outside of where it may write, or half of a file.

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

/// A folder with the brushed sphere in `A`.
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

/// Runs `line` and expects that it ends with `code`, says all `parts`, and leaves all files of `A` as they are.
fn refused(folder: &Path, line: &str, code: i32, parts: &[&str]) -> Run {
    let before = hashes(&folder.join("A"));
    let run = run(folder, line);
    assert_eq!(hashes(&folder.join("A")), before, "{line}: a source changed");
    assert_eq!(run.code, code, "{line}: {}", run.err);
    assert!(parts.iter().all(|part| run.err.contains(part)), "{line}: {}", run.err);
    run
}

/// Every writer goes through `src/output`, which decides whether it may write.
#[test]
fn nothing_else_in_the_sources_writes_files() {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let ways = [
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
    for entry in WalkDir::new(&sources).into_iter().map(|entry| entry.expect("a source")) {
        let path = entry.path();
        let is_test = path.file_stem().is_some_and(|stem| stem.to_string_lossy().ends_with("tests"));
        let is_writer = path.components().any(|part| part.as_os_str() == "output");
        let is_source = path.extension().is_some_and(|extension| extension == "rs");
        if !is_source || is_test || is_writer || path.components().any(|p| p.as_os_str() == "tests") {
            continue;
        }
        let text = fs::read_to_string(path).expect("a source");
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        if ways.iter().any(|way| code.contains(way)) {
            writers.push(path.strip_prefix(&sources).expect("below").to_owned());
        }
    }
    assert!(writers.is_empty(), "{writers:?}");
}
