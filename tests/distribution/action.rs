//! Tests of the GitHub Action: its scripts, run as a runner does, with a stand-in for GitHub's command line.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::{TempDir, tempdir};

use super::archive::pack;
use super::shell::{in_repository, run, script, tool_folder};

/// A runner that has no roughcast. Its `gh` "downloads" what is in the folder `release`.
struct Runner(TempDir);

impl Runner {
    fn new() -> Self {
        let runner = Self(tempdir().expect("a folder"));
        for folder in ["bin", "release", "temp"] {
            fs::create_dir(runner.path(folder)).expect("a folder");
        }
        let copies = format!("#!/bin/sh\ncp {}/* \"$7\"\n", runner.path("release").display());
        runner.program("gh", &copies);
        // Hides a tool that is installed on this machine.
        runner.program("roughcast", "#!/bin/sh\nexit 127\n");
        runner
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.0.path().join(name)
    }

    fn program(&self, name: &str, text: &str) {
        fs::write(self.path("bin").join(name), text).expect("a file");
        run(Command::new("chmod").arg("+x").arg(self.path("bin").join(name)));
    }

    /// Puts an archive of the tool and its digest into the release.
    fn release(&self) {
        let archive = pack(&self.path("release"));
        let (code, digest) =
            run(Command::new("sha256sum").arg(archive.file_name().expect("a name")).current_dir(self.path("release")));
        assert_eq!(code, 0, "{digest}");
        fs::write(self.path("release/SHA256SUMS"), digest).expect("a file");
    }

    /// Runs the step that installs the tool.
    fn install(&self, folders: &[&Path]) -> (i32, String) {
        let mut command = script(".github/action/install", folders);
        command.env("GITHUB_ACTION_PATH", in_repository("")).env("REPOSITORY", "OWNER/REPOSITORY");
        command.env("RUNNER_TEMP", self.path("temp")).env("RUNNER_OS", "Linux").env("RUNNER_ARCH", "X64");
        run(command.env("GITHUB_PATH", self.path("paths")).env("GITHUB_OUTPUT", self.path("outputs")))
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_default()
    }
}

#[test]
fn the_archive_of_the_release_is_verified_and_put_on_the_path() {
    let runner = Runner::new();
    runner.release();
    let (code, text) = runner.install(&[&runner.path("bin")]);
    assert_eq!(code, 0, "{text}");
    let (code, version) =
        run(Command::new(Path::new(runner.read("paths").trim_end()).join("roughcast")).arg("--version"));
    assert_eq!((code, version.as_str()), (0, concat!("roughcast ", env!("CARGO_PKG_VERSION"), "\n")));
    assert_eq!(runner.read("outputs"), concat!("version=", env!("CARGO_PKG_VERSION"), "\n"));
}

#[test]
fn an_archive_with_another_digest_is_refused() {
    let runner = Runner::new();
    runner.release();
    let sums = runner.read("release/SHA256SUMS");
    let other = if sums.starts_with('0') { "1" } else { "0" };
    fs::write(runner.path("release/SHA256SUMS"), format!("{other}{}", &sums[1..])).expect("a file");
    let (code, text) = runner.install(&[&runner.path("bin")]);
    assert_eq!(code, 1, "{text}");
    assert!(text.contains("expected the digest in SHA256SUMS"), "{text}");
    assert_eq!(runner.read("paths"), "");
}

#[test]
fn a_tool_of_the_same_version_is_used() {
    let runner = Runner::new();
    let (code, text) = runner.install(&[&tool_folder()]);
    assert_eq!((code, text.as_str()), (0, concat!("roughcast ", env!("CARGO_PKG_VERSION"), " is on the PATH\n")));
    assert_eq!(runner.read("paths"), "");
}

/// Without a release, the tool is built. The `cargo` of this test says what it was asked for.
#[test]
fn the_tool_is_built_if_there_is_no_release() {
    let runner = Runner::new();
    runner.program("gh", "#!/bin/sh\necho 'release not found' >&2\nexit 1\n");
    runner.program("cargo", "#!/bin/sh\necho cargo \"$@\"\n");
    let (code, text) = runner.install(&[&runner.path("bin")]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("\ncargo install --locked --path "), "{text}");
    assert!(runner.read("paths").ends_with("/bin\n"));
}

#[test]
fn command_lines_run_one_after_the_other() {
    let folder = tempdir().expect("a folder");
    let commands = "# a comment\n\n  check 'two words' \"$HOME\"\nbake *.gltf -o out\n";
    let echo = "#!/bin/sh\nprintf '<%s>' \"$@\"\necho\n[ \"$1\" != bake ] || exit 3\n";
    let tool = folder.path().join("roughcast");
    fs::write(&tool, echo).expect("a file");
    run(Command::new("chmod").arg("+x").arg(&tool));
    let (code, text) =
        run(script(".github/action/run", &[folder.path()]).env("COMMANDS", commands.to_owned() + "map x"));
    assert_eq!(code, 3);
    let expected = "roughcast   check 'two words' \"$HOME\"\n<check><two words><$HOME>\n\
        roughcast bake *.gltf -o out\n<bake><*.gltf><-o><out>\n";
    assert_eq!(text, expected);
}

#[test]
fn the_action_bakes_and_checks() {
    let folder = tempdir().expect("a folder");
    let asset = in_repository("fixtures/tiny");
    let commands = format!("bake '{}' -o baked -q\ncheck baked/tiny.gltf", asset.display());
    let mut command = script(".github/action/run", &[&tool_folder()]);
    let (code, text) = run(command.env("COMMANDS", commands).current_dir(folder.path()));
    assert!(code == 0 && text.contains("0 errors"), "{text}");
}
