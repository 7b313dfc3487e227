//! Tests of the scale of normal textures: low bumps use all values of their texture, and the document says by how much.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::tempdir;

use super::process::{bake, roughcast};

/// Slopes of the bumps along u, which alternate their signs.
const SLOPE: f64 = 0.02;

/// Writes a material with low bumps and a scale of 0.5 to `folder`, with `extras` in its document.
fn write_asset(folder: &Path, extras: &[(&str, Value)]) {
    let side = 32;
    let texel = |x: u32, y: u32| {
        let u = if (x + y) % 8 < 4 { SLOPE } else { -SLOPE };
        let length = (1.0 + u * u).sqrt();
        image::Rgb([-u / length, 0.0, 1.0 / length].map(|c| ((0.5 * c + 0.5) * 65535.0).round() as u16))
    };
    image::ImageBuffer::from_fn(side, side, texel).save(folder.join("low_normal.png")).expect("a picture");
    let mut document = json!({
        "asset": { "version": "2.0" },
        "images": [{ "uri": "low_normal.png" }],
        "textures": [{ "source": 0 }],
        "materials": [{
            "normalTexture": { "index": 0, "scale": 0.5 },
            "pbrMetallicRoughness": { "roughnessFactor": 0.2 },
        }],
    });
    for (name, value) in extras {
        document[*name] = value.clone();
    }
    fs::write(folder.join("low.gltf"), document.to_string()).expect("a document");
}

/// Bakes the asset with `options`. Returns the scale of the document and the largest slope of the PNG of level 0.
fn scale_and_slope(extras: &[(&str, Value)], options: &[&str]) -> (f64, f64) {
    let (source, baked) = (tempdir().expect("a folder"), tempdir().expect("a folder"));
    write_asset(source.path(), extras);
    let options = [&["--gltf", "fallback"], options].concat();
    bake(&source.path().join("low.gltf"), baked.path(), &options);
    let picture = image::open(baked.path().join("low.roughcast/low_normal.normal.png")).expect("a picture").to_rgb8();
    let slope = |texel: &image::Rgb<u8>| {
        let [x, _, z] = texel.0.map(|c| 2.0 * f64::from(c) / 255.0 - 1.0);
        (x / z).abs()
    };
    let steepest = picture.pixels().map(slope).fold(0.0, f64::max);
    (scale_in(baked.path()), steepest)
}

/// Returns the scale of the document in the folder `baked`.
fn scale_in(baked: &Path) -> f64 {
    let text = fs::read(baked.join("low.gltf")).expect("a document");
    let document: Value = serde_json::from_slice(&text).expect("JSON");
    document["materials"][0]["normalTexture"]["scale"].as_f64().expect("a scale")
}

#[test]
fn low_bumps_fill_their_texture_and_the_document_has_the_scale() {
    let (scale, slope) = scale_and_slope(&[], &["--engine", "three"]);
    assert!(scale < 0.05, "{scale}");
    assert!((slope - 0.5).abs() < 0.01, "{slope}");
    assert!((scale * slope / (0.5 * SLOPE) - 1.0).abs() < 0.02, "{scale} x {slope}");
}

#[test]
fn engines_that_ignore_the_scale_get_the_slopes_of_the_source() {
    for options in [&["--engine", "bevy"][..], &[], &["--engine", "godot"]] {
        let (scale, slope) = scale_and_slope(&[], options);
        assert_eq!(scale, 0.5, "{options:?}");
        assert!(slope < 2.0 * SLOPE, "{options:?}: {slope}");
    }
    assert_eq!(scale_and_slope(&[], &["--engine", "three", "--scale-normals=false"]).0, 0.5);
}

#[test]
fn the_form_decides_without_an_engine() {
    for (options, is_scaled) in [
        (&["--gltf", "strict"][..], true),
        (&["--gltf", "strict", "--scale-normals=false"], false),
        (&["--gltf", "strict", "--engine", "playcanvas"], false),
        (&["--gltf", "fallback"], false),
        (&["--gltf", "fallback", "--scale-normals"], true),
        (&["--gltf", "dual"], false),
        (&[], true),
    ] {
        let (source, baked) = (tempdir().expect("a folder"), tempdir().expect("a folder"));
        write_asset(source.path(), &[]);
        bake(&source.path().join("low.gltf"), baked.path(), options);
        let scale = scale_in(baked.path());
        assert_eq!(scale < 0.05, is_scaled, "{options:?}: {scale}");
        // `check` expects the scale where the same options ask for it.
        let [source, baked] = [&source, &baked].map(|folder| folder.path().to_str().expect("UTF-8"));
        let checked = roughcast([&["check", baked, "--source", source, "--deny", "RC1507"], options].concat());
        assert_eq!(checked.code, 0, "{options:?}: {}", checked.out);
    }
}

#[test]
fn animated_scales_stay() {
    let target = json!({
        "path": "pointer",
        "extensions": { "KHR_animation_pointer": { "pointer": "/materials/0/normalTexture/scale" } },
    });
    let animation = json!([{ "channels": [{ "sampler": 0, "target": target }], "samplers": [] }]);
    assert_eq!(scale_and_slope(&[("animations", animation)], &["--engine", "three"]).0, 0.5);
}
