//! Tests of `bake --nearest`, which reports the levels that can be sampled, and of `--trim`, which drops all finer
//! levels.

use std::fs;
use std::path::{Path, PathBuf};

use roughcast::cli::Outcome;
use roughcast::ktx2::Ktx2;
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::fixture::{findings, roughcast, write_asset};
use crate::schemas::{assert_valid, schema};

/// Writes the triangle of the other tests into a scene, and applies `edit` to the document. The triangle's legs are one
/// unit long, which is one repeat of a map of 16 x 16 texels.
fn asset(edit: impl Fn(&mut Value)) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source");
    write_asset(&source);
    let path = source.join("ridges.gltf");
    let mut document: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    document["scenes"] = json!([{ "nodes": [0] }]);
    document["nodes"] = json!([{ "mesh": 0 }]);
    edit(&mut document);
    fs::write(&path, serde_json::to_vec(&document).unwrap()).unwrap();
    (folder, source)
}

/// Returns options under which a pixel covers `pixel` units: 2 d / 1000 / 2 at 90 degrees and an aspect of almost 0.
fn view(pixel: f64) -> Vec<String> {
    let distance = (1000.0 * pixel).to_string();
    let options = ["--nearest", &distance, "--screen-height", "1000", "--fov", "90", "--aspect", "1e-9"];
    options.map(str::to_owned).to_vec()
}

/// Bakes the asset at `source` into the sibling folder `name`. Returns that folder and the report.
fn bake(source: &Path, name: &str, options: &[String]) -> (PathBuf, Value) {
    let baked = source.with_file_name(name);
    let paths = ["bake", source.to_str().unwrap(), "-o", baked.to_str().unwrap(), "--json"];
    let options: Vec<&str> = paths.into_iter().chain(options.iter().map(String::as_str)).collect();
    let (outcome, out, err) = roughcast(&options);
    assert_eq!(outcome, Outcome::Done, "{options:?}: {err}");
    let report: Value = serde_json::from_str(&out).unwrap();
    assert_valid(&schema("report"), &report);
    (baked, report["assets"][0].clone())
}

fn trimmed(pixel: f64) -> Vec<String> {
    [view(pixel), vec!["--trim".to_owned()]].concat()
}

/// Returns (width, levels, trimmed) of each texture.
fn sizes(report: &Value) -> Vec<[u64; 3]> {
    let number = |t: &Value, key: &str| t.get(key).map_or(0, |n| n.as_u64().unwrap());
    let textures = report["textures"].as_array().unwrap();
    textures.iter().map(|t| ["width", "levels", "trimmed"].map(|key| number(t, key))).collect()
}

#[test]
fn reports_the_finest_level_without_changing_textures() {
    let (_folder, source) = asset(|_| {});
    for (pixel, level) in [(0.01, 0), (1.0 / 16.0, 0), (2.02 / 16.0, 1), (4.02 / 16.0, 2), (1000.0, 4)] {
        let (_, report) = bake(&source, "baked", &view(pixel));
        let finest = &report["layers"][0]["finest"];
        assert_eq!(finest["level"], level, "{pixel}: {report}");
        assert_eq!(finest["unitsPerTexel"], 1.0 / 16.0);
        assert!((finest["unitsPerPixel"].as_f64().unwrap() / pixel - 1.0).abs() < 1e-9, "{report}");
        assert_eq!(sizes(&report), [[16, 5, 0]; 3]);
    }
    assert_eq!(bake(&source, "baked", &[]).1["layers"][0].get("finest"), None);
}

#[test]
fn trimmed_textures_have_the_coarser_levels_of_whole_textures() {
    let (_folder, source) = asset(|_| {});
    for profile in ["portable", "both"] {
        for target in ["basis", "float"] {
            let with = |view: Vec<String>| {
                let options =
                    ["--profile", profile, "--target", target, "--model", "anisotropic", "--gltf", "fallback"];
                [view, options.map(str::to_owned).to_vec()].concat()
            };
            let (whole, _) = bake(&source, "whole", &with(vec![]));
            let (baked, report) = bake(&source, "baked", &with(trimmed(2.5 / 16.0)));
            assert!(sizes(&report).iter().all(|s| *s == [8, 4, 1]), "{report}");
            for texture in report["textures"].as_array().unwrap() {
                let path = texture["path"].as_str().unwrap();
                let level = |folder: &Path, level| {
                    let bytes = fs::read(folder.join(path)).unwrap();
                    Ktx2::parse(&bytes).unwrap().decode_level(level).unwrap()
                };
                // Ranges and scales of the pyramid profile depend on the written levels, so its texels differ.
                if texture.get("range").is_none() && texture.get("scale").is_none() {
                    assert_eq!(level(&baked, 0).samples, level(&whole, 1).samples, "{path}");
                    assert_eq!(level(&baked, 3).samples, level(&whole, 4).samples, "{path}");
                }
                let png = fs::read(baked.join(path).with_extension("png")).unwrap();
                assert_eq!(image::load_from_memory(&png).unwrap().width(), 8, "{path}");
            }
            let (checked, source) = (baked.to_str().unwrap(), source.to_str().unwrap());
            let (_, out, _) = roughcast(&["check", checked, "--source", source, "--format", "json"]);
            let found = findings(&serde_json::from_str(&out).unwrap());
            assert!(found.iter().all(|(code, ..)| target == "float" && code == "RC1101"), "{out}");
        }
    }
}

/// KHR_texture_basisu requires multiples of 4; half floats do not.
#[test]
fn trimming_stops_at_the_smallest_size_that_the_format_allows() {
    let (_folder, source) = asset(|_| {});
    assert_eq!(sizes(&bake(&source, "baked", &trimmed(1000.0)).1), [[4, 3, 2]; 3]);
    let float = [trimmed(1000.0), vec!["--target".into(), "float".into()]].concat();
    assert_eq!(sizes(&bake(&source, "baked", &float).1), [[1, 1, 4]; 3]);
}

#[test]
fn a_scaled_node_needs_a_finer_level() {
    let (_folder, source) = asset(|document| document["nodes"][0]["scale"] = json!([2, 2, 2]));
    let (_, report) = bake(&source, "baked", &trimmed(4.02 / 16.0));
    assert_eq!(report["layers"][0]["finest"]["level"], 1);
    assert_eq!(sizes(&report), [[8, 4, 1]; 3]);
}

/// Materials on a small mesh and on a mesh twice as large share their textures, which keep the levels of the larger
/// mesh.
#[test]
fn a_shared_texture_keeps_the_levels_of_all_its_materials() {
    let (_folder, source) = asset(|document| {
        for array in ["meshes", "materials"] {
            let first = document[array][0].clone();
            document[array].as_array_mut().unwrap().push(first);
        }
        document["meshes"][1]["primitives"][0]["material"] = json!(1);
        document["nodes"] = json!([{ "mesh": 0 }, { "mesh": 1, "scale": [2, 2, 2] }]);
        document["scenes"] = json!([{ "nodes": [0, 1] }]);
    });
    let (_, report) = bake(&source, "baked", &trimmed(4.02 / 16.0));
    let levels: Vec<_> = report["layers"].as_array().unwrap().iter().map(|l| &l["finest"]["level"]).collect();
    assert_eq!(levels, [2, 1]);
    assert_eq!(sizes(&report), [[8, 4, 1]; 3]);
}

#[test]
fn trims_nothing_if_the_scene_does_not_show_the_size() {
    type Edit = fn(&mut Value);
    let cases: [(&str, Edit); 5] = [
        ("is in no scene", |d| d["scenes"] = json!([])),
        ("no triangle of the document shows", |d| d["meshes"] = json!([])),
        ("a skin moves its vertices", |d| d["nodes"][0]["skin"] = json!(0)),
        ("cannot be read", |d| d["accessors"][0]["count"] = json!(1u64 << 40)),
        ("an animation changes its scale", |d| {
            d["animations"] = json!([{ "channels": [{ "sampler": 0, "target": { "node": 0, "path": "scale" } }] }]);
        }),
    ];
    for (reason, edit) in cases {
        let (_folder, source) = asset(edit);
        let (_, report) = bake(&source, "baked", &trimmed(1000.0));
        let layer = &report["layers"][0];
        assert_eq!((layer.get("finest"), sizes(&report)), (None, vec![[16, 5, 0]; 3]), "{reason}");
        let notes = layer["notes"].as_array().unwrap();
        let note = notes.iter().find(|note| note["kind"] == "unknownTexelSize").and_then(|note| note["text"].as_str());
        assert!(note.is_some_and(|text| text.contains(reason)), "{reason}: {notes:?}");
    }
}
