//! Tests that `check` finds nothing in fresh bakes, with and without `--deep`: of every fixture and every form of
//! input, in every profile, form, target and frame.

use std::fs;
use std::path::{Path, PathBuf};

use roughcast::cli::Outcome;
use roughcast::project::Engine;
use serde_json::Value;
use tempfile::TempDir;

use crate::fixture::roughcast;
use crate::inputs::{COUNT, write_inputs, write_row};

/// The repository's fixtures that are assets.
const FIXTURES: [&str; 4] = ["brushed", "heights", "knobs", "waves"];

/// Writes all fixtures and inputs except `left_out` into a temporary folder.
fn sources(left_out: &[&str]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source");
    write_inputs(&source);
    left_out.iter().for_each(|asset| fs::remove_dir_all(source.join(asset)).unwrap());
    for fixture in FIXTURES {
        let fixtures = Path::new("fixtures");
        for entry in walkdir::WalkDir::new(fixtures.join(fixture)) {
            let entry = entry.unwrap();
            let target = source.join("fixtures").join(entry.path().strip_prefix(fixtures).unwrap());
            match entry.file_type().is_dir() {
                true => fs::create_dir_all(target).unwrap(),
                false => fs::copy(entry.path(), target).map(drop).unwrap(),
            }
        }
    }
    (folder, source)
}

/// Bakes the `count` assets at `source` with `options` and checks them with the same options. Returns the findings
/// whose codes are not `expected`. RC1510 is always expected, since the bumps are too rough for the default
/// `--max-error`.
fn findings(source: &Path, count: usize, options: &[&str], expected: &[&str]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let (source, baked) = (source.to_str().unwrap(), folder.path().to_str().unwrap());
    let (outcome, _, err) = roughcast(&[&["bake", source, "-o", baked, "-q"], options].concat());
    assert_eq!(outcome, Outcome::Done, "{options:?}: {err}");
    let mut found = Vec::new();
    for deep in [&[][..], &["--deep"]] {
        let check = [&["check", baked, "--source", source, "--format", "json"], deep, options].concat();
        let (outcome, out, err) = roughcast(&check);
        let report: Value = serde_json::from_str(&out).unwrap();
        let documents = report["files"].as_array().unwrap().len();
        assert_eq!(documents, count, "{options:?}: {report}");
        let is_expected = |code: &str| code == "RC1510" || expected.contains(&code);
        let unexpected = report["findings"].as_array().unwrap().iter();
        let unexpected: Vec<&Value> = unexpected.filter(|f| !is_expected(f["code"].as_str().unwrap())).collect();
        let is_failure = |f: &&Value| f["severity"] != "note";
        let failures: Vec<&Value> = report["findings"].as_array().unwrap().iter().filter(is_failure).collect();
        assert_eq!(outcome, if failures.is_empty() { Outcome::Done } else { Outcome::Findings }, "{options:?}: {err}");
        let text = |f: &&Value| format!("{options:?} {deep:?}: {f}").replace(baked, "");
        found.extend(unexpected.iter().map(text));
    }
    found
}

/// Returns the codes that are expected: KHR_texture_basisu does not allow formats other than UASTC (RC1101), and the
/// dual form names the KTX2 twice (RC1205).
fn intended(target: &str, form: &str) -> Vec<&'static str> {
    let mut codes = Vec::new();
    codes.extend((target != "basis").then_some("RC1101"));
    codes.extend((form == "dual").then_some("RC1205"));
    codes
}

/// Options of a bake, and the codes that are expected.
type Row = (Vec<&'static str>, Vec<&'static str>);

fn assert_all_clean(rows: &[Row], left_out: &[&str]) {
    let (_folder, source) = sources(left_out);
    let count = COUNT + FIXTURES.len() - left_out.len();
    let mut found = Vec::new();
    for (options, expected) in rows {
        found.extend(findings(&source, count, options, expected));
    }
    assert!(found.is_empty(), "{} findings:\n{}", found.len(), found.join("\n"));
}

fn targets() -> &'static [&'static str] {
    if cfg!(feature = "bc") { &["basis", "bc", "float"] } else { &["basis", "float"] }
}

#[test]
fn every_input_is_clean_in_every_profile_form_target_and_frame() {
    let mut rows: Vec<Row> = Vec::new();
    for profile in ["portable", "pyramid", "both"] {
        for form in ["fallback", "strict", "dual"] {
            for target in targets() {
                for frame in ["unit", "natural", "main-direction"] {
                    let options = vec!["--profile", profile, "--gltf", form, "--target", target, "--frame", frame];
                    rows.push((options, intended(target, form)));
                }
            }
        }
    }
    assert_all_clean(&rows, &[]);
}

/// `--glb` excludes `--gltf dual`, since the dual form needs external files. It also excludes buffers that meshopt has
/// compressed, since their views cannot be moved.
#[test]
fn every_input_is_clean_as_glb() {
    let mut rows: Vec<Row> = Vec::new();
    for form in ["fallback", "strict"] {
        for target in targets() {
            let options = vec!["--glb", "--gltf", form, "--profile", "both", "--target", target];
            rows.push((options, intended(target, form)));
        }
    }
    assert_all_clean(&rows, &["meshopt"]);
}

#[test]
fn every_input_is_clean_for_engines_and_with_other_models_and_encoders() {
    let mut rows: Vec<Row> = Vec::new();
    for target in targets() {
        for model in ["none", "isotropic", "anisotropic"] {
            let options = ["--model", model, "--profile", "both", "--target", target, "--frame", "natural"];
            rows.push(([&options[..], &["--gltf", "fallback"]].concat(), intended(target, "fallback")));
        }
    }
    for engine in Engine::names() {
        // Presets choose forms and targets.
        rows.push((vec!["--engine", engine, "--profile", "both"], vec!["RC1101", "RC1205"]));
    }
    rows.push((vec!["--quality", "best", "--profile", "both"], vec![]));
    rows.push((vec!["--rdo", "0.5", "--profile", "both", "--model", "anisotropic"], vec![]));
    rows.push((vec!["--rdo", "6", "--profile", "both", "--model", "anisotropic", "--gltf", "fallback"], vec![]));
    // Without provenance, textures cannot be compared with their sources.
    rows.push((vec!["--no-provenance", "--profile", "both", "--rdo", "6"], vec!["RC1501", "RC1506", "RC1008"]));
    assert_all_clean(&rows, &[]);
}

/// The map has one row of the maximum length.
#[test]
fn the_longest_row_is_clean() {
    let folder = tempfile::tempdir().unwrap();
    let (source, baked) = (folder.path().join("source"), folder.path().join("baked"));
    write_row(&source, 65536);
    let (source, baked) = (source.to_str().unwrap(), baked.to_str().unwrap());
    assert_eq!(
        roughcast(&["bake", source, "-o", baked, "-q", "--profile", "both", "--gltf", "strict"]).0,
        Outcome::Done
    );
    let (outcome, out, _) = roughcast(&["check", baked, "--deep"]);
    assert_eq!(outcome, Outcome::Done, "{out}");
}
