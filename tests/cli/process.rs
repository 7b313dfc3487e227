//! Running the command, and what it leaves in folders.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use walkdir::WalkDir;

/// How a run ended.
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

/// Runs it in `folder`. Help is wrapped at 100 columns.
pub fn roughcast_in(folder: &Path, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Run {
    roughcast_with(&[], folder, arguments)
}

/// Runs it in `folder` with more `variables` in its environment.
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

/// Runs it in `folder` with the words of `line` as arguments.
pub fn run(folder: &Path, line: &str) -> Run {
    roughcast_in(folder, line.split_whitespace())
}

/// What it prints there, when it works and complains of nothing.
pub fn done(folder: &Path, line: &str) -> String {
    let run = run(folder, line);
    assert_eq!((run.code, run.err.as_str()), (0, ""), "{line}");
    run.out
}

/// Bakes `input` to `output` and expects it to work.
pub fn bake(input: &Path, output: &Path, options: &[&str]) -> Run {
    let mut arguments = vec![OsStr::new("bake"), input.as_ref(), "-o".as_ref(), output.as_ref()];
    arguments.extend(options.iter().map(OsStr::new));
    let run = roughcast(arguments);
    assert_eq!((run.code, run.err.as_str()), (0, ""), "bake {} {options:?}", input.display());
    run
}

/// The repository's `fixtures/`.
pub fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

/// Tells a person what was not tested. Written past the test runner, which keeps what tests that pass print.
pub fn skipped(what: &str) {
    let _ = writeln!(io::stderr(), "skipped: {what}");
}

/// BLAKE3 of every file below `folder`, by its path with `/`.
pub fn hashes(folder: &Path) -> BTreeMap<String, String> {
    let hash = |path: &Path| blake3::hash(&fs::read(path).expect("a readable file")).to_hex().to_string();
    files(folder).into_iter().map(|(name, path)| (name, hash(&path))).collect()
}

/// Every file below `folder`: its path relative to it with `/`, and its path.
pub fn files(folder: &Path) -> Vec<(String, PathBuf)> {
    let entries = WalkDir::new(folder).sort_by_file_name().into_iter().map(|e| e.expect("a readable folder"));
    let paths = entries.filter(|e| e.file_type().is_file()).map(walkdir::DirEntry::into_path);
    let name = |path: &Path| {
        let below = path.strip_prefix(folder).expect("below the folder");
        below.to_str().expect("names in UTF-8").replace(std::path::MAIN_SEPARATOR, "/")
    };
    paths.map(|path| (name(&path), path)).collect()
}

/// Copies everything below `from` into `to`.
pub fn copy(from: &Path, to: &Path) {
    for (name, path) in files(from) {
        let target = to.join(name);
        fs::create_dir_all(target.parent().expect("a folder")).expect("a folder can be made");
        fs::copy(path, target).expect("a file can be copied");
    }
}
