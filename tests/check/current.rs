//! Tests that compare recorded settings and versions with current ones, and of severities that the user sets.

use std::fs;

use roughcast::cli::Outcome;
use serde_json::Value;
use tempfile::tempdir;

use crate::fixture::{Bake, bake, findings, roughcast, write_asset};

/// Returns file and message of each finding about settings.
fn settings_findings(report: &Value) -> Vec<(String, String)> {
    let list = report["findings"].as_array().unwrap().iter().filter(|f| f["code"] == "RC1507");
    list.map(|f| (f["file"].as_str().unwrap().to_owned(), f["message"].as_str().unwrap().to_owned())).collect()
}

fn check_with_config(bake: &Bake, text: &str) -> (Outcome, Value) {
    fs::write(bake.source.join("roughcast.toml"), text).unwrap();
    bake.check_source(&[])
}

#[test]
fn names_each_setting_with_both_values() {
    let bake = bake(&["--max-error", "0.3"]);
    let text = "max-error = 0.2\nquality = 'best'\nnearest = 5.0\nscreen-height = 1080\nprovenance = true";
    let (outcome, report) = check_with_config(&bake, text);
    assert_eq!(outcome, Outcome::Findings);
    let found = settings_findings(&report);
    assert!(!found.is_empty(), "{report}");
    for (file, message) in found {
        assert!(message.starts_with("expected max-error = 0.2"), "{file}: {message}");
        let (expected, found) = message.split_once(", found ").unwrap();
        for part in ["max-error = 0.2", "quality = \"best\"", "nearest = 5.0", "screen-height = 1080"] {
            assert!(expected.contains(part), "{part}: {message}");
        }
        for part in ["max-error = 0.3", "quality = \"fast\"", "nearest unset", "screen-height unset"] {
            assert!(found.contains(part), "{part}: {message}");
        }
        assert!(!message.contains("target") && !message.contains("model"), "{message}");
    }
}

/// Flags have priority over the file, as in `bake`. Overrides apply by the path of the asset.
#[test]
fn compares_with_the_settings_of_a_bake() {
    let bake = bake(&["--quality", "best", "--profile", "both"]);
    let flags = ["--quality", "best", "--profile", "both"];
    assert_eq!(bake.check_source(&flags).0, Outcome::Done);
    assert_eq!(bake.check_source(&flags[2..]).0, Outcome::Findings);
    let text = "quality = 'best'\n[[override]]\nfiles = 'ridges.gltf'\nprofile = 'both'";
    assert_eq!(check_with_config(&bake, text).0, Outcome::Done);
    assert_eq!(check_with_config(&bake, &text.replace("ridges", "other")).0, Outcome::Findings);
    assert_eq!(bake.check_source(&flags).0, Outcome::Done);
    assert_eq!(bake.check_source(&["--no-config"]).0, Outcome::Findings);
    // An empty file means that the defaults apply.
    assert_eq!(check_with_config(&bake, "").0, Outcome::Findings);
    fs::remove_file(bake.source.join("roughcast.toml")).unwrap();
    assert_eq!(bake.check_source(&[]).0, Outcome::Done);
}

/// The model that `auto` chooses does not count as a requested model.
#[test]
fn compares_the_requested_model_and_not_the_chosen_model() {
    let auto = bake(&[]);
    assert_eq!(check_with_config(&auto, "model = 'auto'").0, Outcome::Done);
    for model in ["none", "isotropic", "anisotropic"] {
        let (outcome, report) = check_with_config(&auto, &format!("model = '{model}'"));
        assert_eq!(outcome, Outcome::Findings, "{model}");
        let (file, message) = settings_findings(&report).remove(0);
        assert!(
            message.starts_with(&format!("expected model = \"{model}\", found model = \"auto\"")),
            "{file} {message}"
        );
        let requested = bake(&["--model", model]);
        assert_eq!(check_with_config(&requested, &format!("model = '{model}'")).0, Outcome::Done, "{model}");
        assert_eq!(check_with_config(&requested, "model = 'auto'").0, Outcome::Findings, "{model}");
    }
}

/// `map` does not read roughcast.toml.
#[test]
fn standalone_maps_are_not_compared_with_roughcast_toml() {
    let bake = bake(&[]);
    let (source, output) = (bake.source.join("bumps.png"), bake.baked.join("standalone.ktx2"));
    let words = ["map", source.to_str().unwrap(), "-o", output.to_str().unwrap(), "-q", "--quality", "best"];
    assert_eq!(roughcast(&words).0, Outcome::Done);
    assert_eq!(check_with_config(&bake, "").0, Outcome::Done);
}

/// pre-commit names single files of the output folder. Their sources lie below the source folder.
#[test]
fn a_single_file_has_its_source_in_the_folder_of_the_same_name() {
    let folder = tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    write_asset(&folder.path().join("assets/rock/wet"));
    let (outcome, _, err) = roughcast(&["bake", &path("assets"), "-o", &path("baked"), "-q"]);
    assert_eq!(outcome, Outcome::Done, "{err}");
    let files = ["ridges.gltf", "ridges.roughcast/bumps.normal.ktx2", "ridges.roughcast/surface.roughness.ktx2"];
    let files = files.map(|file| path(&format!("baked/rock/wet/{file}")));
    let check = |file: &str| roughcast(&["check", file, "--source", &path("assets")]);
    for file in &files {
        let (outcome, out, err) = check(file);
        assert_eq!(outcome, Outcome::Done, "{file}: {out}{err}");
    }
    fs::rename(path("assets/rock/wet"), path("assets/rock/dry")).unwrap();
    for file in &files {
        let (outcome, out, _) = check(file);
        assert!(outcome == Outcome::Findings && out.contains("RC1504"), "{file}: {out}");
    }
}

#[test]
fn refuses_settings_without_sources_and_unknown_settings() {
    let bake = bake(&[]);
    let baked = bake.baked.to_str().unwrap();
    let (outcome, _, err) = roughcast(&["check", baked, "--quality", "best"]);
    assert_eq!((outcome, err.contains("--source")), (Outcome::Usage, true), "{err}");
    fs::write(bake.source.join("roughcast.toml"), "qualty = 'best'").unwrap();
    let (outcome, _, err) = roughcast(&["check", baked, "--source", bake.source.to_str().unwrap()]);
    assert_eq!((outcome, err.contains("qualty")), (Outcome::Usage, true), "{err}");
}

#[test]
fn outputs_below_the_minimum_version_are_errors() {
    let bake = bake(&[]);
    for (version, expected) in [("0.1.0", Outcome::Done), ("0.0.9", Outcome::Done), ("0.1.1", Outcome::Findings)] {
        assert_eq!(bake.check(&["--min-version", version]).0, expected, "{version}");
    }
    let codes: Vec<String> = findings(&bake.check(&["--min-version", "1.0.0"]).1).into_iter().map(|f| f.0).collect();
    assert!(!codes.is_empty() && codes.iter().all(|code| code == "RC1508"), "{codes:?}");
}

/// RC1205 is a note and RC1101 a warning by default.
#[test]
fn allow_and_deny_change_severities() {
    let bake = bake(&["--gltf", "dual", "--target", "float"]);
    assert_eq!(bake.check(&[]).0, Outcome::Findings);
    let (outcome, report) = bake.check(&["--allow", "RC1101"]);
    assert_eq!(outcome, Outcome::Done);
    assert!(report["findings"].as_array().unwrap().iter().all(|f| f["severity"] == "note"), "{report}");
    let (outcome, report) = bake.check(&["--allow", "rc1101", "--deny", "RC1205"]);
    assert_eq!(outcome, Outcome::Findings);
    let is_1205 = |f: &&Value| f["code"] == "RC1205";
    assert!(
        report["findings"].as_array().unwrap().iter().filter(is_1205).all(|f| f["severity"] == "error"),
        "{report}"
    );
}
