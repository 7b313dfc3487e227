//! Tests of hostile answers: they produce no outputs, and nothing is written outside of the output folder.

use std::collections::BTreeMap;

use bazel_remote_apis::build::bazel::remote::execution::v2 as re;
use prost::Message;
use serde_json::{Value, json};

use super::fake::{Fake, State, digest};
use super::scene::{Run, Scene, hashes};

/// Bakes on a server whose results `change` alters. All assets must fail, and no file may be written.
fn assert_refused(change: fn(&State, re::ActionResult) -> re::ActionResult) -> Run {
    let (scene, server) = (Scene::new(), Fake::start());
    server.faults().result = Some(change);
    let before = hashes(scene.folder());
    let run = scene.bake(&server.url(), "--remote-retries 0");
    assert_eq!(run.err.matches("error: assets/").count(), 4, "{}", run.err);
    assert_eq!(scene.hashes(), BTreeMap::new(), "{}", run.err);
    assert_eq!(hashes(scene.folder()), before);
    run
}

/// Changes each entry of the cache in `result`.
fn change_entries(state: &State, result: re::ActionResult, change: fn(&mut Value)) -> re::ActionResult {
    change_files(state, result, |state, folder, file| {
        if folder != "jobs" {
            return;
        }
        let bytes = state.get(&file.digest.clone().expect("a digest").hash).expect("an entry");
        let mut entry: Value = serde_json::from_slice(&bytes[64..]).expect("JSON");
        change(&mut entry);
        let json = entry.to_string();
        let bytes = [blake3::hash(json.as_bytes()).to_hex().as_bytes(), json.as_bytes()].concat();
        file.digest = Some(state.put(bytes));
    })
}

/// Changes each file of the cache in `result`. `change` gets the name of the file's folder.
fn change_files(
    state: &State,
    mut result: re::ActionResult,
    mut change: impl FnMut(&State, &str, &mut re::FileNode),
) -> re::ActionResult {
    for output in &mut result.output_directories {
        let bytes = state.get(&output.tree_digest.clone().expect("a digest").hash).expect("a tree");
        let tree = re::Tree::decode(bytes.as_slice()).expect("a tree");
        let known: Vec<(re::Digest, re::Directory)> =
            tree.children.into_iter().map(|child| (digest(&child.encode_to_vec()), child)).collect();
        let find = |wanted: &Option<re::Digest>| {
            let found = known.iter().find(|(digest, _)| Some(digest) == wanted.as_ref());
            found.expect("a folder").1.clone()
        };
        let mut root = tree.root.expect("a root");
        let mut children = Vec::new();
        for kind in &mut root.directories {
            let mut folder = find(&kind.digest);
            for below in &mut folder.directories {
                let mut files = find(&below.digest);
                files.files.iter_mut().for_each(|file| change(state, &kind.name, file));
                below.digest = Some(digest(&files.encode_to_vec()));
                children.push(files);
            }
            kind.digest = Some(digest(&folder.encode_to_vec()));
            children.push(folder);
        }
        let tree = re::Tree { root: Some(root), children };
        output.tree_digest = Some(state.put(tree.encode_to_vec()));
    }
    result
}

#[test]
fn an_action_without_outputs_fails_despite_exit_code_0() {
    let run = assert_refused(|_, result| re::ActionResult { output_directories: Vec::new(), ..result });
    assert_eq!(run.code, 1);
    assert_eq!(
        run.err.matches("expected the outputs of the job from the server, found none").count(),
        4,
        "{}",
        run.err
    );
    // The entries exist, but the blobs that they name do not.
    let run = assert_refused(|state, result| {
        change_files(state, result, |_, folder, file| {
            if folder == "blobs" {
                file.name = "0".repeat(64);
            }
        })
    });
    assert_eq!(run.code, 1);
}

#[test]
fn refuses_entries_with_foreign_paths_and_digests() {
    let changes: [fn(&State, re::ActionResult) -> re::ActionResult; 7] = [
        |state, result| change_entries(state, result, |entry| entry["job"] = "0".repeat(64).into()),
        |state, result| change_entries(state, result, |entry| entry["document"]["blake3"] = "../../evil".into()),
        |state, result| change_entries(state, result, |entry| entry["document"]["path"] = "../../evil.gltf".into()),
        |state, result| change_entries(state, result, |entry| entry["document"]["path"] = "/tmp/evil.gltf".into()),
        |state, result| change_entries(state, result, |entry| entry["document"]["path"] = "other.gltf".into()),
        |state, result| {
            change_entries(state, result, |entry| entry["copies"] = json!(["../assets/brushed/brushed.bin"]))
        },
        |state, result| {
            change_entries(state, result, |entry| {
                let mut file = entry["document"].clone();
                file["path"] = "other.roughcast/evil.ktx2".into();
                entry["files"] = json!([file]);
            })
        },
    ];
    for change in changes {
        assert_eq!(assert_refused(change).code, 1);
    }
}

#[test]
fn refuses_blobs_that_do_not_match_their_digest() {
    // SHA-256 does not match.
    let (scene, server) = (Scene::new(), Fake::start());
    server.faults().read = Some(|mut bytes| {
        bytes.push(0);
        bytes
    });
    let run = scene.bake(&server.url(), "--remote-retries 1");
    assert_eq!((run.code, scene.hashes()), (4, BTreeMap::new()), "{}", run.err);
    // BLAKE3 does not match: the tree is valid, but names other bytes of the same length.
    let run = assert_refused(|state, result| {
        change_files(state, result, |state, folder, file| {
            if folder == "blobs" {
                let mut bytes = state.get(&file.digest.clone().expect("a digest").hash).expect("a blob");
                bytes[0] ^= 1;
                file.digest = Some(state.put(bytes));
            }
        })
    });
    assert_eq!(run.code, 4, "{}", run.err);
}

#[test]
fn refuses_huge_sizes_without_allocating() {
    let run = assert_refused(|state, result| {
        change_files(state, result, |_, _, file| {
            if let Some(digest) = &mut file.digest {
                digest.size_bytes = i64::MAX;
            }
        })
    });
    assert_eq!(run.code, 1, "{}", run.err);
    let run = assert_refused(|_, mut result| {
        for output in &mut result.output_directories {
            output.tree_digest = Some(re::Digest { hash: "0".repeat(64), size_bytes: i64::MAX });
        }
        result
    });
    assert_eq!(run.code, 1, "{}", run.err);
}

#[test]
fn reports_a_tool_that_does_not_run() {
    let run = assert_refused(|_, result| re::ActionResult {
        exit_code: 127,
        stderr_raw: b"no such\x1b[2J library\n".to_vec(),
        ..result
    });
    assert_eq!(run.code, 1);
    assert!(run.err.contains("exit code 127: no such[2J library; --remote-tool takes a static build"), "{}", run.err);
    let run = assert_refused(|_, result| re::ActionResult { exit_code: 1, stdout_raw: b"{".to_vec(), ..result });
    assert_eq!(run.code, 1);
}
