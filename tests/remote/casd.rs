//! A real server: buildbox-casd, whose workers run actions in a sandbox. One node, two of which one dies, and its traps.

use std::env;
use std::fs::{self, File};
use std::io::{self, Write};
use std::net::TcpListener;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::scene::{ROUGHCAST, Scene, expected};

/// A node, killed when this is dropped.
struct Node {
    process: Child,
    port: u16,
    folder: TempDir,
}

impl Node {
    /// Starts one; `None` where there is none to start.
    fn start(options: &[String]) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        // Whoever binds it in between makes the test fail, and not pass.
        let port = TcpListener::bind("127.0.0.1:0").and_then(|port| port.local_addr()).expect("a port").port();
        Self::start_in(folder, port, options)
    }

    fn start_in(folder: TempDir, port: u16, options: &[String]) -> Option<Self> {
        let tools = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/buildbox/bin");
        let bubblewrap = Command::new("bwrap").arg("--version").output();
        if !tools.join("buildbox-casd").exists() || bubblewrap.is_err() {
            let missing = "tests of --remote need tools/buildbox/install and bubblewrap";
            assert!(env::var("CI").as_deref() != Ok("true"), "{missing}");
            let _ = writeln!(io::stderr(), "skipped: {missing}");
            return None;
        }
        let log = File::create(folder.path().join("log")).expect("a file");
        let mut command = Command::new(tools.join("buildbox-casd"));
        command.arg(format!("--bind=127.0.0.1:{port}")).arg("--quota-high=5G");
        command.arg(format!("--buildbox-run={}", tools.join("buildbox-run").display()));
        // The tool of a test is no static build: it takes the libraries of this machine.
        for argument in ["--staging-mode=copy-or-link", "--bind-mount=/lib:/lib", "--bind-mount=/lib64:/lib64"] {
            command.arg(format!("--runner-arg={argument}"));
        }
        command.args(options).arg(folder.path().join("casd"));
        // Its runners die with it: they are of its group.
        command.process_group(0).stdin(Stdio::null()).stdout(log.try_clone().expect("a file")).stderr(log);
        let process = command.spawn().expect("casd starts");
        Some(Self { process, port, folder })
    }

    fn url(&self) -> String {
        format!("grpc://127.0.0.1:{}", self.port)
    }

    /// What it says of what it does.
    fn log(&self) -> String {
        fs::read_to_string(self.folder.path().join("log")).unwrap_or_default()
    }

    /// Kills it and what it runs; returns what is left of it.
    fn kill(mut self) -> (TempDir, u16) {
        self.end();
        (std::mem::replace(&mut self.folder, tempfile::tempdir().expect("a folder")), self.port)
    }

    fn end(&mut self) {
        // The group: its leader alone would leave runners behind.
        let group = format!("-{}", self.process.id());
        let _ = Command::new("kill").args(["-KILL", "--", &group]).status();
        let _ = self.process.wait();
    }
}

impl Drop for Node {
    fn drop(&mut self) {
        self.end();
    }
}

/// A scene whose tool is the command itself.
fn scene() -> Scene {
    let scene = Scene::new();
    let tool: PathBuf = scene.path("tool");
    fs::remove_file(&tool).expect("a file");
    // Without what only debuggers read, four fifths of it.
    let stripped = Command::new("strip").arg("-o").arg(&tool).arg(ROUGHCAST).status();
    if !stripped.is_ok_and(|status| status.success()) {
        fs::copy(ROUGHCAST, tool).expect("a file");
    }
    scene
}

#[test]
fn one_node() {
    let Some(node) = Node::start(&["--jobs=2".to_owned()]) else { return };
    let scene = scene();
    let first = scene.baked(&node.url(), "");
    assert_eq!(first.statuses(), ["baked", "copied", "baked", "baked"]);
    assert_eq!(first.count("executed"), first.count("actions"));
    scene.clear();
    let second = scene.baked(&node.url(), "");
    assert_eq!(["executed", "uploadedBlobs"].map(|name| second.count(name)), [0, 0], "{}", node.log());
    assert_eq!(second.statuses(), ["cached"; 4]);
}
