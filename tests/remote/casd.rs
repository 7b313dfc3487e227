//! A real server: buildbox-casd, whose workers run actions in a sandbox. One node, two of which one dies, and its traps.

use std::collections::BTreeMap;
use std::env;
use std::fs::{self, File};
use std::io::{self, Write};
use std::net::TcpStream;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::ports::free_port;
use super::scene::{ROUGHCAST, Run, Scene, hashes};

/// A node, killed when this is dropped.
struct Node {
    process: Child,
    port: u16,
    options: Vec<String>,
    folder: TempDir,
}

impl Node {
    /// Starts one with `options` of casd; `None` where there is none to start.
    fn start(options: &[&str]) -> Option<Self> {
        if !tools().join("buildbox-casd").exists() || Command::new("bwrap").arg("--version").output().is_err() {
            let missing = "tests of --remote need tools/buildbox/install and bubblewrap";
            assert!(env::var("CI").as_deref() != Ok("true"), "{missing}");
            let _ = writeln!(io::stderr(), "skipped: {missing}");
            return None;
        }
        let folder = tempfile::tempdir().expect("a folder");
        let options: Vec<String> = options.iter().map(|&option| option.to_owned()).collect();
        let port = free_port();
        let process = spawn(&folder, port, &options);
        let mut node = Self { process, port, options, folder };
        node.wait();
        Some(node)
    }

    fn url(&self) -> String {
        format!("grpc://127.0.0.1:{}", self.port)
    }

    /// Waits until it answers: a node with another behind it ends if that one does not answer within 9 seconds.
    fn wait(&mut self) {
        while TcpStream::connect(("127.0.0.1", self.port)).is_err() {
            let exit = self.process.try_wait().expect("a process");
            assert!(exit.is_none(), "casd ended with {exit:?}: {}", self.log());
            sleep(Duration::from_millis(20));
        }
    }

    /// What it says.
    fn log(&self) -> String {
        fs::read_to_string(self.folder.path().join("log")).unwrap_or_default()
    }

    /// Kills it with all that it runs, and starts it again on what is left of its folder.
    fn restart(&mut self) {
        self.kill();
        self.process = spawn(&self.folder, self.port, &self.options);
        self.wait();
    }

    fn kill(&mut self) {
        // Its group: it alone would leave runners behind.
        let group = format!("-{}", self.process.id());
        let _ = Command::new("kill").args(["-KILL", "--", &group]).status();
        let _ = self.process.wait();
    }
}

impl Drop for Node {
    fn drop(&mut self) {
        self.kill();
    }
}

fn tools() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/buildbox/bin")
}

fn spawn(folder: &TempDir, port: u16, options: &[String]) -> Child {
    let log = File::options().create(true).append(true).open(folder.path().join("log")).expect("a file");
    let mut command = Command::new(tools().join("buildbox-casd"));
    command.arg(format!("--bind=127.0.0.1:{port}")).arg("--quota-high=5G").current_dir(folder.path());
    command.arg(format!("--buildbox-run={}", tools().join("buildbox-run").display()));
    // The tool of a test is no static build: it takes the libraries of this machine.
    for argument in ["--staging-mode=copy-or-link", "--bind-mount=/lib:/lib", "--bind-mount=/lib64:/lib64"] {
        command.arg(format!("--runner-arg={argument}"));
    }
    command.args(options);
    // A relative folder is the trap of a test of its own.
    if options.iter().all(|option| option.starts_with('-')) {
        command.arg(folder.path().join("casd"));
    }
    command.process_group(0).stdin(Stdio::null()).stdout(log.try_clone().expect("a file")).stderr(log);
    command.spawn().expect("casd starts")
}

/// A scene whose tool is the command itself.
fn scene() -> Scene {
    let scene = Scene::bare();
    let tool = scene.path("tool");
    // Without what only debuggers read, four fifths of it.
    let stripped = Command::new("strip").arg("-o").arg(&tool).arg(ROUGHCAST).status();
    if !stripped.is_ok_and(|status| status.success()) {
        fs::copy(ROUGHCAST, tool).expect("a file");
    }
    scene
}

#[test]
fn one_node() {
    let Some(node) = Node::start(&["--jobs=2"]) else { return };
    let scene = scene();
    let first = scene.baked(&node.url(), "");
    assert_eq!(first.statuses(), ["baked", "copied", "baked", "baked"]);
    assert_eq!(first.count("executed"), first.count("actions"));
    scene.clear();
    let second = scene.baked(&node.url(), "");
    assert_eq!(["executed", "uploadedBlobs"].map(|name| second.count(name)), [0, 0], "{}", node.log());
    assert_eq!(second.statuses(), ["cached"; 4]);
}

#[test]
fn a_server_that_cannot_keep_outputs_fails_the_jobs() {
    // Its folder is relative, which it finds out after the action. (It answered exit code 0 to outputs that are files.)
    let Some(node) = Node::start(&["casd"]) else { return };
    let scene = scene();
    let run = scene.bake(&node.url(), "--remote-retries 1");
    assert_eq!((run.code, run.err.matches("error: assets/").count()), (4, 4), "{}", run.err);
    assert_eq!(scene.hashes(), BTreeMap::new());
}

/// A scene with more actions than are run at a time, and what a local bake of it writes.
fn many() -> (Scene, BTreeMap<String, String>) {
    let scene = scene();
    for number in 0..5 {
        let folder = scene.path(&format!("assets/{number}"));
        fs::create_dir(&folder).expect("a folder");
        for file in fs::read_dir(scene.path("assets/brushed")).expect("a folder").map(|file| file.expect("a file")) {
            fs::copy(file.path(), folder.join(file.file_name())).expect("a file");
        }
        // Another asset, another job.
        let mut buffer = File::options().append(true).open(folder.join("brushed.bin")).expect("a buffer");
        buffer.write_all(&[number]).expect("a file");
    }
    let mut local = Command::new(ROUGHCAST);
    local.current_dir(scene.folder()).args(["bake", "assets", "-o", "local", "-q", "--model", "isotropic"]);
    assert!(local.status().expect("a run").success());
    let local = hashes(&scene.path("local"));
    (scene, local)
}

/// A run whose cache is in `cache`.
fn start(scene: &Scene, url: &str, options: &str) -> Child {
    let mut command = scene.command(url, &format!("--cache cache --model isotropic {options}"));
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts")
}

/// Waits until that cache has the results of a job.
fn first_result(scene: &Scene, client: &mut Child) {
    let start = Instant::now();
    while hashes(&scene.path("cache/jobs")).is_empty() {
        if client.try_wait().expect("a process").is_some() {
            let said = client.stderr.take().map(io::read_to_string);
            panic!("the run ended without results: {said:?}");
        }
        assert!(start.elapsed() < Duration::from_secs(300), "no job ends");
        sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_server_that_is_killed_and_started_again() {
    let Some(mut node) = Node::start(&["--jobs=1"]) else { return };
    let (scene, expected) = many();
    let mut client = start(&scene, &node.url(), "");
    first_result(&scene, &mut client);
    node.restart();
    let run = Run::from(client.wait_with_output().expect("an exit"));
    // It waits half a minute for a server.
    assert_eq!((run.code, run.err.as_str()), (0, ""), "{}", node.log());
    assert!(run.count("retries") > 0, "{}", run.out);
    assert_eq!(scene.hashes(), expected);
}

#[test]
fn two_nodes_one_of_which_is_killed() {
    let Some(mut worker) = Node::start(&["--jobs=1", "--log-level=info"]) else { return };
    let url = format!("http://127.0.0.1:{}", worker.port);
    let remotes = ["cas", "ac", "exec"].map(|service| format!("--{service}-remote={url}"));
    let [cas, ac, exec] = remotes.each_ref().map(String::as_str);
    // Each of its calls to a node that is gone would take 9 seconds.
    let options = [cas, ac, exec, "--exec-hybrid-queue-limit=1", "--jobs=1", "--retry-limit=1", "--retry-delay=100"];
    let Some(front) = Node::start(&options) else { return };
    let (scene, expected) = many();
    let mut client = start(&scene, &front.url(), "--remote-retries 3");
    first_result(&scene, &mut client);
    assert!(worker.log().contains("Execute request"), "all is done by the other node");
    worker.kill();
    let run = Run::from(client.wait_with_output().expect("an exit"));
    assert!([0, 4].contains(&run.code), "{}", run.err);
    worker.restart();
    let run = scene.bake(&front.url(), "--cache cache --model isotropic");
    assert_eq!((run.code, run.err.as_str()), (0, ""), "{}", front.log());
    assert_eq!(scene.hashes(), expected);
}
