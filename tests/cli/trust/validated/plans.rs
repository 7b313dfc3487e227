//! Edited plans: no job writes to a folder that the user did not name, and no job is retried without end.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::process::{copy, done, files, fixtures, hashes, run};

/// A change, and what the error says about it.
type Change<'c> = (&'c dyn Fn(&mut Value), &'c str);

/// Writes a working folder `here` with two assets and their plan `p.json`, which writes to `out`.
fn scene() -> TempDir {
    let scene = tempdir().expect("a folder");
    let here = scene.path().join("here");
    for asset in ["brushed", "waves"] {
        copy(&fixtures().join(asset), &here.join("A").join(asset));
    }
    fs::write(here.join("p.json"), done(&here, "plan A -o out --json --model none")).expect("a file");
    scene
}

/// Applies `change` to each job of the plan.
fn edit(here: &Path, change: &dyn Fn(&mut Value)) {
    let mut plan: Value = serde_json::from_slice(&fs::read(here.join("p.json")).expect("a plan")).expect("JSON");
    plan["jobs"].as_array_mut().expect("jobs").iter_mut().for_each(change);
    fs::write(here.join("p.json"), plan.to_string()).expect("a file");
}

#[test]
fn output_folders_of_a_plan_lie_in_the_working_folder_and_apart_from_the_sources() {
    for (output, part) in [
        ("../escape", "expected output folders in the working folder, found ../escape; name the folder with -o"),
        ("out/../../escape", "found out/../../escape; name the folder with -o"),
        ("/tmp/roughcast-escape", "expected a path relative to the working folder, found \"/tmp/roughcast-escape\""),
        ("", "expected a path relative to the working folder"),
        ("A", "found that A is or holds the folder of A/"),
        ("A/waves", "found that A/waves is or holds the folder of A/waves/waves.glb"),
        ("new/../A", "found that new/../A is or holds the folder of A/"),
        (".", "found that . is or holds the folder of A/"),
    ] {
        let scene = scene();
        let here = scene.path().join("here");
        edit(&here, &|job| {
            if job["source"] == "A/brushed/brushed.gltf" {
                job["output"] = json!(output);
            }
        });
        let before = hashes(scene.path());
        let ended = run(&here, "bake --plan p.json -q");
        assert_eq!((ended.code, ended.err.lines().count()), (2, 1), "{output}: {}", ended.err);
        assert!(ended.err.starts_with("error: p.json: ") && ended.err.contains(part), "{output}: {}", ended.err);
        assert_eq!(hashes(scene.path()), before, "{output}: no job of the plan is run");
        assert!(!here.join("new").exists() && !here.join("out").exists());
    }
}

#[cfg(unix)]
#[test]
fn a_link_leads_out_of_the_working_folder_only_if_it_is_named() {
    let scene = scene();
    let here = scene.path().join("here");
    fs::create_dir(scene.path().join("disk")).expect("a folder");
    std::os::unix::fs::symlink("../disk", here.join("out")).expect("a link");
    let ended = run(&here, "bake --plan p.json -q");
    assert!(ended.code == 2 && ended.err.contains("name the folder with -o"), "{}", ended.err);
    assert!(files(&scene.path().join("disk")).is_empty());
    done(&here, "bake --plan p.json -q -o out");
    assert!(scene.path().join("disk/waves/waves.glb").is_file());
    // A link to the sources does not circumvent the check.
    std::os::unix::fs::symlink("A", here.join("link")).expect("a link");
    edit(&here, &|job| job["output"] = json!("link"));
    let ended = run(&here, "bake --plan p.json -q");
    assert!(ended.code == 2 && ended.err.contains("found that link is or holds the folder of A/"), "{}", ended.err);
}

#[test]
fn a_plan_for_another_folder_is_run_where_the_user_names_it() {
    let scene = scene();
    let here = scene.path().join("here");
    fs::write(here.join("p.json"), done(&here, "plan A -o ../baked --json --model none")).expect("a file");
    assert_eq!(run(&here, "bake --plan p.json -q").code, 2);
    assert_eq!(run(&here, "bake --plan p.json -q -o ../bake").code, 2);
    done(&here, "bake --plan p.json -q -o ../baked");
    done(&here, "bake A -o whole -q --model none");
    assert_eq!(hashes(&scene.path().join("baked")), hashes(&here.join("whole")));
}

#[test]
fn a_job_whose_plan_was_edited_fails_for_good_and_the_others_do_not() {
    let digest = blake3::hash(b"another").to_hex().to_string();
    let changes: [Change<'_>; 6] = [
        (&|job| job["outputs"] = json!([]), "expected the outputs that planning makes of the job, found others"),
        (
            &|job| job["outputs"][0]["path"] = json!("A/brushed/brushed.gltf"),
            "expected the outputs that planning makes",
        ),
        (&|job| job["inputs"][1]["blake3"] = json!(digest), "expected the inputs that planning makes of the job"),
        (&|job| job["inputs"][1]["path"] = json!("p.json"), "expected the inputs that planning makes of the job"),
        (&|job| job["settings"]["model"] = json!("isotropic"), "the plan is of another version, or was edited"),
        (&|job| job["id"] = json!(digest), "the plan is of another version, or was edited"),
    ];
    for (change, part) in changes {
        let scene = scene();
        let here = scene.path().join("here");
        edit(&here, &|job| {
            if job["source"] == "A/brushed/brushed.gltf" {
                change(job);
            }
        });
        let sources = hashes(&here.join("A"));
        let ended = run(&here, "bake --plan p.json -q");
        assert_eq!((ended.code, ended.err.lines().count()), (1, 1), "{part}: {}", ended.err);
        assert!(ended.err.starts_with("error: A/brushed/brushed.gltf: ") && ended.err.contains(part), "{}", ended.err);
        assert!(here.join("out/waves/waves.glb").is_file() && !here.join("out/brushed").exists());
        assert_eq!(hashes(&here.join("A")), sources);
    }
}

#[test]
fn plans_and_reports_with_invalid_members_are_rejected() {
    for (member, value) in [
        ("/id", "../../victim"),
        ("/id", "ABCDEF"),
        ("/inputs/0/blake3", ""),
        ("/inputs/0/path", "/etc/hostname"),
        ("/source", "/etc/hostname"),
        ("/outputs/0/path", "/tmp/roughcast-escape"),
        ("/settings/quality", "better"),
    ] {
        let scene = scene();
        let here = scene.path().join("here");
        edit(&here, &|job| *job.pointer_mut(member).expect("a member") = json!(value));
        for line in ["bake --plan p.json -q", "plan merge p.json"] {
            let ended = run(&here, line);
            assert!(ended.code == 2 && ended.err.contains("expected a plan as"), "{member}: {}", ended.err);
        }
    }
    let scene = scene();
    let here = scene.path().join("here");
    let report =
        json!({ "formatVersion": 1, "assets": [{ "job": "0".repeat(63), "input": "A/brushed/brushed.gltf" }] });
    fs::write(here.join("r.json"), report.to_string()).expect("a file");
    let ended = run(&here, "plan merge p.json r.json");
    assert!(
        ended.code == 2 && ended.err.contains("expected a digest of 64 lower-case hexadecimal digits"),
        "{}",
        ended.err
    );
}
