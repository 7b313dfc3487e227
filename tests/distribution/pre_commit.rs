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

/// Runs the hook of docs/install.md, with the tool on the PATH, on all files of a repository.
fn run_hook(pre_commit: &PathBuf, hooks: &Path, files: &Path) -> (i32, String) {
    let page = fs::read_to_string(in_repository("docs/install.md")).expect("a page");
    let (_, config) = page.split_once("```yaml\nrepos:\n").expect("a configuration");
    let (config, _) = config.split_once("```").expect("the end of the configuration");
    let (_, commit) = run(Command::new("git").args(["rev-parse", "HEAD"]).current_dir(hooks));
    let config = config.replace("https://github.com/OWNER/REPOSITORY", hooks.to_str().expect("a path in UTF-8"));
    let config = config.replace("v0.1.0", commit.trim()).replace("id: roughcast-check", "id: roughcast-check-system");
    fs::write(files.join(".pre-commit-config.yaml"), format!("repos:\n{config}")).expect("a file");
    let mut command = Command::new(pre_commit);
    command.args(["run", "--all-files", "--verbose"]).current_dir(files).env("PATH", path_with(&[&tool_folder()]));
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

    let asset = files.join("assets/cloth");
    fs::create_dir_all(&asset).expect("a folder");
    for entry in fs::read_dir(in_repository("fixtures/tiny")).expect("a folder") {
        let path = entry.expect("a file").path();
        fs::copy(&path, asset.join(path.file_name().expect("a name"))).expect("a file");
    }
    let tool = env!("CARGO_BIN_EXE_roughcast");
    let (code, text) = run(Command::new(tool).args(["bake", "assets", "-o", "baked"]).current_dir(&files));
    assert_eq!(code, 0, "{text}");
    repository(&files);
    let (code, text) = run_hook(&pre_commit, &hooks, &files);
    assert!(code == 0 && text.contains("check baked glTF assets") && text.contains("0 errors"), "{text}");

    let texture = files.join("baked/cloth/tiny.roughcast/cloth_normal.normal.ktx2");
    let bytes = fs::read(&texture).expect("a texture");
    fs::write(&texture, &bytes[..bytes.len() / 2]).expect("a file");
    let (code, text) = run_hook(&pre_commit, &hooks, &files);
    assert!(code == 1 && text.contains("exit code: 3") && text.contains("cloth_normal.normal.ktx2"), "{text}");
}
