//! Fresh bakes: no errors, and only the warnings and notes that are expected.

use std::collections::BTreeSet;
use std::path::Path;

use roughcast::cli::Outcome;

use crate::fixture::{bake, findings, roughcast};

/// Formats other than UASTC are not for KHR_texture_basisu (RC1101, a warning), and the dual form is off the
/// specification by intent (RC1205, a note). Nothing else.
#[test]
fn every_form_profile_and_target_is_clean() {
    let targets: &[&str] = if cfg!(feature = "bc") { &["basis", "bc", "float"] } else { &["basis", "float"] };
    for form in ["fallback", "strict", "dual"] {
        for profile in ["portable", "pyramid", "both"] {
            for target in targets {
                let options = ["--gltf", form, "--profile", profile, "--target", target, "--model", "anisotropic"];
                let bake = bake(&options);
                let (outcome, report) = bake.check_source(&["--deep"]);
                let found: BTreeSet<String> = findings(&report).into_iter().map(|(code, ..)| code).collect();
                let mut expected = BTreeSet::new();
                expected.extend((*target != "basis").then(|| "RC1101".to_owned()));
                expected.extend((form == "dual").then(|| "RC1205".to_owned()));
                assert_eq!(found, expected, "{options:?}: {report}");
                assert_eq!(outcome, if *target == "basis" { Outcome::Done } else { Outcome::Findings }, "{options:?}");
            }
        }
    }
}

#[test]
fn glb_is_clean() {
    for form in ["fallback", "strict"] {
        let bake = bake(&["--glb", "--gltf", form, "--profile", "both"]);
        let (outcome, report) = bake.check_source(&["--deep"]);
        assert_eq!((outcome, findings(&report)), (Outcome::Done, vec![]), "{form}: {report}");
    }
}

/// `map` bakes what no document names.
#[test]
fn bare_maps_are_clean() {
    let bake = bake(&[]);
    let (source, output) = (bake.source.join("bumps.png"), bake.baked.join("bare.ktx2"));
    let paths = [source.to_str().unwrap(), "-o", output.to_str().unwrap(), "-q"];
    assert_eq!(roughcast(&[&["map", "--profile", "both"], &paths[..]].concat()).0, Outcome::Done);
    let (outcome, report) = bake.check_source(&["--deep"]);
    assert_eq!((outcome, findings(&report)), (Outcome::Done, vec![]), "{report}");
    let files = report["files"].as_array().unwrap().len();
    assert_eq!(files, 4, "the document and three bare maps: {report}");
}

#[test]
fn text_has_a_line_per_finding_and_a_summary() {
    let bake = bake(&["--gltf", "dual"]);
    let (outcome, text, _) = roughcast(&["check", bake.document().to_str().unwrap()]);
    assert_eq!(outcome, Outcome::Done);
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].ends_with("ridges.gltf"), "{text}");
    assert!(lines[1].starts_with("  note RC1205 /textures/0/source: "), "{text}");
    assert!(lines.last().unwrap().starts_with("1 file checked: 0 errors, 0 warnings, "), "{text}");
}

#[test]
fn arguments_that_cannot_be_read_fail_without_stopping_the_others() {
    let bake = bake(&[]);
    let (missing, document) = (bake.baked.join("missing.gltf"), bake.document());
    let (outcome, out, err) = roughcast(&["check", missing.to_str().unwrap(), document.to_str().unwrap()]);
    assert_eq!(outcome, Outcome::Failed);
    assert!(err.contains("missing.gltf"), "{err}");
    assert!(out.contains("1 file checked"), "{out}");
    let text = bake.baked.join("a.txt");
    std::fs::write(&text, "").unwrap();
    assert_eq!(roughcast(&["check", text.to_str().unwrap()]).0, Outcome::Failed);
}

/// Textures of other writers are read, not judged.
#[test]
fn real_assets_are_clean() {
    let data = Path::new("../shared/data");
    for asset in ["plastic_monobloc_chair", "FlightHelmet", "AnisotropyBarnLamp"] {
        let source = data.join(asset);
        if !source.is_dir() {
            eprintln!("skipped: {} is not there", source.display());
            continue;
        }
        let folder = tempfile::tempdir().unwrap();
        let (source, output) = (source.to_str().unwrap(), folder.path().to_str().unwrap());
        assert_eq!(roughcast(&["bake", source, "-o", output, "-q"]).0, Outcome::Done);
        let (_, out, _) = roughcast(&["check", output, "--source", source, "--deep", "--format", "json"]);
        let codes: Vec<String> = findings(&serde_json::from_str(&out).unwrap()).into_iter().map(|f| f.0).collect();
        // What the lamp keeps of its own KTX2 stands in core sources; how much depends on the models chosen.
        let is_lamp = asset == "AnisotropyBarnLamp";
        assert!(codes.iter().all(|code| is_lamp && code == "RC1207"), "{asset}: {out}");
    }
}
