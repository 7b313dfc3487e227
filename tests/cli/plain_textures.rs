//! Tests `--textures all`, `--max-size` and `--diffuse-light` on the command line. Tests of what is baked are those of
//! the library.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use super::process::{copy, done, files, fixtures, run};

/// Columns and rows of all images: no powers of two.
const SIZE: (u32, u32) = (24, 20);

fn json_of(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

fn write_image<P: image::PixelWithColorType<Subpixel = u8>>(path: &Path, texel: impl Fn(u32, u32) -> P) {
    image::ImageBuffer::from_fn(SIZE.0, SIZE.1, texel).save(path).expect("a picture");
}

/// Writes a material of leaves with bumps, and one without, to `leaves/leaves.gltf`. Base colour and emissive share an
/// image; occlusion shares one with the metalness of the second material only.
fn scene() -> TempDir {
    let folder = tempdir().expect("a folder");
    let leaves = folder.path().join("leaves");
    fs::create_dir(&leaves).expect("a folder");
    write_image(&leaves.join("leaf.png"), |x, y| {
        // No row or column lies at the cutoff.
        let alpha = 127.5 + 127.5 * (0.4 * f64::from(x) + 0.2).sin() * (0.3 * f64::from(y)).cos();
        image::Rgba([(9 * x) as u8, 200, (12 * y) as u8, alpha as u8])
    });
    write_image(&leaves.join("occlusion.png"), |x, y| image::Luma([(255 - 5 * x - 4 * y) as u8]));
    write_image(&leaves.join("surface.png"), |x, y| image::Rgb([250, (60 + 7 * y) as u8, (10 * x) as u8]));
    write_image(&leaves.join("normal.png"), |x, y| image::Rgb([(118 + 20 * (x % 2)) as u8, (98 + 3 * y) as u8, 240]));
    let document = json!({
        "asset": { "version": "2.0" },
        "images": [
            { "uri": "leaf.png" }, { "uri": "occlusion.png" }, { "uri": "surface.png" }, { "uri": "normal.png" },
        ],
        "textures": [{ "source": 0 }, { "source": 1 }, { "source": 2 }, { "source": 3 }],
        "materials": [
            {
                "name": "Leaves",
                "alphaMode": "MASK",
                "normalTexture": { "index": 3 },
                "occlusionTexture": { "index": 1 },
                "emissiveTexture": { "index": 0 },
                "pbrMetallicRoughness": {
                    "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 2 },
                },
            },
            {
                "name": "Flat",
                "occlusionTexture": { "index": 2 },
                "pbrMetallicRoughness": {
                    "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 2 },
                },
            },
        ],
    });
    fs::write(leaves.join("leaves.gltf"), document.to_string()).expect("a document");
    folder
}

/// Bakes the leaves with `options` to an empty folder.
fn bake(folder: &Path, options: &str) {
    if folder.join("out").exists() {
        fs::remove_dir_all(folder.join("out")).expect("the outputs of an earlier bake");
    }
    done(folder, &format!("bake leaves -o out -q {options}"));
}

#[test]
fn check_finds_nothing_in_textures_of_all_forms_and_sizes() {
    let scene = scene();
    let folder = scene.path();
    for form in ["strict", "fallback"] {
        bake(folder, &format!("--textures all --gltf {form}"));
        let has_png = files(&folder.join("out")).iter().any(|(name, _)| name.ends_with(".png"));
        assert_eq!(has_png, form == "fallback");
        done(folder, "check out --source leaves --deep --allow RC1510");
    }
    for size in [64, 24, 23, 11, 4] {
        bake(folder, &format!("--textures all --max-size {size}"));
        done(folder, "check out --source leaves --deep --allow RC1510");
    }
    let recorded = json_of(&done(folder, "inspect out/leaves.roughcast/leaf.colour.ktx2 --json")).to_string();
    assert!(recorded.contains("\"maxSize\":4") && recorded.contains("\"textures\":\"all\""), "{recorded}");
    let map = "map leaves/normal.png -o out/normal.ktx2 --max-size 12 --json";
    assert_eq!(json_of(&done(folder, map))["textures"][0]["width"], 12);
}

#[test]
fn check_knows_both_settings() {
    let scene = scene();
    let folder = scene.path();
    bake(folder, "--textures all --max-size 16");
    let found = run(folder, "check out --source leaves --textures all --max-size 16 --allow RC1510");
    assert_eq!(found.code, 0, "{}", found.out);
    let found = run(folder, "check out --source leaves --textures bumps --max-size 8");
    assert_eq!(found.code, 3, "{}", found.out);
    assert!(found.out.contains("max-size = 8") && found.out.contains("textures unset"), "{}", found.out);
}

#[test]
fn check_knows_base_colours_for_suns() {
    let scene = scene();
    let folder = scene.path();
    bake(folder, "--textures all --diffuse-light suns --gltf strict --report report.json");
    done(folder, "check out --source leaves --deep --allow RC1510");
    done(folder, "check out --source leaves --textures all --gltf strict --diffuse-light suns --allow RC1510");
    let found = run(folder, "check out --source leaves --textures all --gltf strict --diffuse-light environment");
    assert_eq!(found.code, 3, "{}", found.out);
    assert!(found.out.contains("diffuse-light unset"), "{}", found.out);
    let report = json_of(&fs::read_to_string(folder.join("report.json")).expect("a report"));
    assert_eq!(report["settings"]["diffuseLight"], "suns");
    let textures = report["assets"][0]["textures"].as_array().expect("textures");
    let darkened: Vec<_> = textures.iter().filter(|texture| texture["diffuseLight"] == "suns").collect();
    // The flat material and the emissive share the image of the leaves, and are not darkened.
    assert_eq!(darkened.len(), 1, "{textures:#?}");
    let path = darkened[0]["path"].as_str().expect("a path");
    let recorded = json_of(&done(folder, &format!("inspect out/{path} --json"))).to_string();
    for part in ["\"diffuseLight\":\"suns\"", "normal.png", "surface.png"] {
        assert!(recorded.contains(part), "{recorded}");
    }
}

#[test]
fn settings_that_cannot_be_are_refused() {
    let scene = scene();
    for (options, message) in [
        ("--textures all --target float", "expected --target basis for --textures all"),
        ("--diffuse-light suns", "expected --textures all for --diffuse-light suns"),
        ("--diffuse-light suns --textures all --target bc", "expected --target basis for --textures all"),
        ("--max-size 3", "expected a number of texels from 4"),
        ("--max-size x", "expected a number of texels, found \"x\""),
    ] {
        let found = run(scene.path(), &format!("bake leaves -o out {options}"));
        assert_eq!(found.code, 2, "{options}: {}", found.err);
        assert!(found.err.contains(message), "{options}: {}", found.err);
    }
}

#[test]
fn a_glb_has_no_image_besides_ktx2() {
    let folder = tempdir().expect("a folder");
    copy(&fixtures().join("waves"), &folder.path().join("waves"));
    let report = json_of(&done(folder.path(), "bake waves -o out --textures all --rdo 0.5 --json"));
    let sizes = &report["assets"][0]["sizes"];
    assert_eq!((sizes["images"].as_u64(), sizes["fallback"].as_u64()), (Some(0), Some(0)));
    done(folder.path(), "check out --source waves --deep --allow RC1510");
}
