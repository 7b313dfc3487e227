//! Tests `--rdo` from settings to files: textures become smaller and record the setting, and jobs and cache keys
//! change.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::{TempDir, tempdir};

use super::process::{copy, done, files, fixtures, hashes};

fn scene() -> TempDir {
    let folder = tempdir().expect("a folder");
    for asset in ["brushed", "heights"] {
        copy(&fixtures().join(asset), &folder.path().join("assets").join(asset));
    }
    folder
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

fn size(path: &Path) -> u64 {
    path.metadata().expect("a file").len()
}

/// Returns the ids of the jobs that bake `assets` with `options`.
fn ids(folder: &Path, options: &str) -> Vec<Value> {
    let plan = json(&done(folder, &format!("plan assets -o out --json {options}")));
    plan["jobs"].as_array().expect("jobs").iter().map(|job| job["id"].clone()).collect()
}

/// Returns the status of each asset.
fn statuses(folder: &Path, line: &str) -> Vec<Value> {
    let report = json(&done(folder, &format!("{line} --cache cache --json")));
    report["assets"].as_array().expect("assets").iter().map(|asset| asset["status"].clone()).collect()
}

#[test]
fn textures_are_smaller_and_record_the_setting() {
    let scene = scene();
    let folder = scene.path();
    let reports =
        ["bake assets -o plain --json", "bake assets -o small --json --rdo 0.5"].map(|line| json(&done(folder, line)));
    assert_eq!(reports.each_ref().map(|report| report["settings"].get("rdo")), [None, Some(&Value::from(0.5))]);
    for asset in 0..2 {
        let [plain, small] = reports.each_ref().map(|report| report["assets"][asset]["bytes"].as_u64().expect("bytes"));
        assert!(small < plain, "asset {asset}: {small} of {plain}");
    }
    let mut textures = 0;
    for (name, plain) in files(&folder.join("plain")) {
        let small = folder.join("small").join(&name);
        if !name.ends_with(".ktx2") {
            // The document records the digests of the textures, which differ.
            let read = |path: &Path| match name.ends_with(".gltf") {
                true => {
                    let mut document = json(&fs::read_to_string(path).expect("a document"));
                    document["asset"]["extras"]["roughcast"]["outputs"].take();
                    document.to_string().into_bytes()
                }
                false => fs::read(path).expect("a file"),
            };
            assert!(read(&plain) == read(&small), "{name} differs");
            continue;
        }
        textures += 1;
        assert!(size(&small) < size(&plain), "{name}: {} of {}", size(&small), size(&plain));
        let inspected = ["plain", "small"].map(|out| json(&done(folder, &format!("inspect {out}/{name} --json"))));
        let [plain, small] = inspected.each_ref().map(|inspected| &inspected["provenance"]["settings"]);
        assert_eq!((plain.get("rdo"), &small["rdo"]), (None, &Value::from(0.5)), "{name}");
    }
    assert_eq!((textures, files(&folder.join("small")).len()), (6, files(&folder.join("plain")).len()));
    done(folder, "check small --source assets");
}

#[test]
fn rdo_does_not_change_other_payloads() {
    let scene = scene();
    let folder = scene.path();
    for target in ["bc", "float"] {
        for (out, options) in [("plain", ""), ("small", "--rdo 6")] {
            done(
                folder,
                &format!("bake assets/heights -o {target}/{out} -q --no-provenance --target {target} {options}"),
            );
        }
        let out = folder.join(target);
        assert_eq!(hashes(&out.join("plain")), hashes(&out.join("small")), "{target}");
    }
}

#[test]
fn jobs_and_cache_keys_depend_on_rdo() {
    let scene = scene();
    let folder = scene.path();
    let [without, half, whole] = ["", "--rdo 0.5", "--rdo 1"].map(|options| ids(folder, options));
    for job in 0..2 {
        assert!(without[job] != half[job] && half[job] != whole[job] && whole[job] != without[job], "job {job}");
    }
    for (line, status) in
        [("bake assets -o out", "baked"), ("bake assets -o out --rdo 0.5", "baked"), ("bake assets -o out", "cached")]
    {
        assert_eq!(statuses(folder, line), [status; 2], "{line}");
    }
    // Outputs from the cache equal those of a bake.
    assert_eq!(statuses(folder, "bake assets -o out --rdo 0.5"), ["cached"; 2]);
    done(folder, "bake assets -o alone -q --rdo 0.5");
    assert_eq!(hashes(&folder.join("out")), hashes(&folder.join("alone")));
}

#[test]
fn rdo_of_the_file_equals_that_of_the_flag() {
    let scene = scene();
    let folder = scene.path();
    let config = folder.join("assets/roughcast.toml");
    let (without, with) = (ids(folder, ""), ids(folder, "--rdo 0.5"));
    done(folder, "bake assets -o by-flag -q --rdo 0.5");
    fs::write(&config, "rdo = 0.5\n").expect("a file");
    assert_eq!(ids(folder, ""), with);
    done(folder, "bake assets -o by-file -q");
    assert_eq!(hashes(&folder.join("by-file")), hashes(&folder.join("by-flag")));
    fs::write(&config, "[[override]]\nfiles = 'heights/**'\nrdo = 0.5\n").expect("a file");
    assert_eq!(ids(folder, ""), [without[0].clone(), with[1].clone()]);
}
