//! Tests that the fixtures are what their generator writes, and that a bake keeps what it does not replace.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use super::process::{bake, files, fixtures};

#[path = "../../benches/studies/generate_fixtures/fixtures/mod.rs"]
mod generator;

#[test]
fn committed_fixtures_are_what_the_generator_writes() {
    let mut generated = generator::all();
    generated.sort();
    let remedy = "run `cargo run -p studies --bin generate_fixtures`, and delete what it does not write";
    // A photograph is not generated: fixtures/real/README.md.
    let committed: Vec<_> = files(&fixtures()).into_iter().filter(|(name, _)| !name.starts_with("real/")).collect();
    let names = |all: &[(String, _)]| all.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    let mut expected: Vec<_> = generated.iter().map(|(name, _)| name.clone()).collect();
    expected.sort();
    let mut found = names(&committed);
    found.sort();
    assert_eq!(found, expected, "{remedy}");
    for (name, bytes) in generated {
        assert!(fs::read(fixtures().join(&name)).expect("a fixture") == bytes, "{name} differs: {remedy}");
    }
}

#[test]
fn a_bake_keeps_what_it_does_not_replace() {
    let folder = tempdir().expect("a folder");
    bake(&fixtures().join("knobs/knobs.gltf"), folder.path(), &["--profile", "both"]);
    let read = |path| serde_json::from_slice::<Value>(&fs::read(path).expect("a document")).expect("JSON");
    let source = read(fixtures().join("knobs/knobs.gltf"));
    let mut baked = read(folder.path().join("knobs.gltf"));
    let asset = baked["asset"].as_object_mut().expect("an object");
    let record = asset.remove("extras").expect("the record of sources");
    assert_eq!(record.as_object().expect("an object").keys().collect::<Vec<_>>(), ["roughcast"]);
    for pointer in [
        "/asset",
        "/scenes",
        "/nodes",
        "/meshes",
        "/accessors",
        "/bufferViews",
        "/buffers",
        "/extensions",
        "/extras",
        "/materials/0/extras",
        "/materials/0/extensions/EXT_example_haptics",
        "/materials/0/pbrMetallicRoughness/baseColorFactor",
        "/materials/3/pbrMetallicRoughness/metallicRoughnessTexture",
        "/textures/1/extras",
    ] {
        let part = source.pointer(pointer);
        assert!(part.is_some(), "{pointer} is not in the fixture");
        assert_eq!(baked.pointer(pointer), part, "{pointer}");
    }
}

/// A plugin adds K to the base lobe, so that its texture stays in the document.
#[test]
fn both_profiles_together_keep_the_base_lobe() {
    let folder = tempdir().expect("a folder");
    bake(&fixtures().join("brushed/brushed.gltf"), folder.path(), &["--profile", "both"]);
    let document = fs::read(folder.path().join("brushed.gltf")).expect("a document");
    let document: Value = serde_json::from_slice(&document).expect("JSON");
    let at = |pointer: &str| document.pointer(pointer).unwrap_or_else(|| panic!("no {pointer}"));
    let base_lobe = "/materials/0/extensions/ROUGHCAST_materials_roughness_pyramid/baseLobe";
    let texture = at(&format!("{base_lobe}/metallicRoughnessTexture/index"));
    assert_ne!(texture, at("/materials/0/pbrMetallicRoughness/metallicRoughnessTexture/index"));
    let image = at(&format!("/textures/{texture}/source"));
    assert_eq!(at(&format!("/images/{image}/uri")), "brushed_surface.png");
    assert!(folder.path().join("brushed_surface.png").is_file());
}
