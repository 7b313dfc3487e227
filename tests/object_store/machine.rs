//! A machine: a folder with assets, which are the same on every machine, and bakes in that folder.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use serde_json::Value;
use tempfile::{TempDir, tempdir};
use walkdir::WalkDir;

/// Credentials of all machines, which must never be printed.
const KEY: (&str, &str) = ("hunter-key", "hunter-secret");

/// The assets of each machine.
pub const ASSETS: [&str; 3] = ["brushed", "knobs", "waves"];

pub struct Machine {
    folder: TempDir,
    /// URL of the S3 server.
    endpoint: String,
}

/// The result of a bake.
pub struct Bake {
    /// Status of each asset, in the order of [`ASSETS`].
    pub statuses: Vec<String>,
    /// Standard error.
    pub err: String,
}

impl Machine {
    /// Makes a machine that uses the S3 server at `endpoint`.
    pub fn new(endpoint: &str) -> Self {
        let folder = tempdir().expect("a folder");
        for asset in ASSETS {
            let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(asset);
            for file in
                WalkDir::new(&from).into_iter().map(|e| e.expect("a fixture")).filter(|e| e.file_type().is_file())
            {
                let to = folder.path().join("assets").join(asset).join(file.path().strip_prefix(&from).expect("below"));
                fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
                fs::copy(file.path(), to).expect("a file");
            }
        }
        Self { folder, endpoint: endpoint.to_owned() }
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Returns the command `bake` with `options`.
    pub fn command(&self, options: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_roughcast"));
        command.current_dir(self.path()).args(["bake", "assets", "-o", "out"]).args(options.split_whitespace());
        command.env("AWS_ENDPOINT", &self.endpoint).env("AWS_ALLOW_HTTP", "true").env("AWS_REGION", "us-east-1");
        command.env("AWS_ACCESS_KEY_ID", KEY.0).env("AWS_SECRET_ACCESS_KEY", KEY.1).env("NO_PROXY", "127.0.0.1");
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Bakes into a new folder `out`. The bake must succeed and print no credentials.
    pub fn bake(&self, options: &str) -> Bake {
        let _ = fs::remove_dir_all(self.path().join("out"));
        Bake::from_output(self.command(&format!("{options} --json")).output().expect("the command starts"))
    }

    /// Bakes like [`Self::bake`], without any warning, and returns the statuses.
    pub fn statuses(&self, options: &str) -> Vec<String> {
        let bake = self.bake(options);
        assert_eq!(bake.err, "", "{options}");
        bake.statuses
    }

    /// Returns the BLAKE3 hash of every output.
    pub fn outputs(&self) -> BTreeMap<String, String> {
        hashes(&self.path().join("out"))
    }
}

impl Bake {
    /// Reads the result of a bake with `--json`.
    pub fn from_output(output: std::process::Output) -> Self {
        let err = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(0), "{err}");
        let out = String::from_utf8(output.stdout).expect("UTF-8");
        for secret in [KEY.0, KEY.1] {
            assert!(!err.contains(secret) && !out.contains(secret), "{err}{out}");
        }
        let report: Value = serde_json::from_str(&out).expect("JSON");
        let assets = report["assets"].as_array().expect("assets").iter();
        Self { statuses: assets.map(|asset| asset["status"].as_str().expect("a status").to_owned()).collect(), err }
    }

    /// Returns the lines of standard error.
    pub fn warnings(&self) -> Vec<&str> {
        self.err.lines().collect()
    }
}

/// Returns the BLAKE3 hash of every file below `folder`, by path.
fn hashes(folder: &Path) -> BTreeMap<String, String> {
    let files = WalkDir::new(folder).into_iter().map(|e| e.expect("a folder")).filter(|e| e.file_type().is_file());
    let hash = |path: &Path| blake3::hash(&fs::read(path).expect("a file")).to_hex().to_string();
    let name = |path: &Path| path.strip_prefix(folder).expect("below").to_string_lossy().into_owned();
    files.map(|file| (name(file.path()), hash(file.path()))).collect()
}

/// Returns the hashes of a bake without a cache.
pub fn without_cache() -> BTreeMap<String, String> {
    static OUTPUTS: OnceLock<BTreeMap<String, String>> = OnceLock::new();
    let bake = || {
        let machine = Machine::new("");
        assert_eq!(machine.statuses(""), ["baked"; 3]);
        machine.outputs()
    };
    OUTPUTS.get_or_init(bake).clone()
}
