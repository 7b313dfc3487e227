//! The notes on sources for which the method cannot be exact (docs/stability.md). Notes on faults of kernels
//! are tested where the notes are made.

use std::fs;
use std::path::Path;

use serde_json::Value;
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
