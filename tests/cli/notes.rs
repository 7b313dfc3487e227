//! The notes on sources for which the method cannot be exact (docs/stability.md). Notes on faults of kernels
//! are tested where the notes are made.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::tempdir;

use super::process::{bake, copy, fixtures, roughcast};

const NOTE: &str = "the bump map is a JPEG";

/// Writes the image `from` as a JPEG.
fn to_jpeg(from: &Path, to: &Path) {
    let picture = image::open(from).expect("a picture").to_rgb8();
    let (width, height) = (picture.width() as u16, picture.height() as u16);
    let mut file = Vec::new();
    let encoder = jpeg_encoder::Encoder::new(&mut file, 90);
    encoder.encode(&picture, width, height, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
    fs::write(to, file).expect("a file");
}

#[test]
fn jpeg_sources_are_reported() {
    let (source, baked) = (tempdir().expect("a folder"), tempdir().expect("a folder"));
    copy(&fixtures().join("brushed"), source.path());
    let (png, jpeg) = (source.path().join("brushed_normal.png"), source.path().join("brushed_normal.jpg"));
    let document = source.path().join("brushed.gltf");
    assert!(!bake(&document, baked.path(), &[]).out.contains(NOTE));

    to_jpeg(&png, &jpeg);
    let text = fs::read_to_string(&document).expect("a document");
    fs::write(&document, text.replace("brushed_normal.png", "brushed_normal.jpg")).expect("a file");
    assert!(bake(&document, baked.path(), &[]).out.contains(NOTE));

    let output = baked.path().join("map.ktx2");
    let map = |image: &Path| roughcast(["map".as_ref(), image.as_os_str(), "-o".as_ref(), output.as_os_str()]).out;
    assert!(map(&jpeg).contains(NOTE));
    assert!(!map(&png).contains(NOTE));
}

#[test]
fn a_map_without_roughness_is_reported() {
    let baked = tempdir().expect("a folder");
    let (map, output) = (fixtures().join("brushed/brushed_normal.png"), baked.path().join("map.ktx2"));
    let bake = |options: &[&str]| {
        let words = ["map".as_ref(), map.as_os_str(), "-o".as_ref(), output.as_os_str()];
        roughcast(words.into_iter().chain(options.iter().map(OsStr::new))).out
    };
    let note = "the roughness of the surface is not known";
    assert!(bake(&[]).contains(note));
    assert!(!bake(&["--roughness-factor", "0.3"]).contains(note));
    assert!(!bake(&["--profile", "pyramid"]).contains(note));
}

#[test]
fn a_damaged_base_colour_is_reported_and_the_asset_is_baked() {
    let (source, baked) = (tempdir().expect("a folder"), tempdir().expect("a folder"));
    copy(&fixtures().join("brushed"), source.path());
    let (document, colour) = (source.path().join("brushed.gltf"), source.path().join("brushed_colour.png"));
    let note = "every texel counts by its area alone";
    assert!(!bake(&document, baked.path(), &[]).out.contains(note));
    let bytes = fs::read(&colour).expect("a picture");
    fs::write(&colour, &bytes[..bytes.len() / 2]).expect("a file");
    let run = bake(&document, baked.path(), &[]);
    assert!(run.code == 0 && run.out.contains(note), "{} {}", run.out, run.err);
}

/// The document says that Draco compresses the mesh, so that its accessors have no data.
#[test]
fn compressed_meshes_are_reported_if_the_bake_needs_them() {
    for (fixture, unit) in [("brushed", "offsets are in the unit frame"), ("heights", "in widths of a repeat")] {
        let (source, baked) = (tempdir().expect("a folder"), tempdir().expect("a folder"));
        copy(&fixtures().join(fixture), source.path());
        let document = source.path().join(format!("{fixture}.gltf"));
        let text = fs::read_to_string(&document).expect("a document");
        let mut root: Value = serde_json::from_str(&text).expect("JSON");
        for accessor in root["accessors"].as_array_mut().expect("accessors") {
            accessor.as_object_mut().expect("an accessor").remove("bufferView");
        }
        for mesh in root["meshes"].as_array_mut().expect("meshes") {
            mesh["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = json!({ "bufferView": 0 });
        }
        fs::write(&document, root.to_string()).expect("a file");

        let cause = "compressed by KHR_draco_mesh_compression, which the bake does not read";
        let run = bake(&document, baked.path(), &["--profile", "pyramid", "-v"]);
        assert!(run.code == 0 && !run.out.contains(cause), "{} {}", run.out, run.err);
        let run = bake(&document, baked.path(), &["--profile", "pyramid", "--frame", "natural"]);
        assert!(run.out.contains(cause) && run.out.contains(unit), "{} {}", run.out, run.err);
        let run = bake(&document, baked.path(), &["--nearest", "1", "--screen-height", "1080"]);
        assert!(run.out.contains(cause) && run.out.contains("every level counts as seen"), "{} {}", run.out, run.err);
    }
}

#[test]
fn notes_that_ask_for_nothing_are_printed_with_verbose_only() {
    let baked = tempdir().expect("a folder");
    let (document, note) = (fixtures().join("knobs/knobs.gltf"), "was resampled to 64 x 48");
    assert!(!bake(&document, baked.path(), &[]).out.contains(note));
    assert!(bake(&document, baked.path(), &["-v"]).out.contains(note));
    let report: Value = serde_json::from_str(&bake(&document, baked.path(), &["--json"]).out).expect("a report");
    let layers = report["assets"][0]["layers"].as_array().expect("layers");
    let is_resampled = |found: &&Value| found["kind"] == "resampled";
    let found = layers.iter().find_map(|layer| layer["notes"].as_array()?.iter().find(is_resampled)).expect("a note");
    assert_eq!(found["asksForAction"], false);
    assert!(found["text"].as_str().is_some_and(|text| text.contains(note)), "{found}");
}

#[test]
fn a_run_names_the_limiter_of_the_engine_once() {
    let baked = tempdir().expect("a folder");
    let note = "rendering/anti_aliasing/screen_space_roughness_limiter/enabled";
    let out = bake(&fixtures().join("brushed/brushed.gltf"), baked.path(), &["--engine", "godot"]).out;
    assert_eq!(out.matches(note).count(), 1, "{out}");
    let options = ["--engine", "godot", "--model", "auto", "--json"];
    let document = fixtures().join("brushed/brushed.gltf");
    let report: Value = serde_json::from_str(&bake(&document, baked.path(), &options).out).expect("a report");
    assert_eq!(report["notes"].as_array().map(Vec::len), Some(1), "{}", report["notes"]);
    assert_eq!(report["notes"][0]["kind"], "engineLimiter");
    // Godot reads no anisotropy, so that `auto` compares the other models only.
    let candidates = report["assets"][0]["layers"][0]["choice"]["candidates"].as_array().expect("candidates");
    assert!(candidates.iter().all(|candidate| candidate["model"] != "anisotropic"), "{candidates:?}");
    assert!(candidates.iter().any(|candidate| candidate["model"] == "isotropic"), "{candidates:?}");
}

#[test]
fn a_run_with_anisotropic_lobes_asks_for_the_engine_unless_it_knows_the_lobes() {
    let baked = tempdir().expect("a folder");
    let (document, note) = (fixtures().join("brushed/brushed.gltf"), "name your engine by `--engine`");
    let printed = |options: &[&str]| bake(&document, baked.path(), options).out.matches(note).count();
    assert_eq!(printed(&[]), 1);
    assert_eq!(printed(&["--profile", "both"]), 1);
    for options in [
        ["--engine", "three"],
        ["--max-model", "isotropic"],
        ["--max-model", "anisotropic"],
        ["--model", "anisotropic"],
        ["--profile", "pyramid"],
    ] {
        assert_eq!(printed(&options), 0, "{options:?}");
    }
    let report: Value = serde_json::from_str(&bake(&document, baked.path(), &["--json"]).out).expect("a report");
    assert_eq!(report["notes"][0]["kind"], "unnamedEngine");
}

#[test]
fn a_glb_for_godot_has_a_note_on_its_mips() {
    let baked = tempdir().expect("a folder");
    let (document, note) = (fixtures().join("brushed/brushed.gltf"), "Godot drops the mips of images inside a .glb");
    for (options, count) in [(&["--glb"][..], 1), (&[], 0), (&["--glb", "--profile", "pyramid"], 0)] {
        let out = bake(&document, baked.path(), &[&["--engine", "godot"], options].concat()).out;
        assert_eq!(out.matches(note).count(), count, "{out}");
    }
    let named = baked.path().join("named.glb");
    assert!(bake(&document, &named, &["--engine", "godot"]).out.contains(note));
}
