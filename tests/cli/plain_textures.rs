//! Tests `--textures all` and `--max-size` from images to files that another decoder reads.

use std::fs;
use std::path::Path;

use roughcast::ktx2::Ktx2;
use roughcast::mip::{TexelRows, level_sizes};
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

/// Bakes the leaves with `options` to an empty folder. Returns content and size of each texture.
fn textures(folder: &Path, options: &str) -> Vec<(String, u64, u64)> {
    if folder.join("out").exists() {
        fs::remove_dir_all(folder.join("out")).expect("the outputs of an earlier bake");
    }
    let report = json_of(&done(folder, &format!("bake leaves -o out --json {options}")));
    let textures = report["assets"][0]["textures"].as_array().expect("textures");
    let number = |texture: &Value, name: &str| texture[name].as_u64().expect("a number");
    let of = |t: &Value| (t["content"].as_str().expect("text").to_owned(), number(t, "width"), number(t, "height"));
    textures.iter().map(of).collect()
}

fn document(folder: &Path) -> Value {
    json_of(&fs::read_to_string(folder.join("out/leaves.gltf")).expect("a document"))
}

/// Returns the bytes of the KTX2 to which the `textureInfo` at `pointer` leads.
fn ktx2(folder: &Path, pointer: &str) -> Vec<u8> {
    let root = document(folder);
    let texture = root.pointer(pointer).expect("a texture")["index"].as_u64().expect("an index") as usize;
    let image = root["textures"][texture]["extensions"]["KHR_texture_basisu"]["source"].as_u64().expect("an image");
    let uri = root["images"][image as usize]["uri"].as_str().expect("a file");
    fs::read(folder.join("out").join(uri)).expect("a texture")
}

const BASE_COLOUR: &str = "/materials/0/pbrMetallicRoughness/baseColorTexture";

#[test]
fn every_image_is_written_once_for_each_meaning() {
    let scene = scene();
    let folder = scene.path();
    let contents = |options: &str| {
        let mut found: Vec<String> = textures(folder, options).into_iter().map(|(content, ..)| content).collect();
        found.sort();
        found
    };
    assert_eq!(contents("--model isotropic"), ["normal", "roughness"]);
    // Colours with a mask, opaque colours for emissive and for the flat material, occlusion, and the flat surface.
    let all = "--model isotropic --textures all --gltf strict";
    assert_eq!(contents(all), ["colour", "colour", "linear", "linear", "normal", "roughness"]);
    let root = document(folder);
    assert!(root["textures"].as_array().expect("textures").iter().all(|texture| texture.get("source").is_none()));
    let index = |pointer: &str| root.pointer(pointer).expect("a texture")["index"].clone();
    let [emissive, flat] = ["/materials/0/emissiveTexture", "/materials/1/pbrMetallicRoughness/baseColorTexture"];
    assert_eq!(index(emissive), index(flat));
    assert_ne!(index(emissive), index(BASE_COLOUR));
    let surface = index("/materials/1/pbrMetallicRoughness/metallicRoughnessTexture");
    assert_eq!(surface, index("/materials/1/occlusionTexture"));
    let pngs = files(&folder.join("out")).into_iter().filter(|(name, _)| name.ends_with(".png")).count();
    assert_eq!(pngs, 0);
    done(folder, "check out --source leaves --deep --allow RC1510");
}

#[test]
fn colours_are_srgb_and_masks_keep_their_coverage_in_the_files() {
    let scene = scene();
    let folder = scene.path();
    textures(folder, "--textures all --gltf strict --quality best");
    let bytes = ktx2(folder, BASE_COLOUR);
    let file = Ktx2::parse(&bytes).expect("a KTX2");
    let basic = file.descriptor().expect("a descriptor");
    assert_eq!(basic.transfer_function, Some(ktx2::TransferFunction::SRGB));
    assert_eq!(basic.color_primaries, Some(ktx2::ColorPrimaries::BT709));
    assert_eq!(basic.sample_information[0].channel_type, 3);
    assert_eq!(file.level_count() as usize, level_sizes(SIZE.0, SIZE.1).len());
    let share = |level: u32| {
        let image = file.decode_level(level).expect("a level");
        let mut row = vec![[0.0; 4]; image.width as usize];
        let mut passing = 0;
        for y in 0..image.height {
            roughcast::image::Rgba(&image).row(y, &mut row);
            passing += row.iter().filter(|texel| texel[3] >= 0.5).count();
        }
        passing as f64 / f64::from(image.width * image.height)
    };
    let source = image::open(folder.join("leaves/leaf.png")).expect("a picture").to_rgba8();
    let wanted = source.pixels().filter(|texel| texel.0[3] >= 128).count() as f64 / f64::from(SIZE.0 * SIZE.1);
    assert!((share(0) - wanted).abs() < 0.02, "{} of {wanted}", share(0));
    // Level 1 has 120 texels, and level 2 has 30. The encoding may move a few of them across the cutoff.
    for (level, tolerance) in [(1, 0.05), (2, 0.1)] {
        assert!((share(level) - wanted).abs() <= tolerance, "level {level}: {} of {wanted}", share(level));
    }
    let linear = ktx2(folder, "/materials/0/occlusionTexture");
    let linear = Ktx2::parse(&linear).expect("a KTX2");
    assert_eq!(linear.descriptor().expect("a descriptor").transfer_function, Some(ktx2::TransferFunction::Linear));
}

#[test]
fn fallbacks_have_the_alpha_of_their_texture() {
    let scene = scene();
    let folder = scene.path();
    textures(folder, "--textures all --gltf fallback");
    let root = document(folder);
    let texture = root.pointer(BASE_COLOUR).expect("a texture")["index"].as_u64().expect("an index") as usize;
    let image = root["textures"][texture]["source"].as_u64().expect("an image") as usize;
    let path = folder.join("out").join(root["images"][image]["uri"].as_str().expect("a file"));
    let [found, source] = [path, folder.join("leaves/leaf.png")].map(|path| image::open(path).expect("a picture"));
    assert_eq!(found.to_rgba8(), source.to_rgba8());
    done(folder, "check out --source leaves --deep --allow RC1510");
}

#[test]
fn textures_fit_the_largest_size_in_whole_blocks() {
    let scene = scene();
    let folder = scene.path();
    for (size, expected) in [(64, (24, 20)), (24, (24, 20)), (23, (12, 12)), (11, (8, 8)), (4, (4, 4))] {
        let found = textures(folder, &format!("--textures all --max-size {size}"));
        for (content, width, height) in found {
            assert_eq!((width, height), expected, "{content} within {size}");
        }
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
    textures(folder, "--textures all --max-size 16");
    let found = run(folder, "check out --source leaves --textures all --max-size 16 --allow RC1510");
    assert_eq!(found.code, 0, "{}", found.out);
    let found = run(folder, "check out --source leaves --textures bumps --max-size 8");
    assert_eq!(found.code, 3, "{}", found.out);
    assert!(found.out.contains("max-size = 8") && found.out.contains("textures unset"), "{}", found.out);
}

#[test]
fn settings_that_cannot_be_are_refused() {
    let scene = scene();
    for (options, message) in [
        ("--textures all --target float", "expected --target basis for --textures all"),
        ("--max-size 3", "expected a number of texels from 4"),
        ("--max-size x", "expected a number of texels, found \"x\""),
    ] {
        let found = run(scene.path(), &format!("bake leaves -o out {options}"));
        assert_eq!(found.code, 2, "{options}: {}", found.err);
        assert!(found.err.contains(message), "{options}: {}", found.err);
    }
}

#[test]
fn ktx2_images_stay_and_documents_without_bumps_are_written() {
    let scene = scene();
    let folder = scene.path();
    textures(folder, "--textures all --gltf strict");
    // A document of the flat material alone, whose base colour is a KTX2 already.
    let flat = folder.join("flat");
    fs::create_dir(&flat).expect("a folder");
    fs::write(flat.join("done.ktx2"), ktx2(folder, "/materials/1/pbrMetallicRoughness/baseColorTexture"))
        .expect("a file");
    fs::copy(folder.join("leaves/surface.png"), flat.join("surface.png")).expect("a file");
    let document = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_texture_basisu"],
        "extensionsRequired": ["KHR_texture_basisu"],
        "images": [{ "uri": "done.ktx2" }, { "uri": "surface.png" }],
        "textures": [{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }, { "source": 1 }],
        "materials": [{
            "pbrMetallicRoughness": {
                "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 },
            },
        }],
    });
    fs::write(flat.join("flat.gltf"), document.to_string()).expect("a document");
    done(folder, "bake flat -o kept -q");
    assert_eq!(fs::read(folder.join("kept/flat.gltf")).ok(), fs::read(flat.join("flat.gltf")).ok());
    let report = json_of(&done(folder, "bake flat -o more --textures all --gltf strict --json"));
    let textures = report["assets"][0]["textures"].as_array().expect("textures");
    assert_eq!(textures.len(), 1);
    assert_eq!(textures[0]["content"], "linear");
    assert_eq!(fs::read(folder.join("more/done.ktx2")).ok(), fs::read(flat.join("done.ktx2")).ok());
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
