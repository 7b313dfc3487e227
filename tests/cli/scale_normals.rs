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
    let slope = |x: u32, y: u32| if (x + y) % 8 < 4 { SLOPE } else { -SLOPE };
    write_asset_of(folder, extras, |x, y| normal(slope(x, y)).map(|c| (c * 65535.0).round() as u16));
}

/// Returns the normal of a slope along u as a texel in [0, 1].
fn normal(slope: f64) -> [f64; 3] {
    let length = (1.0 + slope * slope).sqrt();
    [-slope / length, 0.0, 1.0 / length].map(|c| 0.5 * c + 0.5)
}

/// Writes a material with a normal map of `texel` and a scale of 0.5.
fn write_asset_of(folder: &Path, extras: &[(&str, Value)], texel: impl Fn(u32, u32) -> [u16; 3]) {
    let side = 32;
    let picture = image::ImageBuffer::from_fn(side, side, |x, y| image::Rgb(texel(x, y)));
    picture.save(folder.join("low_normal.png")).expect("a picture");
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
    let source = tempdir().expect("a folder");
    write_asset(source.path(), extras);
    let (scale, slopes) = scale_and_slopes(source.path(), options);
    (scale, slopes.into_iter().fold(0.0, |most: f64, slope| most.max(slope.abs())))
}

/// Bakes the asset in the folder `source`. Returns the scale of the document and the slopes along u of the PNG of level
/// 0, row by row.
fn scale_and_slopes(source: &Path, options: &[&str]) -> (f64, Vec<f64>) {
    let baked = tempdir().expect("a folder");
    let options = [&["--gltf", "fallback"], options].concat();
    bake(&source.join("low.gltf"), baked.path(), &options);
    let picture = image::open(baked.path().join("low.roughcast/low_normal.normal.png")).expect("a picture").to_rgb8();
    let slope = |texel: &image::Rgb<u8>| {
        let [x, _, z] = texel.0.map(|c| 2.0 * f64::from(c) / 255.0 - 1.0);
        -x / z
    };
    (scale_in(baked.path()), picture.pixels().map(slope).collect())
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

/// A mirror between bumps, in a map of 8 bits whose flat texels are 128: a scale of 0.31 would move all of them.
#[test]
fn flat_areas_keep_the_normals_of_a_map_of_8_bits() {
    let source = tempdir().expect("a folder");
    let texel = |x: u32| if x % 8 < 3 { normal(0.25).map(|c| (c * 255.0).round() as u16) } else { [128, 128, 255] };
    write_asset_of(source.path(), &[], |x, _| texel(x).map(|byte| 257 * byte));
    let (scale, slopes) = scale_and_slopes(source.path(), &["--engine", "three"]);
    assert!((scale - 0.5 / 3.0).abs() < 1e-6, "{scale}");
    let (expected, shown) = (-0.5 * 0.5 / 127.5, scale * slopes[5]);
    assert!((shown / expected - 1.0).abs() < 0.01, "{shown}, not {expected}");
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
