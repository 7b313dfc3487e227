//! Tests that the four kinds of files of `roughcast compare` agree, are well formed and, apart from times, are
//! reproducible.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::tempdir;

use super::process::{Run, copy, files, fixtures, roughcast};

fn compare(input: &Path, output: &Path, options: &[&str]) -> Run {
    let paths = [input, output].map(|path| path.to_str().expect("a path in UTF-8"));
    let quick = ["--texels", "2", "--picture-width", "24"];
    let run = roughcast([&["compare", paths[0], "-o", paths[1]], quick.as_slice(), options].concat());
    assert_eq!((run.code, run.err.as_str()), (0, ""), "compare {options:?}");
    run
}

/// Fails unless every tag of `text` is closed in order and attributes contain no markup.
fn assert_well_formed(text: &str) {
    let text = text.strip_prefix("<!DOCTYPE html>").unwrap_or(text);
    let mut open: Vec<&str> = Vec::new();
    for part in text.split('<').skip(1) {
        let (tag, rest) = part.split_once('>').unwrap_or_else(|| panic!("a tag without an end: {part:.60}"));
        assert!(tag.matches('"').count() % 2 == 0, "an open attribute: {tag}");
        assert!(!rest.contains('>') || open.last() == Some(&"style") || tag == "style", "a bare >: {rest:.60}");
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap_or_default();
        match (tag.starts_with('/'), tag.ends_with('/')) {
            (true, _) => assert_eq!(open.pop(), Some(name), "in {part:.60}"),
            (false, false) => open.push(name),
            (false, true) => {}
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

/// Returns the report without times.
fn report(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("compare.json")).expect("a report");
    let mut report: Value = serde_json::from_str(&text).expect("JSON");
    for material in report["materials"].as_array_mut().expect("materials") {
        for entry in material["entries"].as_array_mut().expect("entries") {
            entry["bakeSeconds"] = Value::Null;
        }
    }
    report
}

#[test]
fn a_standalone_map_is_charted() {
    let folder = tempdir().expect("a folder");
    let input = fixtures().join("maps/line_normal.png");
    let run = compare(&input, folder.path(), &["--roughness", "0.3"]);
    let names: Vec<String> = files(folder.path()).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["compare-line_normal.svg", "compare.csv", "compare.html", "compare.json"]);
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("a file");
    assert_well_formed(&read("compare-line_normal.svg"));
    let page = read("compare.html");
    assert_well_formed(&page);
    assert!(!page.contains("src=") && !page.contains("href") && !page.contains("url("));
    let report = report(folder.path());
    let entries = report["materials"][0]["entries"].as_array().expect("entries");
    let csv = read("compare.csv");
    let rows: Vec<&str> = csv.lines().skip(1).collect();
    assert_eq!(rows.len(), entries.len());
    for (row, entry) in rows.iter().zip(entries) {
        let name = entry["name"].as_str().expect("a name");
        assert!(row.contains(name) && run.out.contains(name) && page.contains(name), "{name}");
        let error = format!(",{:.6},", entry["error"].as_f64().expect("an error"));
        assert!(row.contains(&error), "{row}: {error}");
    }
    assert_eq!(entries.iter().filter(|e| e["chosen"] == true).count(), 1);
    let error = |name: &str| {
        let entry = entries.iter().find(|e| e["name"] == name).expect("an entry");
        entry["error"].as_f64().expect("an error")
    };
    assert!(entries.iter().all(|e| e["error"].as_f64() >= Some(error("oracle"))));
    assert!(error("ours, anisotropic, best") < error("plain mips"));
    // Pictures of all but the best lobe are judged, and each output has their errors.
    let noise = report["materials"][0]["pictureNoise"].as_f64().expect("a noise");
    assert!(page.contains(&format!("a picture error of {noise:.3}")) && noise < 0.1, "{noise}");
    let picture = |name: &str| {
        let entry = entries.iter().find(|e| e["name"] == name).expect("an entry");
        entry["pictureError"].as_f64().expect("an error")
    };
    for (row, entry) in rows.iter().zip(entries).filter(|(_, entry)| entry["kind"] != "oracle") {
        let error = picture(entry["name"].as_str().expect("a name"));
        assert!(row.contains(&format!(",{error:.6},")), "{row}: {error}");
        assert!(run.out.contains(&format!("picture {error:.3}")) && error > 0.0, "{error}");
    }
    let oracle = entries.iter().find(|e| e["kind"] == "oracle").expect("the oracle");
    assert_eq!(oracle["pictureError"], Value::Null);
    // Plain mips of ours and the formula of plain mips are one material, drawn in two ways.
    let [ours, formula] = ["ours, none, fast", "plain mips"].map(picture);
    assert!((ours - formula).abs() < 0.02, "{ours} {formula}");
    assert!(picture("ours, anisotropic, best") < formula);
}

#[test]
fn several_inputs_share_one_page_that_begins_with_their_verdicts() {
    let folder = tempdir().expect("a folder");
    let inputs = ["maps/line_normal.png", "brushed/brushed.gltf"].map(|name| fixtures().join(name));
    let [map, asset] = inputs.each_ref().map(|path| path.to_str().expect("a path in UTF-8"));
    let output = folder.path().to_str().expect("a path in UTF-8");
    let run = roughcast(["compare", map, asset, "-o", output, "--texels", "2", "--picture-width", "0"]);
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    let report = report(folder.path());
    let materials = report["materials"].as_array().expect("materials");
    let page = fs::read_to_string(folder.path().join("compare.html")).expect("a page");
    for (material, name) in materials.iter().zip(["line_normal.png: line_normal", "brushed.gltf: Brushed steel"]) {
        assert_eq!(material["material"], name);
        let verdict = material["verdict"].as_str().expect("a verdict");
        assert!(page.contains(&format!("<li><b>{name}</b>: {verdict}</li>")) && run.out.contains(verdict), "{verdict}");
    }
    let run = roughcast(["compare", map, "missing.png", "-o", output]);
    assert!(run.code == 1 && run.err.starts_with("error: missing.png: "), "{}", run.err);
}

#[test]
fn pictures_can_be_left_out() {
    let folder = tempdir().expect("a folder");
    let input = fixtures().join("maps/line_normal.png");
    let [input, output] = [input.as_path(), folder.path()].map(|path| path.to_str().expect("a path in UTF-8"));
    let run = roughcast(["compare", input, "-o", output, "--texels", "2", "--picture-width", "0"]);
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    let report = report(folder.path());
    assert_eq!(report["materials"][0]["pictureNoise"], Value::Null);
    assert_eq!(report["materials"][0]["entries"][0]["pictureError"], Value::Null);
    let page = fs::read_to_string(folder.path().join("compare.html")).expect("a page");
    assert!(!page.contains("picture error against") && !run.out.contains("picture"));
    for width in ["7", "513", "-1", "x"] {
        assert_eq!(roughcast(["compare", input, "-o", "out", "--picture-width", width]).code, 2, "{width}");
    }
}

#[test]
fn the_numbers_do_not_depend_on_threads() {
    let (one, two) = (tempdir().expect("a folder"), tempdir().expect("a folder"));
    let input = fixtures().join("brushed/brushed.gltf");
    compare(&input, one.path(), &["--threads", "1"]);
    compare(&input, two.path(), &["--threads", "2"]);
    assert_eq!(report(one.path()), report(two.path()));
    for (name, path) in files(one.path()).iter().filter(|(name, _)| name.ends_with(".svg")) {
        assert!(fs::read(path).expect("a file") == fs::read(two.path().join(name)).expect("a file"), "{name}");
    }
}

#[test]
fn hostile_names_are_escaped() {
    let folder = tempdir().expect("a folder");
    copy(&fixtures().join("brushed"), folder.path());
    let path = folder.path().join("brushed.gltf");
    let mut document: Value = serde_json::from_slice(&fs::read(&path).expect("a file")).expect("JSON");
    for material in document["materials"].as_array_mut().expect("materials") {
        material["name"] = "../</title><script>alert(\"1\")</script>&,\n".into();
    }
    fs::write(&path, document.to_string()).expect("a file");
    let output = folder.path().join("out");
    compare(&path, &output, &["--quiet"]);
    for (name, path) in files(&output) {
        let text = fs::read_to_string(path).expect("a file");
        if !name.ends_with(".json") && !name.ends_with(".csv") {
            assert!(!text.contains("<script"), "{name}");
            assert_well_formed(&text);
        }
        assert!(name.starts_with("compare") && !name.contains('/'), "{name}");
    }
    let csv = fs::read_to_string(output.join("compare.csv")).expect("a file");
    assert!(csv.contains("\"../</title><script>alert(\"\"1\"\")</script>&,\n\","), "{csv}");
}

#[test]
fn bad_input_gives_one_clear_error() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("out");
    let out = out.to_str().expect("a path in UTF-8");
    let brushed = fixtures().join("brushed/brushed.bin");
    for input in ["missing.png", brushed.to_str().expect("a path in UTF-8")] {
        let run = roughcast(["compare", input, "-o", out]);
        assert!(run.code == 1 && run.err.starts_with("error: ") && run.err.lines().count() == 1, "{}", run.err);
    }
    assert_eq!(roughcast(["compare", "missing.png"]).code, 2);
    assert_eq!(roughcast(["compare", "missing.png", "-o", out, "--texels", "0"]).code, 2);
    assert!(!Path::new(out).exists());
}

/// A flat surface has the same lobe in all textures: its picture error is the noise, and what the renderer's filter of
/// the surroundings adds. The approximate filters add 0.2 at this roughness.
#[test]
fn picture_errors_do_not_measure_the_filter_of_the_surroundings() {
    let folder = tempdir().expect("a folder");
    let flat = ["--height", "--height-scale", "0", "--roughness", "0.8"];
    compare(&fixtures().join("maps/dunes_height.exr"), folder.path(), &flat);
    let report = report(folder.path());
    let entries = report["materials"][0]["entries"].as_array().expect("entries");
    let errors: Vec<f64> = entries.iter().filter_map(|entry| entry["pictureError"].as_f64()).collect();
    assert!(errors.len() > 10 && errors.iter().all(|error| *error < 0.06), "{errors:?}");
}
