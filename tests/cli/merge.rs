//! Parts of a plan, and the jobs that no part has run.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use super::process::{Run, copy, fixtures, hashes, roughcast_in, roughcast_with};

const PARTS: usize = 3;

/// Plans three assets.
fn planned() -> TempDir {
    let folder = tempdir().expect("a folder");
    for asset in ["brushed", "heights", "waves"] {
        copy(&fixtures().join(asset), &folder.path().join("assets").join(asset));
    }
    fs::write(folder.path().join("plan.json"), done(folder.path(), "plan assets -o out --json")).expect("a file");
    folder
}

/// Plans three assets and runs the plan in parts, which write `0.json` to `2.json`.
fn run_in_parts() -> TempDir {
    let folder = planned();
    for task in 0..PARTS {
        let run = part(folder.path(), task, &format!("--report {task}.json"));
        assert_eq!((run.code, run.err.as_str()), (0, ""));
    }
    folder
}

/// Runs a part as Slurm would run it.
fn part(folder: &Path, task: usize, options: &str) -> Run {
    let line = format!("bake --plan plan.json --shard /{PARTS} -q {options}");
    roughcast_with(&[("SLURM_ARRAY_TASK_ID", &task.to_string())], folder, line.split_whitespace())
}

fn run(folder: &Path, line: &str) -> Run {
    roughcast_in(folder, line.split_whitespace())
}

fn done(folder: &Path, line: &str) -> String {
    let run = run(folder, line);
    assert_eq!((run.code, run.err.as_str()), (0, ""), "{line}");
    run.out
}

fn first_lines(run: &Run) -> (i32, Vec<&str>) {
    (run.code, run.out.lines().collect())
}

#[test]
fn tasks_of_an_array_run_the_whole_plan() {
    let folder = run_in_parts();
    assert_eq!(
        done(folder.path(), "plan merge plan.json 0.json 1.json 2.json"),
        "3 jobs: 3 done, 0 failed, 0 missing\n"
    );
    let parts = hashes(&folder.path().join("out"));
    fs::remove_dir_all(folder.path().join("out")).expect("a folder");
    done(folder.path(), "bake --plan plan.json -q");
    assert_eq!(hashes(&folder.path().join("out")), parts);
    let alone = part(folder.path(), PARTS, "");
    assert_eq!(alone.code, 2);
    assert!(alone.err.contains("expected 0 to 2 in SLURM_ARRAY_TASK_ID, found \"3\""), "{}", alone.err);
    let none = run(folder.path(), "bake --plan plan.json --shard /3");
    assert!(none.code == 2 && none.err.contains("found none of them set"), "{}", none.err);
}

#[test]
fn jobs_that_no_part_ran_are_missing() {
    let folder = run_in_parts();
    let folder = folder.path();
    fs::remove_dir_all(folder.join("out/waves")).expect("a folder");
    let lost = |folder: &Path, reports: &str| run(folder, &format!("plan merge plan.json {reports} --rest rest.json"));
    let merged = lost(folder, "0.json 1.json 2.json");
    let gone = "missing assets/waves/waves.glb: expected out/waves/waves.glb, found nothing there";
    assert_eq!(first_lines(&merged), (4, vec!["3 jobs: 2 done, 0 failed, 1 missing", gone]));
    assert_eq!(first_lines(&lost(folder, "")), first_lines(&merged), "the outputs alone suffice");
    let reported = done(folder, "plan merge plan.json 0.json 1.json 2.json --no-outputs");
    assert_eq!(reported, "3 jobs: 3 done, 0 failed, 0 missing\n");
    lost(folder, "");
    done(folder, "bake --plan rest.json -q --report more.json");
    done(folder, "plan merge plan.json more.json 0.json 1.json 2.json --rest rest.json");
    done(folder, "bake --plan rest.json");
    let merged = lost(folder, "more.json");
    let unreported = |name: &str| format!("missing assets/{name}: no report names the job");
    let (brushed, heights) = (unreported("brushed/brushed.gltf"), unreported("heights/heights.gltf"));
    assert_eq!(first_lines(&merged), (4, vec!["3 jobs: 1 done, 0 failed, 2 missing", &brushed, &heights]));
}

#[test]
fn separates_permanent_from_transient_failures() {
    let folder = planned();
    let folder = folder.path();
    fs::write(folder.join("assets/heights/heights.png"), "changed").expect("a file");
    assert_eq!(run(folder, "bake --plan plan.json -q --report all.json").code, 1);
    let merged = run(folder, "plan merge plan.json all.json --json --rest rest.json");
    assert_eq!(merged.code, 1, "{}", merged.out);
    let merged: Value = serde_json::from_str(&merged.out).expect("JSON");
    assert_eq!((&merged["jobs"], &merged["done"], &merged["missing"]), (&json!(3), &json!(2), &json!([])));
    let reason = merged["failed"][0]["reason"].as_str().expect("a reason");
    assert!(reason.contains("heights.png is not as it was"), "{reason}");
    let schema: Value = serde_json::from_str(include_str!("../../schemas/merge.schema.json")).expect("JSON");
    assert!(jsonschema::is_valid(&schema, &merged), "{merged}");
    let rest: Value = serde_json::from_slice(&fs::read(folder.join("rest.json")).expect("a file")).expect("JSON");
    assert_eq!(rest["jobs"], json!([]), "what fails for good is not run again");

    let mut report: Value = serde_json::from_slice(&fs::read(folder.join("all.json")).expect("a file")).expect("JSON");
    let schema: Value = serde_json::from_str(include_str!("../../schemas/report.schema.json")).expect("JSON");
    assert!(jsonschema::is_valid(&schema, &report));
    report["assets"][1]["retry"] = json!(true);
    assert!(jsonschema::is_valid(&schema, &report));
    fs::write(folder.join("transient.json"), report.to_string()).expect("a file");
    let transient = run(folder, "plan merge plan.json transient.json");
    assert!(
        transient.code == 4 && transient.out.contains("\nmissing assets/heights/heights.gltf: "),
        "{}",
        transient.out
    );
    let both = run(folder, "plan merge plan.json all.json transient.json");
    assert_eq!(both.code, 1, "{}", both.out);
}

#[test]
fn wrong_files_give_one_clear_error() {
    let folder = run_in_parts();
    let folder = folder.path();
    fs::write(folder.join("bad.json"), "{}").expect("a file");
    for (line, part) in [
        ("plan merge", "<PLAN>"),
        ("plan merge missing.json", "missing.json: expected a readable file"),
        ("plan merge bad.json", "bad.json: expected a plan"),
        ("plan merge plan.json bad.json", "bad.json: expected a report of formatVersion 1, found none"),
        ("plan merge plan.json missing.json", "missing.json: expected a readable file"),
        ("plan merge plan.json --no-outputs", "<REPORT>"),
    ] {
        let run = run(folder, line);
        assert!(run.code == 2 && run.err.contains(part), "{line}: {} {}", run.code, run.err);
    }
    done(folder, "bake assets/heights -o elsewhere -q --max-error 0.2 --report other.json");
    let foreign = run(folder, "plan merge plan.json 0.json 1.json 2.json other.json");
    let warning = "warning: other.json: expected a report of this plan, found none of its jobs there; \
                   leave the report out, or name its plan\n";
    assert_eq!((foreign.code, foreign.err.as_str()), (0, warning));
}
