//! Tests that names that are not UTF-8 do not break JSON and do not affect other assets.
#![cfg(unix)]

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::process::{copy, fixtures, run};
use crate::watch::session::Session;

/// Writes the folder `assets` with an asset for each kind of name.
fn scene() -> TempDir {
    let folder = tempdir().expect("a folder");
    let assets = folder.path().join("assets");
    copy(&fixtures().join("waves"), &assets.join(OsStr::from_bytes(b"\xff")));
    copy(&fixtures().join("waves"), &assets.join("plain"));
    folder
}

#[test]
fn a_plan_leaves_out_names_that_are_not_utf_8() {
    let scene = scene();
    for line in ["plan assets -o out --json", "plan assets -o out"] {
        let ended = run(scene.path(), line);
        assert_eq!((ended.code, ended.err.lines().count()), (1, 1), "{}", ended.err);
        let part = "expected a path in UTF-8 for the plan, found ";
        assert!(
            ended.err.starts_with("error: assets/\u{fffd}/waves.glb: ") && ended.err.contains(part),
            "{}",
            ended.err
        );
    }
    let plan: Value = serde_json::from_str(&run(scene.path(), "plan assets -o out --json").out).expect("JSON");
    assert_eq!(plan["jobs"].as_array().expect("jobs").len(), 1);
    assert_eq!(plan["jobs"][0]["source"], json!("assets/plain/waves.glb"));
}

#[test]
fn watching_continues_and_every_event_is_json() {
    let scene = scene();
    let folder = scene.path();
    let mut session = Session::start(folder, "--model none");
    let events = session.until("idle");
    let baked: Vec<&str> =
        events.iter().filter(|event| event["event"] == "baked").filter_map(|event| event["input"].as_str()).collect();
    assert_eq!(baked, ["assets/plain/waves.glb", "assets/\u{fffd}/waves.glb"], "{events:?}");
    assert!(folder.join("out").join(OsStr::from_bytes(b"\xff")).join("waves.glb").is_file());
    fs::remove_dir_all(folder.join("assets").join(OsStr::from_bytes(b"\xff"))).expect("a folder");
    assert_eq!(session.settle(folder), ["removed assets/\u{fffd}/waves.glb"]);
    assert_eq!(session.stop().code, 0);
}

#[test]
fn reports_and_checks_are_json_for_any_folder_name() {
    let scene = scene();
    for line in [
        "bake assets -o out --json --model none --cache cache",
        "check out --format json",
        "check out --format sarif",
        "check out --source assets --model none --format json",
    ] {
        let ended = run(scene.path(), line);
        assert!(matches!(ended.code, 0 | 3), "{line}: {} {}", ended.code, ended.err);
        assert!(serde_json::from_str::<Value>(&ended.out).is_ok(), "{line}: {}", ended.out);
    }
}
