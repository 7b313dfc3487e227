//! Tests of anisotropy that a material has of its own: presets leave it as it is, and roughness follows the engine.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::tempdir;

use super::process::{bake, copy, fixtures};

/// What a bake makes of the material `Brass`, whose strength is 0.5 and whose roughness factor is 0.8.
struct Brass {
    strength: f64,
    has_texture: bool,
    /// 1 if the roughness was baked.
    roughness_factor: f64,
    /// Kinds of the notes on its base layer.
    notes: Vec<Value>,
    /// The extension of the pyramid profile.
    pyramid: Value,
}

fn brass(options: &[&str]) -> Brass {
    baked_brass(&fixtures().join("knobs/knobs.gltf"), options)
}

fn baked_brass(source: &Path, options: &[&str]) -> Brass {
    let baked = tempdir().expect("a folder");
    let options = [options, &["--glb=false", "--json"]].concat();
    let run = bake(source, baked.path(), &options);
    let report: Value = serde_json::from_str(&run.out).expect("JSON");
    let text = fs::read(baked.path().join("knobs.gltf")).expect("a document");
    let document: Value = serde_json::from_slice(&text).expect("JSON");
    let material = &document["materials"][0];
    let anisotropy = &material["extensions"]["KHR_materials_anisotropy"];
    let notes = report["assets"][0]["layers"][0]["notes"].as_array().cloned().unwrap_or_default();
    Brass {
        strength: anisotropy["anisotropyStrength"].as_f64().expect("a strength"),
        has_texture: anisotropy.get("anisotropyTexture").is_some(),
        roughness_factor: material["pbrMetallicRoughness"]["roughnessFactor"].as_f64().expect("a factor"),
        notes: notes.into_iter().map(|note| note["kind"].clone()).collect(),
        pyramid: material["extensions"]["ROUGHCAST_materials_roughness_pyramid"].clone(),
    }
}

#[test]
fn engines_that_read_anisotropy_get_anisotropy_and_roughness_of_the_source() {
    for engine in ["three", "babylon", "playcanvas", "bevy"] {
        let brass = brass(&["--engine", engine]);
        assert_eq!((brass.strength, brass.has_texture, brass.roughness_factor), (0.5, false, 0.8), "{engine}");
        assert!(brass.notes.contains(&json!("anisotropyKept")), "{engine}: {:?}", brass.notes);
    }
}

#[test]
fn engines_that_do_not_read_anisotropy_get_the_roughness_of_lost_bumps() {
    for engine in ["filament", "godot"] {
        let brass = brass(&["--engine", engine]);
        assert_eq!((brass.strength, brass.has_texture, brass.roughness_factor), (0.5, false, 1.0), "{engine}");
        assert!(!brass.notes.contains(&json!("anisotropyDropped")), "{engine}: {:?}", brass.notes);
    }
}

#[test]
fn explicit_settings_bake_anisotropy_for_every_engine() {
    let anisotropic = brass(&["--engine", "three", "--model", "anisotropic"]);
    assert_eq!((anisotropic.strength, anisotropic.has_texture), (1.0, true));
    let isotropic = brass(&["--engine", "three", "--own-anisotropy", "bake"]);
    assert_eq!((isotropic.strength, isotropic.roughness_factor), (0.0, 1.0));
    assert!(isotropic.notes.contains(&json!("anisotropyDropped")), "{:?}", isotropic.notes);
}

#[test]
fn the_pyramid_profile_alone_ignores_the_setting() {
    let baked = brass(&["--engine", "three", "--profile", "pyramid"]);
    assert_eq!((baked.strength, baked.roughness_factor), (0.5, 0.8));
    assert!(!baked.notes.contains(&json!("anisotropyKept")), "{:?}", baked.notes);
}

#[test]
fn the_pyramid_has_the_lobes_of_the_material_whatever_becomes_of_the_core() {
    let options = |own| ["--engine", "three", "--profile", "both", "--own-anisotropy", own];
    let [baked, kept, ignored] = ["bake", "keep", "ignore"].map(|own| brass(&options(own)));
    assert_eq!((kept.strength, kept.roughness_factor), (0.5, 0.8));
    assert!(kept.notes.contains(&json!("anisotropyKept")), "{:?}", kept.notes);
    for member in ["correctionFactor", "roughnessModel", "roughnessMin", "roughnessMax", "offsetScale"] {
        assert_eq!(kept.pyramid[member], baked.pyramid[member], "{member}");
    }
    // The core material still has the base lobe.
    assert!(kept.pyramid.get("baseLobe").is_none(), "{}", kept.pyramid);
    assert_eq!(baked.pyramid["baseLobe"]["anisotropy"]["anisotropyStrength"], 0.5);
    assert!(ignored.pyramid["baseLobe"].get("anisotropy").is_none(), "{}", ignored.pyramid);
}

#[test]
fn a_strength_of_0_is_no_anisotropy() {
    let source = tempdir().expect("a folder");
    copy(&fixtures().join("knobs"), source.path());
    let document = source.path().join("knobs.gltf");
    let text = fs::read_to_string(&document).expect("a document");
    let without = text.replace("\"anisotropyStrength\": 0.5", "\"anisotropyStrength\": 0");
    assert_ne!(without, text);
    fs::write(&document, without).expect("a file");
    let baked = baked_brass(&document, &["--engine", "three"]);
    assert_eq!((baked.strength, baked.roughness_factor), (0.0, 1.0));
    let is_on_anisotropy = |kind: &Value| kind == "anisotropyKept" || kind == "anisotropyDropped";
    assert!(!baked.notes.iter().any(is_on_anisotropy), "{:?}", baked.notes);
}
