//! Tests of temporary faults: calls are repeated, and outputs are those of a local bake.

use std::fs;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::fake::Fake;
use super::scene::{Scene, expected};

#[test]
fn repeats_calls_that_fail_twice() {
    let (scene, server) = (Scene::new(), Fake::start());
    for call in [
        "GetCapabilities",
        "GetActionResult",
        "FindMissingBlobs",
        "BatchUpdateBlobs",
        "ByteStream.Write",
        "Execute",
        "BatchReadBlobs",
        "ByteStream.Read",
    ] {
        server.faults().unavailable.insert(call, 2);
    }
    let run = scene.baked(&server.url(), "--remote-jobs 1");
    assert!(run.count("retries") >= 10, "{}", run.out);
}

#[test]
fn waits_after_a_broken_stream_and_restarts_a_lost_execution() {
    let (scene, server) = (Scene::new(), Fake::start());
    server.faults().broken = 1;
    let run = scene.baked(&server.url(), "--remote-jobs 1");
    assert_eq!(server.calls("WaitExecution"), 1);
    assert_eq!(u64::from(server.calls("Execute")), run.count("actions"));
    let (scene, server) = (Scene::new(), Fake::start());
    server.faults().lost = 1;
    let run = scene.baked(&server.url(), "--remote-jobs 1");
    assert_eq!(server.calls("WaitExecution"), 1);
    assert_eq!(u64::from(server.calls("Execute")), run.count("actions") + 1);
}

#[test]
fn uploads_blobs_again_that_the_server_loses() {
    let (scene, server) = (Scene::new(), Fake::start());
    server.faults().evicted = 1;
    let run = scene.baked(&server.url(), "--remote-jobs 1");
    assert!(run.count("retries") >= 1);
}

#[test]
fn executes_again_if_blobs_of_a_result_are_missing() {
    let (scene, server) = (Scene::new(), Fake::start());
    let first = scene.baked(&server.url(), "");
    server.state.blobs.lock().expect("blobs").clear();
    scene.clear();
    let second = scene.baked(&server.url(), "");
    assert_eq!(second.count("executed"), first.count("actions"));
}

#[test]
fn executes_again_if_a_cached_result_has_no_outputs() {
    let (scene, server) = (Scene::new(), Fake::start());
    scene.baked(&server.url(), "");
    for result in server.state.actions.lock().expect("actions").values_mut() {
        result.output_directories.clear();
    }
    scene.clear();
    let again = scene.baked(&server.url(), "");
    assert_eq!(again.count("executed"), again.count("actions"));
}

#[test]
fn an_unreachable_server_ends_a_run_with_code_4() {
    let scene = Scene::new();
    let url = Fake::start().url();
    let run = scene.bake(&url, "--remote-retries 1");
    assert_eq!((run.code, run.err.lines().count()), (4, 1), "{}", run.err);
    assert!(
        run.err.starts_with(&format!("error: expected a server of the Remote Execution API at {url}")),
        "{}",
        run.err
    );
    assert!(!scene.path("out").exists());
}

#[test]
fn a_busy_server_ends_a_run_with_code_4() {
    let (scene, server) = (Scene::new(), Fake::start());
    server.faults().unavailable.insert("Execute", u32::MAX);
    let run = scene.bake(&server.url(), "--remote-jobs 1 --remote-retries 1");
    assert_eq!((run.code, run.err.lines().count()), (4, 4), "{}", run.err);
    assert!(run.err.contains("UNAVAILABLE: made to fail"), "{}", run.err);
    server.faults().unavailable.clear();
    scene.baked(&server.url(), "");
}

#[test]
fn a_killed_client_leaves_no_partial_outputs() {
    let (scene, server) = (Scene::new(), Fake::start());
    // One action waits until the test allows it to continue. The others finish before.
    let go = scene.path("go");
    scene.tool(&format!("if grep -q brushed plan.json; then until [ -e '{}' ]; do sleep 0.05; done; fi", go.display()));
    let mut command = scene.command(&server.url(), "--cache cache");
    let mut client = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the command starts");
    let start = Instant::now();
    while server.state.actions.lock().expect("actions").len() < 2 {
        assert!(start.elapsed() < Duration::from_secs(120), "the other actions do not end");
        sleep(Duration::from_millis(20));
    }
    client.kill().expect("a process");
    client.wait().expect("an exit");
    fs::write(go, "").expect("a file");
    scene.baked(&server.url(), "--cache cache");
    assert_eq!(scene.hashes(), expected().0);
}
