//! Tests with the real server buildbox-casd, whose workers run actions in a sandbox: with one node, with two nodes of
//! which one is killed, and with a wrong configuration.

use std::collections::BTreeMap;
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
use super::skip::missing_tool;

/// A node, which is killed when this value is dropped.
struct Node {
    process: Child,
    port: u16,
    options: Vec<String>,
    folder: TempDir,
}

impl Node {
    /// Starts a node with `options` of casd. Returns `None` if casd or bubblewrap is not installed.
    fn start(options: &[&str]) -> Option<Self> {
        if !tools().join("buildbox-casd").exists() || Command::new("bwrap").arg("--version").output().is_err() {
            missing_tool("tests of --remote need tools/buildbox/install and bubblewrap");
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

    /// Waits until the node answers. A node that depends on another one exits if that node does not answer within 9
    /// seconds.
    fn wait(&mut self) {
        while TcpStream::connect(("127.0.0.1", self.port)).is_err() {
            let exit = self.process.try_wait().expect("a process");
            assert!(exit.is_none(), "casd ended with {exit:?}: {}", self.log());
            sleep(Duration::from_millis(20));
        }
    }

    /// Returns the log of the node.
    fn log(&self) -> String {
        fs::read_to_string(self.folder.path().join("log")).unwrap_or_default()
    }

    /// Kills the node with all its child processes, and starts it again in the same folder.
    fn restart(&mut self) {
        self.kill();
        self.process = spawn(&self.folder, self.port, &self.options);
        self.wait();
    }

    fn kill(&mut self) {
        // The whole process group is killed: otherwise runners would stay behind.
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
    // The tool of a test is not a static build, so it needs the libraries of this machine.
    for argument in ["--staging-mode=copy-or-link", "--bind-mount=/lib:/lib", "--bind-mount=/lib64:/lib64"] {
        command.arg(format!("--runner-arg={argument}"));
    }
    command.args(options);
    // One test passes a relative folder of its own.
    if options.iter().all(|option| option.starts_with('-')) {
        command.arg(folder.path().join("casd"));
    }
    command.process_group(0).stdin(Stdio::null()).stdout(log.try_clone().expect("a file")).stderr(log);
    command.spawn().expect("casd starts")
}

/// Makes a scene whose tool is the command itself.
fn scene() -> Scene {
    let scene = Scene::without_tool();
    let tool = scene.path("tool");
    // Debug information is four fifths of the file.
    let stripped = Command::new("strip").arg("-o").arg(&tool).arg(ROUGHCAST).status();
    if !stripped.is_ok_and(|status| status.success()) {
        fs::copy(ROUGHCAST, tool).expect("a file");
    }
    scene
}

#[test]
fn bakes_on_one_node_and_reuses_its_results() {
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
fn jobs_fail_if_the_server_cannot_store_outputs() {
    // The server's folder is relative, which the server reports only after the action. For outputs that are files the
    // server returned exit code 0.
    let Some(node) = Node::start(&["casd"]) else { return };
    let scene = scene();
    let run = scene.bake(&node.url(), "--remote-retries 1");
    assert_eq!((run.code, run.err.matches("error: assets/").count()), (4, 4), "{}", run.err);
    assert_eq!(scene.hashes(), BTreeMap::new());
}

/// Makes a scene with more actions than run at the same time. Returns the scene and the hashes of a local bake.
fn scene_of_many_assets() -> (Scene, BTreeMap<String, String>) {
    let scene = scene();
    for number in 0..5 {
        let folder = scene.path(&format!("assets/{number}"));
        fs::create_dir(&folder).expect("a folder");
        for file in fs::read_dir(scene.path("assets/brushed")).expect("a folder").map(|file| file.expect("a file")) {
            fs::copy(file.path(), folder.join(file.file_name())).expect("a file");
        }
        // A different buffer makes a different job.
        let mut buffer = File::options().append(true).open(folder.join("brushed.bin")).expect("a buffer");
        buffer.write_all(&[number]).expect("a file");
    }
    let mut local = Command::new(ROUGHCAST);
    local.current_dir(scene.folder()).args(["bake", "assets", "-o", "local", "-q", "--model", "isotropic"]);
    assert!(local.status().expect("a run").success());
    let local = hashes(&scene.path("local"));
    (scene, local)
}

/// Starts a run with the cache folder `cache`.
fn start(scene: &Scene, url: &str, options: &str) -> Child {
    let mut command = scene.command(url, &format!("--cache cache --model isotropic {options}"));
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts")
}

/// Waits until the folder `cache` has the results of a job.
fn wait_for_first_result(scene: &Scene, client: &mut Child) {
    let start = Instant::now();
    while hashes(&scene.path("cache/jobs")).is_empty() {
        if client.try_wait().expect("a process").is_some() {
            let err = client.stderr.take().map(io::read_to_string);
            panic!("the run ended without results: {err:?}");
        }
        assert!(start.elapsed() < Duration::from_secs(300), "no job ends");
        sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_run_survives_a_restart_of_the_server() {
    let Some(mut node) = Node::start(&["--jobs=1"]) else { return };
    let (scene, expected) = scene_of_many_assets();
    let mut client = start(&scene, &node.url(), "");
    wait_for_first_result(&scene, &mut client);
    node.restart();
    let run = Run::from(client.wait_with_output().expect("an exit"));
    // The client waits half a minute for a server.
    assert_eq!((run.code, run.err.as_str()), (0, ""), "{}", node.log());
    assert!(run.count("retries") > 0, "{}", run.out);
    assert_eq!(scene.hashes(), expected);
}

#[test]
fn a_run_finishes_after_one_of_two_nodes_was_killed() {
    let Some(mut worker) = Node::start(&["--jobs=1", "--log-level=info"]) else { return };
    let url = format!("http://127.0.0.1:{}", worker.port);
    let remotes = ["cas", "ac", "exec"].map(|service| format!("--{service}-remote={url}"));
    let [cas, ac, exec] = remotes.each_ref().map(String::as_str);
    // By default, each call of the front node to a killed node would take 9 seconds.
    let options = [cas, ac, exec, "--exec-hybrid-queue-limit=1", "--jobs=1", "--retry-limit=1", "--retry-delay=100"];
    let Some(front) = Node::start(&options) else { return };
    let (scene, expected) = scene_of_many_assets();
    let mut client = start(&scene, &front.url(), "--remote-retries 3");
    wait_for_first_result(&scene, &mut client);
    assert!(worker.log().contains("Execute request"), "the front node executed all actions itself");
    worker.kill();
    let run = Run::from(client.wait_with_output().expect("an exit"));
    assert!([0, 4].contains(&run.code), "{}", run.err);
    worker.restart();
    let run = scene.bake(&front.url(), "--cache cache --model isotropic");
    assert_eq!((run.code, run.err.as_str()), (0, ""), "{}", front.log());
    assert_eq!(scene.hashes(), expected);
}
