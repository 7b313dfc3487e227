//! Tests of the hooks for pre-commit.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::tempdir;

use super::shell::{in_repository, path_with, run, tool_folder};
use super::skip::missing_tool;

/// Makes a Git repository of what a folder holds.
fn repository(folder: &Path) {
    for arguments in ["init --quiet", "add --all", "-c user.name=a -c user.email=a@b commit --quiet -m files"] {
        let (code, text) = run(Command::new("git").args(arguments.split(' ')).current_dir(folder));
        assert_eq!(code, 0, "{text}");
    }
}

/// Runs the hook that uses the tool on the PATH on all files of a repository.
fn try_hook(pre_commit: &PathBuf, hooks: &Path, files: &Path) -> (i32, String) {
    let mut command = Command::new(pre_commit);
    command.arg("try-repo").arg(hooks).args(["roughcast-check-system", "--all-files", "--verbose"]);
    command.current_dir(files).env("PATH", path_with(&[&tool_folder()]));
    run(command.env("PRE_COMMIT_HOME", files.with_file_name("home")))
}

#[test]
fn the_hook_finds_what_check_finds() {
    let pre_commit = in_repository("tools/distribution/venv/bin/pre-commit");
    if !pre_commit.is_file() {
        missing_tool("tests of hooks need `bash tools/distribution/install`");
        return;
    }
    let folder = tempdir().expect("a folder");
    let [hooks, files] = ["hooks", "files"].map(|name| folder.path().join(name));
    fs::create_dir(&hooks).expect("a folder");
    fs::copy(in_repository(".pre-commit-hooks.yaml"), hooks.join(".pre-commit-hooks.yaml")).expect("a file");
    repository(&hooks);

    let asset = in_repository("fixtures/tiny");
    let tool = env!("CARGO_BIN_EXE_roughcast");
    let (code, text) = run(Command::new(tool).arg("bake").arg(asset).arg("-o").arg(&files));
    assert_eq!(code, 0, "{text}");
    repository(&files);
    let (code, text) = try_hook(&pre_commit, &hooks, &files);
    assert!(code == 0 && text.contains("check baked glTF assets") && text.contains("0 errors"), "{text}");

    let texture = files.join("tiny.roughcast/cloth_normal.normal.ktx2");
    let bytes = fs::read(&texture).expect("a texture");
    fs::write(&texture, &bytes[..bytes.len() / 2]).expect("a file");
    let (code, text) = try_hook(&pre_commit, &hooks, &files);
    assert!(code == 1 && text.contains("exit code: 3") && text.contains("cloth_normal.normal.ktx2"), "{text}");
}
