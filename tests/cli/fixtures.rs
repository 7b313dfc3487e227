//! Tests that the fixtures are what their generator writes, and that a bake keeps what it does not replace.

use std::fs;
use std::path::Path;

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

/// Returns the baked document of `fixtures/brushed`, whose roughness and metalness vary.
fn brushed(folder: &Path, profile: &str) -> Value {
    bake(&fixtures().join("brushed/brushed.gltf"), folder, &["--profile", profile]);
    let document = fs::read(folder.join("brushed.gltf")).expect("a document");
    serde_json::from_slice(&document).expect("JSON")
}

/// Returns the URI of the KTX2 file of the texture that the `textureInfo` at `pointer` names.
fn ktx2_of<'d>(document: &'d Value, pointer: &str) -> &'d str {
    let at = |pointer: &str| document.pointer(pointer).unwrap_or_else(|| panic!("no {pointer}"));
    let texture = at(&format!("{pointer}/index"));
    let image = at(&format!("/textures/{texture}/extensions/KHR_texture_basisu/source"));
    at(&format!("/images/{image}/uri")).as_str().expect("a URI")
}

const EXTENSION: &str = "/materials/0/extensions/ROUGHCAST_materials_roughness_pyramid";
const CORE: &str = "/materials/0/pbrMetallicRoughness";

/// A plugin adds K to the base lobe, and mips of the base lobe are not those of the material's texture.
#[test]
fn both_profiles_together_have_a_texture_of_the_base_lobe() {
    let folder = tempdir().expect("a folder");
    let document = brushed(folder.path(), "both");
    let base = ktx2_of(&document, &format!("{EXTENSION}/baseLobe/metallicRoughnessTexture"));
    assert_eq!(base, "brushed.roughcast/brushed_surface.baseRoughness.ktx2");
    assert!(folder.path().join(base).is_file());
    let core = ktx2_of(&document, &format!("{CORE}/metallicRoughnessTexture"));
    assert_eq!(core, "brushed.roughcast/brushed_surface.roughness.ktx2");
    assert_eq!(document.pointer(&format!("{EXTENSION}/baseLobe/roughnessFactor")), Some(&Value::from(1.0)));
}

#[test]
fn the_pyramid_profile_has_the_base_lobe_in_the_core_properties() {
    let folder = tempdir().expect("a folder");
    let document = brushed(folder.path(), "pyramid");
    let core = ktx2_of(&document, &format!("{CORE}/metallicRoughnessTexture"));
    assert_eq!(core, "brushed.roughcast/brushed_surface.baseRoughness.ktx2");
    assert_eq!(document.pointer(&format!("{CORE}/roughnessFactor")), Some(&Value::from(1)));
    assert_eq!(document.pointer(&format!("{EXTENSION}/baseLobe")), None);
}
