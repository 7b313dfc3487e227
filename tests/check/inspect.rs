//! Tests of `inspect` and of the pictures that it extracts.

use std::fs;

use roughcast::cli::Outcome;
use serde_json::{Value, json};

use crate::fixture::{bake, roughcast, write_asset};

fn inspect(path: &std::path::Path, options: &[&str]) -> String {
    let (outcome, out, err) = roughcast(&[&["inspect", path.to_str().unwrap()], options].concat());
    assert_eq!((outcome, err.as_str()), (Outcome::Done, ""));
    out
}

#[test]
fn shows_levels_format_and_provenance_of_a_texture() {
    let bake = bake(&[]);
    let facts: Value = serde_json::from_str(&inspect(&bake.texture("bumps.normal.ktx2"), &["--json"])).unwrap();
    assert_eq!(facts["kind"], "ktx2");
    assert_eq!(facts["supercompression"], "zstd");
    assert_eq!(facts["descriptor"]["model"], "UASTC");
    let sizes: Vec<&Value> = facts["levels"].as_array().unwrap().iter().map(|l| &l["width"]).collect();
    assert_eq!(sizes, [16, 8, 4, 2, 1]);
    assert_eq!(facts["levels"][0]["uncompressedBytes"], 256);
    assert_eq!(facts["provenance"]["content"], "normal");
    let digest = blake3::hash(&fs::read(bake.source.join("bumps.png")).unwrap()).to_hex().to_string();
    assert_eq!(facts["provenance"]["sources"], json!([{ "uri": "bumps.png", "blake3": digest }]));
    let text = inspect(&bake.texture("bumps.normal.ktx2"), &[]);
    for part in ["16 x 16, UASTC", "transfer Linear", "KTXwriter: roughcast", "normal baked by version", &digest] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn shows_materials_and_ranges_of_a_document() {
    let bake = bake(&["--profile", "both", "--model", "anisotropic", "--gltf", "fallback"]);
    let facts: Value = serde_json::from_str(&inspect(&bake.document(), &["--json"])).unwrap();
    let material = &facts["materials"][0];
    assert_eq!(material["name"], "Ridges");
    let slots: Vec<&str> = material["slots"].as_array().unwrap().iter().map(|s| s["slot"].as_str().unwrap()).collect();
    for slot in ["normalTexture", "metallicRoughnessTexture", "anisotropyTexture", "offsetTexture", "roughnessTexture"]
    {
        assert!(slots.iter().any(|s| s.ends_with(slot)), "{slot}: {slots:?}");
    }
    assert_eq!(material["pyramid"]["roughnessModel"], "covarianceFactor");
    assert_eq!(material["errors"], json!([]));
    let images = &material["slots"][0]["images"];
    assert_eq!((&images[0]["picture"]["format"], &images[1]["ktx2"]["width"]), (&json!("PNG"), &json!(16)));
    let text = inspect(&bake.document(), &[]);
    assert!(text.contains("offsetScale: [") && text.contains("KHR_texture_basisu: ridges.roughcast/"), "{text}");
}

#[test]
fn shows_colours_of_a_document() {
    let folder = tempfile::tempdir().unwrap();
    let asset = folder.path().join("ridges.gltf");
    write_asset(folder.path());
    let mut document: Value = serde_json::from_slice(&fs::read(&asset).unwrap()).unwrap();
    document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 2 });
    document["textures"].as_array_mut().unwrap().push(json!({ "source": 2 }));
    document["images"].as_array_mut().unwrap().push(json!({ "uri": "colours.png" }));
    fs::copy(folder.path().join("surface.png"), folder.path().join("colours.png")).unwrap();
    fs::write(&asset, document.to_string()).unwrap();
    let baked = folder.path().join("baked.glb");
    let words = ["bake", asset.to_str().unwrap(), "-o", baked.to_str().unwrap(), "-q", "--textures", "all"];
    assert_eq!(roughcast(&words).0, Outcome::Done);
    let text = inspect(&baked, &[]);
    assert!(text.contains("baseColorTexture: textures[") && text.contains("colour, 16 x 16, UASTC sRGB"), "{text}");
}

#[test]
fn shows_errors_of_a_document() {
    let bake = bake(&["--profile", "pyramid"]);
    fs::remove_file(bake.texture("bumps.offset.ktx2")).unwrap();
    bake.edit(|d| {
        d["materials"][0]["extensions"]["ROUGHCAST_materials_roughness_pyramid"]["frame"] = json!("none");
        d["materials"][0]["normalTexture"]["index"] = json!(77);
    });
    let text = inspect(&bake.document(), &[]);
    for part in ["unknown variant `none`", "expected an index below", "error: expected a readable file"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn extracts_levels_as_png() {
    let bake = bake(&[]);
    let folder = bake.baked.join("levels");
    inspect(&bake.texture("bumps.normal.ktx2"), &["--extract", folder.to_str().unwrap()]);
    for (level, size) in [16, 8, 4, 2, 1].into_iter().enumerate() {
        let picture = image::open(folder.join(format!("bumps.normal.level{level}.png"))).unwrap();
        assert_eq!((picture.width(), picture.height()), (size, size));
    }
    // Texels differ from the source only by the error of the block encoder.
    let source = image::open(bake.source.join("bumps.png")).unwrap().to_rgb8();
    let level_0 = image::open(folder.join("bumps.normal.level0.png")).unwrap().to_rgb8();
    let worst = source.iter().zip(level_0.iter()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst <= Some(16), "{worst:?}");
}

#[test]
fn extracts_floats_of_all_textures_of_a_document_as_exr() {
    let bake = bake(&["--target", "float", "--profile", "both", "--model", "anisotropic"]);
    let folder = bake.baked.join("levels");
    inspect(&bake.document(), &["--extract", folder.to_str().unwrap()]);
    for name in ["bumps.normal", "bumps.offset", "bumps.factor", "surface.roughness", "surface.anisotropy"] {
        assert!(folder.join(format!("{name}.level4.exr")).is_file(), "{name}");
    }
    let bytes = fs::read(folder.join("bumps.offset.level0.exr")).unwrap();
    let image = roughcast::decode::decode(&bytes, &Default::default()).unwrap();
    let document: Value = serde_json::from_slice(&fs::read(bake.document()).unwrap()).unwrap();
    let extension = &document["materials"][0]["extensions"]["ROUGHCAST_materials_roughness_pyramid"];
    let scale = extension["offsetScale"][0].as_f64().unwrap() as f32;
    // The ridges have slopes of 0.6 and -0.5, stored in 8 bits.
    let across = [0, 1].map(|x| {
        let [x, z] = [0, 2].map(|c| 2.0 * image.sample(x, 1, c).unwrap() - 1.0);
        -scale * x / z
    });
    assert!((across[0] - 0.6).abs() < 0.02 && (across[1] + 0.5).abs() < 0.02, "{across:?}");
}

#[test]
fn extracts_two_channels_as_red_and_green() {
    if !cfg!(feature = "bc") {
        return crate::skip::skip("the feature `bc` is off");
    }
    let bake = bake(&["--target", "bc"]);
    let folder = bake.baked.join("levels");
    inspect(&bake.texture("bumps.normal.ktx2"), &["--extract", folder.to_str().unwrap()]);
    let picture = image::open(folder.join("bumps.normal.level0.png")).unwrap();
    assert_eq!(picture.color(), image::ColorType::Rgb16);
    assert!(picture.to_rgb16().pixels().all(|p| p.0[2] == 0 && p.0[0] > 0));
}

#[test]
fn refuses_to_overwrite_images_of_the_document() {
    let bake = bake(&[]);
    let picture = bake.texture("bumps.normal.level0.png");
    fs::copy(bake.source.join("bumps.png"), &picture).unwrap();
    bake.edit(|d| {
        d["images"].as_array_mut().unwrap().push(json!({ "uri": "ridges.roughcast/bumps.normal.level0.png" }));
    });
    let (document, folder) = (bake.document(), bake.baked.join("ridges.roughcast"));
    let (outcome, _, err) = roughcast(&["inspect", document.to_str().unwrap(), "--extract", folder.to_str().unwrap()]);
    assert_eq!(outcome, Outcome::Failed);
    assert!(err.contains("bumps.normal.level0.png: expected a file of its own, found that it is a source"), "{err}");
    assert_eq!(fs::read(&picture).unwrap(), fs::read(bake.source.join("bumps.png")).unwrap());
}

#[test]
fn refuses_files_that_are_not_textures_or_documents() {
    let bake = bake(&[]);
    for path in [bake.source.join("bumps.png"), bake.baked.join("missing.ktx2")] {
        let (outcome, out, err) = roughcast(&["inspect", path.to_str().unwrap()]);
        assert_eq!((outcome, out.as_str()), (Outcome::Failed, ""));
        assert!(err.starts_with("error: "), "{err}");
    }
}
