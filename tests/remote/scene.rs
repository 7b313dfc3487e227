//! Scenes: assets in a folder, and runs of the command in that folder.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use serde_json::Value;
use tempfile::TempDir;
use walkdir::WalkDir;

/// The command.
pub const ROUGHCAST: &str = env!("CARGO_BIN_EXE_roughcast");

/// A folder with `assets`, and a `tool` for workers.
pub struct Scene(TempDir);

/// The result of a run.
pub struct Run {
    /// Exit code; -1 after a signal.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Run {
    /// Returns the report of `--json`.
    pub fn report(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {}{}", self.out, self.err))
    }

    /// Returns a count of the report's `remote` section.
    pub fn count(&self, name: &str) -> u64 {
        self.report()["remote"][name].as_u64().unwrap_or_else(|| panic!("no {name} in {}", self.out))
    }

    /// Returns the status of each asset.
    pub fn statuses(&self) -> Vec<String> {
        let report = self.report();
        let assets = report["assets"].as_array().expect("assets").iter();
        assets.map(|asset| asset["status"].as_str().expect("a status").to_owned()).collect()
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("the command writes UTF-8");
        Self { code: output.status.code().unwrap_or(-1), out: text(output.stdout), err: text(output.stderr) }
    }
}

impl Scene {
    /// Makes a scene of the assets without a tool.
    pub fn without_tool() -> Self {
        let scene = Self(tempfile::tempdir().expect("a folder"));
        assets(scene.folder());
        scene
    }

    /// Makes a scene of the assets and a tool for workers without a sandbox.
    pub fn new() -> Self {
        let scene = Self::without_tool();
        scene.tool("");
        scene
    }

    /// Returns the folder of the scene.
    pub fn folder(&self) -> &Path {
        self.0.path()
    }

    /// Returns the path of a file in the scene.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a tool that runs `first` and then the command with a filled cache, since few tests are about baking. The
    /// tool is for workers without a sandbox.
    pub fn tool(&self, first: &str) {
        let cache = expected().1.display();
        self.script(&format!("{first}\nmkdir cache && cp -r '{cache}'/* cache"));
    }

    /// Writes a tool that runs `first` and then the command.
    pub fn script(&self, first: &str) {
        let path = self.path("tool");
        fs::write(&path, format!("#!/bin/sh\nPATH=/bin:/usr/bin\n{first}\nexec '{ROUGHCAST}' \"$@\"\n"))
            .expect("a file");
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).expect("a file");
    }

    /// Returns the command that bakes the assets to `out` on the server at `url`.
    pub fn command(&self, url: &str, options: &str) -> Command {
        let mut command = Command::new(ROUGHCAST);
        let line = format!("bake assets -o out --json --remote {url} --remote-tool tool {options}");
        command.current_dir(self.folder()).args(line.split_whitespace()).env_remove("ROUGHCAST_REMOTE_HEADER");
        command
    }

    /// Bakes the assets to `out` on the server at `url`.
    pub fn bake(&self, url: &str, options: &str) -> Run {
        self.command(url, options).output().expect("the command starts").into()
    }

    /// Bakes the assets and expects the outputs of a local bake.
    pub fn baked(&self, url: &str, options: &str) -> Run {
        let run = self.bake(url, options);
        assert_eq!((run.code, run.err.as_str()), (0, ""), "{options}: {}", run.out);
        assert_eq!(self.hashes(), expected().0, "{options}");
        run
    }

    /// Returns the hashes of all files in `out`.
    pub fn hashes(&self) -> BTreeMap<String, String> {
        hashes(&self.path("out"))
    }

    /// Removes the folder `out`.
    pub fn clear(&self) {
        fs::remove_dir_all(self.path("out")).expect("a folder");
    }
}

/// Writes three fixtures and a document without materials below `folder`. `brushed` and `knobs` get long buffers, so
/// that each becomes its own action.
fn assets(folder: &Path) {
    let assets = folder.join("assets");
    for asset in ["brushed", "knobs", "waves"] {
        copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(asset), &assets.join(asset));
    }
    for long in ["brushed/brushed.bin", "knobs/knobs.bin"] {
        let mut bytes = fs::read(assets.join(long)).expect("a buffer");
        bytes.resize(3 << 20, 0);
        fs::write(assets.join(long), bytes).expect("a file");
    }
    fs::write(assets.join("flat.gltf"), r#"{"asset":{"version":"2.0"}}"#).expect("a file");
}

/// Returns the hashes of a local bake of the assets, and the cache that it fills. The folder is kept between tests.
pub fn expected() -> &'static (BTreeMap<String, String>, PathBuf) {
    static EXPECTED: OnceLock<(BTreeMap<String, String>, PathBuf)> = OnceLock::new();
    EXPECTED.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("remote");
        let _ = fs::remove_dir_all(&folder);
        assets(&folder);
        let mut command = Command::new(ROUGHCAST);
        command.current_dir(&folder).args("bake assets -o out -q --cache cache".split(' '));
        let run: Run = command.output().expect("a run").into();
        assert_eq!((run.code, run.err.as_str()), (0, ""));
        (hashes(&folder.join("out")), folder.join("cache"))
    })
}

/// Returns the BLAKE3 hash of every file below `folder`, by path.
pub fn hashes(folder: &Path) -> BTreeMap<String, String> {
    let entries = WalkDir::new(folder).into_iter().filter_map(Result::ok).filter(|entry| entry.file_type().is_file());
    entries
        .map(|entry| {
            let name = entry.path().strip_prefix(folder).expect("below the folder").display().to_string();
            (name, blake3::hash(&fs::read(entry.path()).expect("a file")).to_hex().to_string())
        })
        .collect()
}

fn copy(from: &Path, to: &Path) {
    for entry in WalkDir::new(from).into_iter().map(|entry| entry.expect("a fixture")) {
        let target = to.join(entry.path().strip_prefix(from).expect("below the folder"));
        if entry.file_type().is_dir() {
            fs::create_dir_all(target).expect("a folder");
        } else {
            fs::copy(entry.path(), target).expect("a file");
        }
    }
}
