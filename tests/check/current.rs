//! Settings and versions that were recorded against those that hold today, and what the user takes for an error.

use std::fs;

use roughcast::cli::Outcome;
use serde_json::Value;

use crate::fixture::{Bake, bake, findings, roughcast};

/// What is found of settings, by file.
fn of_settings(report: &Value) -> Vec<(String, String)> {
    let list = report["findings"].as_array().unwrap().iter().filter(|f| f["code"] == "RC1507");
    list.map(|f| (f["file"].as_str().unwrap().to_owned(), f["message"].as_str().unwrap().to_owned())).collect()
}

fn configured(bake: &Bake, text: &str) -> (Outcome, Value) {
    fs::write(bake.source.join("roughcast.toml"), text).unwrap();
    bake.check_source(&[])
}

#[test]
fn each_setting_is_named_with_both_values() {
    let bake = bake(&["--max-error", "0.3"]);
    let text = "max-error = 0.2\nquality = 'best'\nnearest = 5.0\nscreen-height = 1080\nprovenance = true";
    let (outcome, report) = configured(&bake, text);
    assert_eq!(outcome, Outcome::Findings);
    let found = of_settings(&report);
    assert!(!found.is_empty(), "{report}");
    for (file, message) in found {
        assert!(message.starts_with("expected max-error = 0.2"), "{file}: {message}");
        let (expected, found) = message.split_once(", found ").unwrap();
        for said in ["max-error = 0.2", "quality = \"best\"", "nearest = 5.0", "screen-height = 1080"] {
            assert!(expected.contains(said), "{said}: {message}");
        }
        for said in ["max-error = 0.3", "quality = \"fast\"", "nearest unset", "screen-height unset"] {
            assert!(found.contains(said), "{said}: {message}");
        }
        assert!(!message.contains("target") && !message.contains("model"), "{message}");
    }
}

/// Flags win over the file, as they do in `bake`; overrides hold for the asset's place.
#[test]
fn settings_are_those_that_a_bake_would_have() {
    let bake = bake(&["--quality", "best", "--profile", "both"]);
    let flags = ["--quality", "best", "--profile", "both"];
    assert_eq!(bake.check_source(&flags).0, Outcome::Done);
    assert_eq!(bake.check_source(&flags[2..]).0, Outcome::Findings);
    let text = "quality = 'best'\n[[override]]\nfiles = 'ridges.gltf'\nprofile = 'both'";
    assert_eq!(configured(&bake, text).0, Outcome::Done);
    assert_eq!(configured(&bake, &text.replace("ridges", "other")).0, Outcome::Findings);
    assert_eq!(bake.check_source(&flags).0, Outcome::Done);
    assert_eq!(bake.check_source(&["--no-config"]).0, Outcome::Findings);
    // A file that says nothing says that the defaults hold.
    assert_eq!(configured(&bake, "").0, Outcome::Findings);
    fs::remove_file(bake.source.join("roughcast.toml")).unwrap();
    assert_eq!(bake.check_source(&[]).0, Outcome::Done);
}

/// What was chosen is not what was asked for.
#[test]
fn a_chosen_model_is_not_a_model_that_was_asked_for() {
    let auto = bake(&[]);
    assert_eq!(configured(&auto, "model = 'auto'").0, Outcome::Done);
    for model in ["none", "isotropic", "anisotropic"] {
        let (outcome, report) = configured(&auto, &format!("model = '{model}'"));
        assert_eq!(outcome, Outcome::Findings, "{model}");
        let (file, message) = of_settings(&report).remove(0);
        assert!(
            message.starts_with(&format!("expected model = \"{model}\", found model = \"auto\"")),
            "{file} {message}"
        );
        let asked = bake(&["--model", model]);
        assert_eq!(configured(&asked, &format!("model = '{model}'")).0, Outcome::Done, "{model}");
        assert_eq!(configured(&asked, "model = 'auto'").0, Outcome::Findings, "{model}");
    }
}

/// `map` reads no roughcast.toml.
#[test]
fn bare_maps_have_no_settings_in_files() {
    let bake = bake(&[]);
    let (source, output) = (bake.source.join("bumps.png"), bake.baked.join("bare.ktx2"));
    let words = ["map", source.to_str().unwrap(), "-o", output.to_str().unwrap(), "-q", "--quality", "best"];
    assert_eq!(roughcast(&words).0, Outcome::Done);
    assert_eq!(configured(&bake, "").0, Outcome::Done);
}

#[test]
fn settings_need_sources_and_sense() {
    let bake = bake(&[]);
    let baked = bake.baked.to_str().unwrap();
    let (outcome, _, err) = roughcast(&["check", baked, "--quality", "best"]);
    assert_eq!((outcome, err.contains("--source")), (Outcome::Usage, true), "{err}");
    fs::write(bake.source.join("roughcast.toml"), "qualty = 'best'").unwrap();
    let (outcome, _, err) = roughcast(&["check", baked, "--source", bake.source.to_str().unwrap()]);
    assert_eq!((outcome, err.contains("qualty")), (Outcome::Usage, true), "{err}");
}

#[test]
fn a_minimum_version_makes_old_outputs_errors() {
    let bake = bake(&[]);
    for (version, expected) in [("0.1.0", Outcome::Done), ("0.0.9", Outcome::Done), ("0.1.1", Outcome::Findings)] {
        assert_eq!(bake.check(&["--min-version", version]).0, expected, "{version}");
    }
    let codes: Vec<String> = findings(&bake.check(&["--min-version", "1.0.0"]).1).into_iter().map(|f| f.0).collect();
    assert!(!codes.is_empty() && codes.iter().all(|code| code == "RC1508"), "{codes:?}");
}

/// RC1205 is a note, RC1101 a warning.
#[test]
fn severities_are_the_users() {
    let bake = bake(&["--gltf", "dual", "--target", "float"]);
    assert_eq!(bake.check(&[]).0, Outcome::Findings);
    let (outcome, report) = bake.check(&["--allow", "RC1101"]);
    assert_eq!(outcome, Outcome::Done);
    assert!(report["findings"].as_array().unwrap().iter().all(|f| f["severity"] == "note"), "{report}");
    let (outcome, report) = bake.check(&["--allow", "rc1101", "--deny", "RC1205"]);
    assert_eq!(outcome, Outcome::Findings);
    let of_1205 = |f: &&Value| f["code"] == "RC1205";
    assert!(
        report["findings"].as_array().unwrap().iter().filter(of_1205).all(|f| f["severity"] == "error"),
        "{report}"
    );
}
