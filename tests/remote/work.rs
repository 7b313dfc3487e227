//! Tests with a correct server: outputs are those of a local bake, and nothing is uploaded or executed twice.

use std::fs;
use std::process::Command;

use bazel_remote_apis::build::bazel::remote::execution::v2 as re;
use prost::Message;

use super::fake::{Fake, digest};
use super::scene::{ROUGHCAST, Run, Scene, expected};

#[test]
fn outputs_equal_a_local_bake_and_are_baked_once() {
    let (scene, server) = (Scene::without_tool(), Fake::start());
    scene.script("");
    let first = scene.baked(&server.url(), "");
    assert_eq!(first.statuses(), ["baked", "copied", "baked", "baked"]);
    assert!(first.report()["assets"].as_array().expect("assets").iter().all(|asset| asset["remote"] == "executed"));
    assert_eq!(
        ["actions", "executed", "cached", "retries"].map(|name| first.count(name)),
        [first.count("actions"), first.count("actions"), 0, 0]
    );
    assert!(first.count("actions") >= 3 && first.count("uploadedBlobs") > 0 && first.count("downloadedBlobs") > 0);
    // Without a local cache, the results come from the server's cache.
    scene.clear();
    let second = scene.baked(&server.url(), "--cache cache");
    assert_eq!(second.statuses(), ["cached"; 4]);
    assert_eq!(["executed", "uploadedBlobs"].map(|name| second.count(name)), [0, 0]);
    assert_eq!(second.count("cached"), first.count("actions"));
    // With a full local cache, the server is not called and may be gone.
    let url = server.url();
    drop(server);
    scene.clear();
    let third = scene.baked(&url, "--cache cache --remote-retries 0");
    assert_eq!((third.count("actions"), third.statuses()), (0, vec!["cached".to_owned(); 4]));
}

#[test]
fn concurrent_actions_upload_a_blob_once() {
    let (scene, server) = (Scene::new(), Fake::start());
    scene.baked(&server.url(), "--remote-jobs 8");
    let tool = digest(&fs::read(scene.path("tool")).expect("a tool"));
    assert_eq!(server.calls(&tool.hash), 1);
    let repeated: Vec<_> = server.state.calls.lock().expect("calls").clone().into_iter().collect();
    assert!(repeated.iter().all(|(name, count)| name.len() != 64 || *count == 1), "{repeated:?}");
}

#[test]
fn equal_assets_in_other_folders_have_equal_actions() {
    let (scene, server) = (Scene::new(), Fake::start());
    scene.baked(&server.url(), "");
    fs::rename(scene.path("assets"), scene.path("elsewhere")).expect("a folder");
    fs::create_dir(scene.path("assets")).expect("a folder");
    fs::rename(scene.path("elsewhere"), scene.path("assets/deep")).expect("a folder");
    scene.clear();
    let run = scene.bake(&server.url(), "");
    assert_eq!((run.code, run.count("executed"), run.count("uploadedBlobs")), (0, 0, 0), "{}", run.err);
}

#[test]
fn compresses_blobs_if_the_server_supports_it() {
    let (scene, server) = (Scene::new(), Fake::start());
    server.faults().capabilities = Some(|capabilities| {
        let cache = capabilities.cache_capabilities.as_mut().expect("a cache");
        cache.supported_compressors = vec![re::compressor::Value::Zstd as i32];
    });
    scene.baked(&server.url(), "");
    assert!(server.calls("ByteStream.Write") > 0);
}

#[test]
fn actions_have_the_requested_platform_and_timeout() {
    let (scene, server) = (Scene::new(), Fake::start());
    scene.baked(&server.url(), "--remote-platform b=2 --remote-platform a=1=1 --remote-timeout 100");
    let blobs = server.state.blobs.lock().expect("blobs").clone();
    let actions: Vec<re::Action> = server
        .state
        .actions
        .lock()
        .expect("actions")
        .keys()
        .map(|hash| re::Action::decode(blobs[hash].as_slice()).expect("an action"))
        .collect();
    for action in &actions {
        let properties = action.platform.clone().expect("a platform").properties;
        let properties: Vec<_> = properties.iter().map(|p| (p.name.as_str(), p.value.as_str())).collect();
        assert_eq!(properties, [("a", "1=1"), ("b", "2")]);
        assert_eq!(action.timeout.as_ref().map(|limit| limit.seconds), Some(100));
    }
    assert!(!actions.is_empty());
}

#[test]
fn reads_the_server_from_the_configuration() {
    let (scene, server) = (Scene::new(), Fake::start());
    let text = format!("[remote]\nurl = '{}'\ntool = '../tool'\njobs = 2\nplatform = {{ a = 'b' }}\n", server.url());
    fs::write(scene.path("assets/roughcast.toml"), text).expect("a file");
    let bake = |options: &str| -> Run {
        let line = format!("bake assets -o out --json {options}");
        let mut command = Command::new(ROUGHCAST);
        command.current_dir(scene.folder()).args(line.split_whitespace()).output().expect("a run").into()
    };
    // A file beside the assets is of the user only if its name is given.
    assert_eq!(bake("").code, 2);
    let run = bake("--config assets/roughcast.toml");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    assert!(run.count("executed") > 0);
    assert_eq!(scene.hashes(), expected().0);
    let cache = expected().1.display();
    let run = bake(&format!("--no-remote --cache {cache}"));
    assert_eq!((run.code, run.report()["remote"].is_null()), (0, true), "{}", run.err);
}

#[test]
fn a_failed_job_has_the_local_message_and_fails_alone() {
    let (scene, server) = (Scene::new(), Fake::start());
    fs::write(scene.path("assets/waves/broken.gltf"), BROKEN).expect("a file");
    let remote = scene.bake(&server.url(), "");
    assert_eq!(remote.code, 1, "{}", remote.err);
    assert_eq!(scene.hashes(), expected().0);
    scene.clear();
    let mut local = Command::new(ROUGHCAST);
    local.current_dir(scene.folder()).args(["bake", "assets", "-o", "out", "-q"]);
    let local: Run = local.output().expect("a run").into();
    assert_eq!((local.code, local.err.lines().count()), (1, 1), "{}", local.err);
    assert_eq!(remote.err, local.err);
}

/// A document whose normal map is missing.
const BROKEN: &str = r#"{"asset":{"version":"2.0"},"images":[{"uri":"missing.png"}],"textures":[{"source":0}],
    "materials":[{"normalTexture":{"index":0}}]}"#;

#[test]
fn a_job_that_kills_the_tool_fails_alone() {
    let (scene, server) = (Scene::new(), Fake::start());
    fs::write(scene.path("assets/fatal.gltf"), r#"{"asset":{"version":"2.0","generator":"fatal"}}"#).expect("a file");
    scene.tool("if grep -q fatal.gltf plan.json; then echo out of luck >&2; kill -9 $$; fi");
    let run = scene.bake(&server.url(), "--remote-retries 1");
    assert_eq!(run.code, 4);
    assert!(
        run.err.starts_with("error: assets/fatal.gltf: expected the tool to run") && run.err.lines().count() == 1,
        "{}",
        run.err
    );
    assert!(run.err.contains("out of luck"), "{}", run.err);
    assert_eq!(scene.hashes(), expected().0);
}
