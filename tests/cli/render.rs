//! Tests what `roughcast render` writes, and that the bake is closer to the reference than plain mips are.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::tempdir;

use super::process::{Run, copy, files, fixtures, hashes, roughcast};

/// Small pictures, which render quickly.
const QUICK: [&str; 4] = ["--width", "40", "--samples", "64"];
/// Large enough that distant waves are finer than pixels.
const LARGER: [&str; 4] = ["--width", "96", "--samples", "96"];

fn render(arguments: &[&str], output: &Path) -> Run {
    let output = output.to_str().expect("a path in UTF-8");
    let run = roughcast([&["render", "-o", output], arguments].concat());
    assert_eq!((run.code, run.err.as_str()), (0, ""), "render {arguments:?}");
    run
}

/// Returns the relative L1 errors of each row of the first sheet, with the name of the column.
fn errors(arguments: &[&str]) -> Vec<Vec<(String, f64)>> {
    let folder = tempdir().expect("a folder");
    let run = render(&[arguments, &LARGER, &["--json"]].concat(), folder.path());
    let report: Value = serde_json::from_str(&run.out).expect("JSON");
    let rows = report.pointer("/sheets/0/rows").and_then(Value::as_array).expect("rows").clone();
    let row = |row: &Value| {
        let columns = row["columns"].as_array().expect("columns");
        columns
            .iter()
            .map(|c| (c["name"].as_str().expect("a name").to_owned(), c["relativeL1"].as_f64().expect("L1")))
            .collect()
    };
    rows.iter().map(row).collect()
}

#[test]
fn baked_mips_are_closer_to_the_reference_than_plain_ones() {
    for (scene, distance) in [("lake", "0.7"), ("pattern", "2"), ("plane", "4"), ("sphere", "4")] {
        for row in errors(&["--scene", scene, "--distance", distance]) {
            println!("{scene} {row:?}");
            let of = |name: &str| row.iter().find(|(n, _)| n == name).expect("a column").1;
            assert!(of("portable") < 0.85 * of("plain"), "{scene}: {row:?}");
            assert!(of("pyramid") < 0.85 * of("plain"), "{scene}: {row:?}");
        }
    }
}

#[test]
fn columns_are_equal_for_a_map_without_bumps() {
    let folder = tempdir().expect("a folder");
    let flat = folder.path().join("flat.png");
    let image = image::RgbImage::from_pixel(16, 16, image::Rgb([140, 120, 253]));
    image.save(&flat).expect("a PNG");
    let flat = flat.to_str().expect("a path in UTF-8");
    for row in errors(&[flat, "--scene", "sphere", "--distance", "4", "--roughness", "0.3"]) {
        assert_eq!(row.len(), 3);
        for (name, error) in &row {
            assert!(*error < 0.12, "{name}: {error}");
            assert!((error - row[0].1).abs() < 0.01, "{row:?}");
        }
    }
}

#[test]
fn every_material_scene_and_distance_is_written() {
    let folder = tempdir().expect("a folder");
    let knobs = fixtures().join("knobs/knobs.gltf");
    let input = knobs.to_str().expect("a path in UTF-8");
    let options = ["--scene", "sphere,highlight", "--distance", "1,3", "--exr", "--profile", "portable"];
    let run = render(&[&[input], options.as_slice(), &QUICK].concat(), folder.path());
    let names: Vec<String> = files(folder.path()).into_iter().map(|(name, _)| name).collect();
    assert!(names.contains(&"highlight.png".to_owned()));
    let sheets: Vec<&String> = names.iter().filter(|name| name.ends_with(".sphere.png")).collect();
    assert!(sheets.len() > 1, "{names:?}");
    for sheet in sheets {
        assert!(run.out.contains(sheet.as_str()));
        let stem = sheet.trim_end_matches(".png");
        for distance in ["d1", "d3"] {
            for column in ["plain", "portable", "supersampled"] {
                for extension in ["png", "exr"] {
                    let name = format!("{stem}.{distance}.{column}.{extension}");
                    assert!(names.contains(&name), "{name} is not among {names:?}");
                }
            }
        }
    }
    assert!(!names.iter().any(|name| name.contains("pyramid")));
    let exr = names.iter().find(|name| name.ends_with("plain.exr")).expect("an EXR");
    let bytes = fs::read(folder.path().join(exr)).expect("a file");
    let decoded = roughcast::decode::decode(&bytes, &roughcast::image::DecodeOptions::default()).expect("an image");
    assert_eq!((decoded.width, decoded.height, decoded.channels), (40, 40, 3));
}

#[test]
fn alike_materials_have_the_same_pictures_on_sheets_of_their_own() {
    let folder = tempdir().expect("a folder");
    let (source, output) = (folder.path().join("source"), folder.path().join("output"));
    copy(&fixtures().join("knobs"), &source);
    let path = source.join("knobs.gltf");
    let mut document: Value = serde_json::from_slice(&fs::read(&path).expect("a file")).expect("JSON");
    let mut spare = document["materials"][0].clone();
    spare["name"] = "Spare".into();
    spare["pbrMetallicRoughness"]["baseColorFactor"] = serde_json::json!([0.2, 0.3, 0.4, 1]);
    document["materials"].as_array_mut().expect("materials").push(spare);
    fs::write(&path, document.to_string()).expect("a file can be written");
    let input = path.to_str().expect("a path in UTF-8");
    let run = render(&[&[input, "--scene", "sphere", "--json"], QUICK.as_slice()].concat(), &output);
    let report: Value = serde_json::from_str(&run.out).expect("JSON");
    let sheets = report["sheets"].as_array().expect("sheets");
    let names: Vec<&str> = sheets.iter().map(|sheet| sheet["material"].as_str().expect("a name")).collect();
    assert_eq!(names, ["knobs.Brass", "knobs.Rubber", "knobs.Label", "knobs.Spare"]);
    let picture = |name: &str, picture: &str| {
        fs::read(output.join(format!("{name}.sphere.d1.{picture}.png"))).expect("a picture")
    };
    for column in ["plain", "portable", "pyramid", "supersampled"] {
        assert_eq!(picture("knobs.Brass", column), picture("knobs.Spare", column));
        assert_ne!(picture("knobs.Brass", column), picture("knobs.Rubber", column));
    }
    let errors = |sheet: usize, row: usize| {
        let columns = sheets[sheet]["rows"][row]["columns"].as_array().expect("columns");
        columns.iter().map(|column| column["relativeL1"].as_f64().expect("L1")).collect::<Vec<_>>()
    };
    assert_eq!(errors(0, 0), errors(3, 0));
    assert_ne!(errors(0, 0), errors(0, 1));
    let sheet = |name: &str| fs::read(output.join(format!("{name}.sphere.png"))).expect("a sheet");
    assert_ne!(sheet("knobs.Brass"), sheet("knobs.Spare"), "titles differ");
}

#[test]
fn the_gallery_shows_every_picture_with_its_error() {
    let folder = tempdir().expect("a folder");
    let knobs = fixtures().join("knobs/knobs.gltf");
    let input = knobs.to_str().expect("a path in UTF-8");
    let options = ["--scene", "sphere,highlight", "--distance", "2", "--json"];
    let run = render(&[&[input], options.as_slice(), &QUICK].concat(), folder.path());
    let report: Value = serde_json::from_str(&run.out).expect("JSON");
    let path = report["gallery"].as_str().expect("a path");
    assert!(path.ends_with("index.html"), "{path}");
    let page = fs::read_to_string(path).expect("a page");
    assert!(!page.contains("<script") && !page.contains("http") && !page.contains("url("));
    let sources: Vec<&str> = page.split("src=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    for source in &sources {
        assert!(folder.path().join(source).is_file(), "{source}");
    }
    let sheets = report["sheets"].as_array().expect("sheets");
    assert!(sheets.len() > 2);
    for sheet in sheets {
        let title = sheet["title"].as_str().expect("a title");
        assert!(page.contains(&format!("<h2>{title}</h2>")), "{title}");
        for row in sheet["rows"].as_array().expect("rows") {
            for column in row["columns"].as_array().expect("columns") {
                let name = Path::new(column["path"].as_str().expect("a path")).file_name().expect("a name");
                assert!(sources.contains(&name.to_str().expect("UTF-8")), "{name:?}");
                let error = column["relativeL1"].as_f64().expect("an error");
                assert!(page.contains(&format!("error {error:.3}, lower is better")), "{error}");
            }
        }
    }
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let (one, three) = (tempdir().expect("a folder"), tempdir().expect("a folder"));
    let options = ["--scene", "lake,highlight", "--exr"];
    render(&[options.as_slice(), &QUICK, &["--threads", "1"]].concat(), one.path());
    render(&[options.as_slice(), &QUICK, &["--threads", "3"]].concat(), three.path());
    assert_eq!(hashes(one.path()), hashes(three.path()));
}

#[test]
fn bad_input_gives_one_clear_error() {
    let folder = tempdir().expect("a folder");
    copy(&fixtures().join("brushed"), folder.path());
    let at = |name: &str| folder.path().join(name).to_str().expect("a path in UTF-8").to_owned();
    let out = at("out");
    let complaint = |input: &str, output: &str| {
        let run = roughcast([&["render", input, "-o", output, "--scene", "sphere"], QUICK.as_slice()].concat());
        let line = run.err.trim_end();
        assert!(run.code == 1 && line.starts_with("error: ") && !line.contains('\n'), "{}: {line}", run.code);
        line.to_owned()
    };
    let document = fs::read_to_string(at("brushed.gltf")).expect("a document");
    fs::write(at("flat.gltf"), document.replace("normalTexture", "extras")).expect("a file");
    assert!(complaint(&at("flat.gltf"), &out).contains("found none"));
    fs::write(at("half.gltf"), &document[..document.len() / 2]).expect("a file");
    complaint(&at("half.gltf"), &out);
    let picture = fs::read(at("brushed_normal.png")).expect("a file");
    fs::write(at("half.png"), &picture[..picture.len() / 2]).expect("a file");
    assert!(complaint(&at("half.png"), &out).contains("cut off"));
    assert!(!Path::new(&out).exists());
    fs::write(at("highlight.png"), &picture).expect("a file");
    let run = roughcast(["render", &at("highlight.png"), "-o", &at(""), "--scene", "highlight"]);
    assert!(run.code == 1 && run.err.contains("is a source of this run"), "{}", run.err);
    assert!(fs::read(at("highlight.png")).expect("a file") == picture);
}
