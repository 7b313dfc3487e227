//! Tests that plans, jobs and shards run exactly what was planned.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use super::process::{copy, done, fixtures, hashes, roughcast_in, run};

fn scene() -> TempDir {
    let folder = tempdir().expect("a folder");
    for asset in ["brushed", "heights", "knobs", "waves"] {
        copy(&fixtures().join(asset), &folder.path().join("assets").join(asset));
    }
    folder
}

/// Plans `assets` to `out` with `options`, and writes the plan to `plan.json`.
fn plan(folder: &Path, options: &str) -> Value {
    let text = done(folder, &format!("plan assets -o out --json {options}"));
    fs::write(folder.join("plan.json"), &text).expect("a file");
    serde_json::from_str(&text).expect("JSON")
}

fn ids(plan: &Value) -> Vec<String> {
    let jobs = plan["jobs"].as_array().expect("jobs").iter();
    jobs.map(|job| job["id"].as_str().expect("an id").to_owned()).collect()
}

#[test]
fn plans_satisfy_their_schema_and_have_correct_digests() {
    let scene = scene();
    let plan = plan(scene.path(), "--profile both");
    let schema: Value = serde_json::from_str(include_str!("../../schemas/plan.schema.json")).expect("JSON");
    let schema = jsonschema::validator_for(&schema).expect("a schema");
    let errors: Vec<String> = schema.iter_errors(&plan).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    for (pointer, value) in
        [("/jobs/0/id", json!("x")), ("/jobs/0/source", json!("/a.gltf")), ("/jobs/0/inputs", json!([]))]
    {
        let mut broken = plan.clone();
        *broken.pointer_mut(pointer).expect("a member") = value;
        assert!(!schema.is_valid(&broken), "{pointer}");
    }
    let mut seen = BTreeSet::new();
    for input in plan["jobs"].as_array().expect("jobs").iter().flat_map(|job| job["inputs"].as_array().expect("inputs"))
    {
        let path = input["path"].as_str().expect("a path");
        let bytes = fs::read(scene.path().join(path)).expect(path);
        assert_eq!(
            (&input["blake3"], &input["bytes"]),
            (&json!(blake3::hash(&bytes).to_hex().as_str()), &json!(bytes.len()))
        );
        seen.insert(path.to_owned());
    }
    let all: BTreeSet<String> = hashes(scene.path()).into_keys().filter(|name| name.starts_with("assets/")).collect();
    assert_eq!(seen, all);
    assert!(!scene.path().join("out").exists(), "a plan writes");
}

#[test]
fn ids_depend_on_contents_settings_and_names_only() {
    let scene = scene();
    let folder = scene.path();
    let before = ids(&plan(folder, ""));
    // New times, another folder, another output folder and other words for equal settings give equal jobs.
    let image = folder.join("assets/brushed/brushed_normal.png");
    fs::write(&image, fs::read(&image).expect("an image")).expect("a file");
    fs::rename(folder.join("assets"), folder.join("moved")).expect("a folder");
    let words = "--max-error 0.1 --target basis --model auto --gltf strict --own-anisotropy bake";
    let text = done(folder, &format!("plan moved -o elsewhere --json {words}"));
    assert_eq!(ids(&serde_json::from_str(&text).expect("JSON")), before);
    fs::rename(folder.join("moved"), folder.join("assets")).expect("a folder");
    let differing = |after: Vec<String>| after.iter().zip(&before).map(|(a, b)| a != b).collect::<Vec<_>>();
    assert_eq!(differing(ids(&plan(folder, "--max-error 0.12"))), [true; 4]);
    fs::write(folder.join("assets/roughcast.toml"), "[[override]]\nfiles = 'knobs/*'\nquality = 'best'\n")
        .expect("a file");
    assert_eq!(differing(ids(&plan(folder, ""))), [false, false, true, false]);
    fs::remove_file(folder.join("assets/roughcast.toml")).expect("a file");
    let mut bytes = fs::read(&image).expect("an image");
    bytes.push(0);
    fs::write(&image, bytes).expect("a file");
    assert_eq!(differing(ids(&plan(folder, ""))), [true, false, false, false]);
}

#[test]
fn jobs_shards_and_command_lines_write_what_a_bake_writes() {
    let scene = scene();
    let folder = scene.path();
    done(folder, "bake assets -o out -q --glb --nearest 30 --screen-height 720");
    let whole = hashes(&folder.join("out"));
    let restart = || fs::remove_dir_all(folder.join("out")).expect("a folder");
    let plan = plan(folder, "--glb --nearest 30 --screen-height 720");
    restart();
    for index in 1..=3 {
        done(folder, &format!("bake --plan plan.json --shard {index}/3 -q"));
    }
    assert_eq!(hashes(&folder.join("out")), whole, "shards");
    restart();
    for id in ids(&plan) {
        done(folder, &format!("bake assets -o out -q --glb --nearest 30 --screen-height 720 --job {}", &id[..12]));
    }
    assert_eq!(hashes(&folder.join("out")), whole, "jobs");
    restart();
    for id in ids(&plan) {
        done(folder, &format!("bake --plan plan.json --job {id} -q"));
    }
    assert_eq!(hashes(&folder.join("out")), whole, "jobs of the plan");
    restart();
    for job in plan["jobs"].as_array().expect("jobs") {
        let words = job["command"].as_array().expect("words").iter().map(|word| word.as_str().expect("a word"));
        let run = roughcast_in(folder, words.skip(1));
        assert_eq!((run.code, run.err.as_str()), (0, ""));
        for output in job["outputs"].as_array().expect("outputs") {
            let path = folder.join(output["path"].as_str().expect("a path"));
            assert_eq!((path.is_file(), path.is_dir()), (output["kind"] == "file", output["kind"] == "folder"));
        }
    }
    assert_eq!(hashes(&folder.join("out")), whole, "command lines");
}

#[test]
fn every_job_is_in_one_shard() {
    let scene = scene();
    plan(scene.path(), "");
    let mut runs = BTreeMap::new();
    for index in 1..=4 {
        let text = done(scene.path(), &format!("bake --plan plan.json --shard {index}/4 --json"));
        let report: Value = serde_json::from_str(&text).expect("JSON");
        for asset in report["assets"].as_array().expect("assets") {
            *runs.entry(asset["input"].to_string()).or_insert(0) += 1;
        }
    }
    assert_eq!(runs.into_values().collect::<Vec<_>>(), [1; 4]);
}

#[test]
fn a_job_that_is_not_as_planned_fails_and_the_others_do_not() {
    let scene = scene();
    let folder = scene.path();
    plan(folder, "");
    fs::write(folder.join("assets/brushed/brushed_normal.png"), "changed").expect("a file");
    let run = run(folder, "bake --plan plan.json -q");
    assert_eq!(run.code, 1);
    assert_eq!(run.err.lines().count(), 1, "{}", run.err);
    assert!(
        run.err.contains("assets/brushed/brushed.gltf: ") && run.err.contains("brushed_normal.png is not as it was"),
        "{}",
        run.err
    );
    assert!(!folder.join("out/brushed").exists() && folder.join("out/knobs/knobs.gltf").is_file());
}

#[test]
fn a_job_whose_declared_outputs_were_edited_fails() {
    let scene = scene();
    let folder = scene.path();
    let mut plan = plan(folder, "");
    for (kind, path) in [("file", "out/heights/more.bin"), ("folder", "out/heights/heights.gltf")] {
        let outputs = plan["jobs"][1]["outputs"].as_array_mut().expect("outputs");
        outputs.truncate(3);
        outputs.push(json!({ "path": path, "kind": kind }));
        fs::write(folder.join("plan.json"), plan.to_string()).expect("a file");
        let run = run(folder, "bake --plan plan.json -q");
        assert_eq!(run.code, 1, "{path}");
        let line = "error: assets/heights/heights.gltf: expected the outputs that planning makes of the job, found \
                    others: the plan was edited; plan again\n";
        assert_eq!(run.err, line);
    }
}

#[test]
fn assets_that_cannot_be_planned_are_reported_and_the_rest_is_planned() {
    let scene = scene();
    let folder = scene.path();
    fs::write(folder.join("assets/brushed/brushed.gltf"), "{").expect("a file");
    fs::remove_file(folder.join("assets/knobs/textures/surface.png")).expect("a file");
    let run = run(folder, "plan assets -o out");
    assert_eq!((run.code, run.out.lines().count(), run.err.lines().count()), (1, 2, 2), "{}{}", run.out, run.err);
    assert!(
        run.err.contains("assets/brushed/brushed.gltf: ") && run.err.contains("assets/knobs/textures/surface.png"),
        "{}",
        run.err
    );
}

#[test]
fn wrong_use_gives_one_clear_error() {
    let scene = scene();
    let folder = scene.path();
    plan(folder, "");
    fs::write(folder.join("bad.json"), "{}").expect("a file");
    let other =
        fs::read_to_string(folder.join("plan.json")).expect("a file").replacen(env!("CARGO_PKG_VERSION"), "9.9.9", 1);
    fs::write(folder.join("other.json"), other).expect("a file");
    let absolute = folder.join("assets").display().to_string();
    for (line, part) in [
        ("bake --plan missing.json", "missing.json: expected a readable file"),
        ("bake --plan bad.json", "bad.json: expected a plan of formatVersion 1, found none"),
        ("bake --plan other.json", "found one of 9.9.9; plan again"),
        ("bake --plan plan.json --glb", "cannot be used with"),
        ("bake --plan plan.json --fov 30", "cannot be used with"),
        ("bake --plan plan.json --quality best", "cannot be used with"),
        ("bake --plan plan.json --no-config", "cannot be used with"),
        ("bake assets --plan plan.json", "cannot be used with"),
        ("bake --plan plan.json --print-config", "cannot be used with"),
        ("bake --plan plan.json --shard 0/2", "expected I/N"),
        ("bake --plan plan.json --shard 3/2", "expected I/N"),
        ("bake --plan plan.json --job 12", "hexadecimal"),
        ("bake --plan plan.json --job 0123456789", "expected the id of a job"),
        ("bake assets -o out --cache-size ten", "expected a number of bytes"),
        (&format!("plan {absolute} -o out"), "expected paths relative to the working folder"),
    ] {
        let run = run(folder, line);
        assert!(run.code == 2 && run.err.contains(part), "{line}: {} {}", run.code, run.err);
    }
    assert!(!folder.join("out").exists());
}
