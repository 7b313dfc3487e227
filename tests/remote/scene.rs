//! Assets in a folder, and runs of the command there.

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

/// How a run ended.
pub struct Run {
    /// Exit code; -1 after a signal.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Run {
    /// The report of `--json`.
    pub fn report(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {}{}", self.out, self.err))
    }

    /// A number of what the server did.
    pub fn count(&self, name: &str) -> u64 {
        self.report()["remote"][name].as_u64().unwrap_or_else(|| panic!("no {name} in {}", self.out))
    }

    /// How each asset ended.
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
    /// The assets alone.
    pub fn bare() -> Self {
        let scene = Self(tempfile::tempdir().expect("a folder"));
        assets(scene.folder());
        scene
    }

    /// The same with a tool for workers without a sandbox.
    pub fn new() -> Self {
        let scene = Self::bare();
        scene.tool("");
        scene
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        self.0.path()
    }

    /// A file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Makes the tool for workers without a sandbox one that does `first`, then is the command: with all assets in its
    /// cache, since few tests are about baking.
    pub fn tool(&self, first: &str) {
        let known = expected().1.display();
        self.script(&format!("{first}\nmkdir cache && cp -r '{known}'/* cache"));
    }

    /// Makes it one that does `first`, then is the command.
    pub fn script(&self, first: &str) {
        let path = self.path("tool");
        fs::write(&path, format!("#!/bin/sh\nPATH=/bin:/usr/bin\n{first}\nexec '{ROUGHCAST}' \"$@\"\n"))
            .expect("a file");
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).expect("a file");
    }

    /// The command that bakes the assets to `out` on the server at `url`.
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

    /// Bakes them and expects that all is well.
    pub fn baked(&self, url: &str, options: &str) -> Run {
        let run = self.bake(url, options);
        assert_eq!((run.code, run.err.as_str()), (0, ""), "{options}: {}", run.out);
        assert_eq!(self.hashes(), expected().0, "{options}");
        run
    }

    /// What is in `out`.
    pub fn hashes(&self) -> BTreeMap<String, String> {
        hashes(&self.path("out"))
    }

    /// Removes what was baked.
    pub fn clear(&self) {
        fs::remove_dir_all(self.path("out")).expect("a folder");
    }
}

/// Three fixtures below `folder`, and a document without materials. `brushed` and `knobs` have actions of their own, since a
/// buffer is long.
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

/// What a local bake of the assets writes, and the cache that it fills: both of this build, in a folder that is kept.
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

/// BLAKE3 of every file below `folder`, by its path.
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
