//! Bakes the photographed material of `fixtures/real`.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use super::process::{bake, done, fixtures};

#[test]
fn a_real_material_bakes_without_findings() {
    let folder = tempdir().expect("a folder");
    let run = bake(&fixtures().join("real"), folder.path(), &["--profile", "both", "--verbose"]);
    assert!(run.out.contains("gravel.gltf: ") && run.out.contains("Wet gravel: "), "{}", run.out);
    // RC1510: no lobe is within the default --max-error, as for any rough bumps.
    done(folder.path(), "check . --deep --allow RC1510");
}

#[test]
fn the_lobe_error_of_a_real_material_is_below_that_of_plain_mips() {
    let folder = tempdir().expect("a folder");
    let input = fixtures().join("real/gravel.gltf");
    done(folder.path(), &format!("compare {} -o out --texels 2 --quiet", input.display()));
    let text = fs::read(folder.path().join("out/compare.json")).expect("a report");
    let report: Value = serde_json::from_slice(&text).expect("JSON");
    let entries = report["materials"][0]["entries"].as_array().expect("entries");
    let error = |name: &str| {
        let entry = entries.iter().find(|entry| entry["name"] == name).expect("an entry");
        entry["error"].as_f64().expect("an error")
    };
    let chosen = entries.iter().find(|entry| entry["chosen"] == true).and_then(|entry| entry["error"].as_f64());
    assert!(chosen.expect("a chosen entry") < 0.7 * error("plain mips"), "{entries:#?}");
}
