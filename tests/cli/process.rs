//! Runs the command and reads the files that it leaves.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use walkdir::WalkDir;

/// Result of a run.
pub struct Run {
    /// Exit code; -1 after a signal.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("the command writes UTF-8");
        Self { code: output.status.code().unwrap_or(-1), out: text(output.stdout), err: text(output.stderr) }
    }
}

/// Runs `roughcast` with `arguments`.
pub fn roughcast(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Run {
    roughcast_in(Path::new("."), arguments)
}

/// Runs `roughcast` in `folder`. Help is wrapped at 100 columns.
pub fn roughcast_in(folder: &Path, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Run {
    roughcast_with(&[], folder, arguments)
}

/// Runs `roughcast` in `folder` with additional environment `variables`.
pub fn roughcast_with(
    variables: &[(&str, &str)],
    folder: &Path,
    arguments: impl IntoIterator<Item = impl AsRef<OsStr>>,
) -> Run {
    let mut command = Command::new(env!("CARGO_BIN_EXE_roughcast"));
    command.current_dir(folder).args(arguments).env("COLUMNS", "100").env_remove("CLICOLOR_FORCE");
    command.envs(variables.iter().copied());
    command.output().expect("the command starts").into()
}

/// Runs `roughcast` in `folder` with the words of `line` as arguments.
pub fn run(folder: &Path, line: &str) -> Run {
    roughcast_in(folder, line.split_whitespace())
}

/// Runs `line` in `folder`, expects success without warnings, and returns standard output.
pub fn done(folder: &Path, line: &str) -> String {
    let run = run(folder, line);
    assert_eq!((run.code, run.err.as_str()), (0, ""), "{line}");
    run.out
}

/// Bakes `input` to `output` and expects success without warnings.
pub fn bake(input: &Path, output: &Path, options: &[&str]) -> Run {
    let mut arguments = vec![OsStr::new("bake"), input.as_ref(), "-o".as_ref(), output.as_ref()];
    arguments.extend(options.iter().map(OsStr::new));
    let run = roughcast(arguments);
    assert_eq!((run.code, run.err.as_str()), (0, ""), "bake {} {options:?}", input.display());
    run
}

/// Returns the folder `fixtures/` of the repository.
pub fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

/// Returns the BLAKE3 digest of every file below `folder` by its path with `/`.
pub fn hashes(folder: &Path) -> BTreeMap<String, String> {
    let hash = |path: &Path| blake3::hash(&fs::read(path).expect("a readable file")).to_hex().to_string();
    files(folder).into_iter().map(|(name, path)| (name, hash(&path))).collect()
}

/// Returns the relative path with `/` and the path of every file below `folder`.
pub fn files(folder: &Path) -> Vec<(String, PathBuf)> {
    let entries = WalkDir::new(folder).sort_by_file_name().into_iter().map(|e| e.expect("a readable folder"));
    let paths = entries.filter(|e| e.file_type().is_file()).map(walkdir::DirEntry::into_path);
    let name = |path: &Path| {
        let below = path.strip_prefix(folder).expect("below the folder");
        below.to_str().expect("names in UTF-8").replace(std::path::MAIN_SEPARATOR, "/")
    };
    paths.map(|path| (name(&path), path)).collect()
}

/// Makes a folder with copies of the brushed sphere (`in/bad`), for tests to damage, and of the lake (`in/good`).
pub fn bad_and_good_asset() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    copy(&fixtures().join("brushed"), &folder.path().join("in/bad"));
    copy(&fixtures().join("waves"), &folder.path().join("in/good"));
    folder
}

/// Copies everything below `from` into `to`.
pub fn copy(from: &Path, to: &Path) {
    for (name, path) in files(from) {
        let target = to.join(name);
        fs::create_dir_all(target.parent().expect("a folder")).expect("a folder can be made");
        fs::copy(path, target).expect("a file can be copied");
    }
}
