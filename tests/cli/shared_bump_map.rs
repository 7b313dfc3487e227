//! Tests of a bump map that several lobes share: the narrowest lobe beside its bumps decides the normal texture.

use std::fs;

use serde_json::{Value, json};
use tempfile::tempdir;

use super::process::{bake, copy, files, fixtures};

/// What a bake makes of some materials.
struct Baked {
    /// The bytes of the normal texture.
    normals: Vec<u8>,
    document: Value,
    report: Value,
}

fn normals(materials: &[Value]) -> Vec<u8> {
    baked(materials, &[]).normals
}

/// Bakes `materials` over the bump map of `tiny` with `options`. Texture 0 is the bump map, the roughness of texture 1
/// has a mean of 0.4, and texture 2 is larger than the bump map, with a roughness of 0.1.
fn baked(materials: &[Value], options: &[&str]) -> Baked {
    let folder = tempdir().expect("a folder");
    copy(&fixtures().join("tiny"), folder.path());
    let path = folder.path().join("tiny.gltf");
    let large = image::RgbImage::from_pixel(32, 32, image::Rgb([255, 26, 255]));
    large.save(folder.path().join("large.png")).expect("a picture");
    let document = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_materials_clearcoat"],
        "images": [{ "uri": "cloth_normal.png" }, { "uri": "cloth_surface.png" }, { "uri": "large.png" }],
        "textures": [{ "source": 0 }, { "source": 1 }, { "source": 2 }],
        "materials": materials,
    });
    fs::write(&path, document.to_string()).expect("a document");
    let output = folder.path().join("out");
    // Block encoders choose by the width of the lobe, which these tests are not about.
    let run = bake(&path, &output, &[&["--target", "float", "--no-provenance", "--json"], options].concat());
    let is_normals = |name: &str| name.ends_with("normal.ktx2");
    let (_, normals) = files(&output).into_iter().find(|(name, _)| is_normals(name)).expect(&run.out);
    let document = fs::read(output.join("tiny.gltf")).expect("a document");
    Baked {
        normals: fs::read(normals).expect("a texture"),
        document: serde_json::from_slice(&document).expect("JSON"),
        report: serde_json::from_str(&run.out).expect("JSON"),
    }
}

fn base(roughness: f64) -> Value {
    json!({ "normalTexture": { "index": 0 }, "pbrMetallicRoughness": { "roughnessFactor": roughness } })
}

fn textured_base(texture: usize) -> Value {
    json!({
        "normalTexture": { "index": 0 },
        "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": texture } },
    })
}

/// Adds a clearcoat of strength `factor` to `base`.
fn coated(mut base: Value, factor: f64, roughness: f64, scale: f64) -> Value {
    base["extensions"]["KHR_materials_clearcoat"] = json!({
        "clearcoatFactor": factor,
        "clearcoatRoughnessFactor": roughness,
        "clearcoatNormalTexture": { "index": 0, "scale": scale },
    });
    base
}

#[test]
fn the_narrowest_lobe_decides_whatever_its_place() {
    let (narrow, wide) = (normals(&[base(0.15)]), normals(&[base(0.7)]));
    assert_ne!(narrow, wide, "the lobes choose different directions");
    assert_eq!(normals(&[coated(base(0.7), 1.0, 0.15, 1.0)]), narrow);
    assert_eq!(normals(&[coated(base(0.15), 1.0, 0.7, 1.0)]), narrow);
    assert_eq!(normals(&[base(0.7), base(0.15)]), narrow);
}

#[test]
fn the_mean_of_a_roughness_texture_counts() {
    let textured = normals(&[textured_base(1)]);
    let narrow = normals(&[base(0.2)]);
    assert_ne!(textured, narrow);
    assert_eq!(normals(&[base(0.8), textured_base(1)]), textured, "0.4 is narrower than 0.8");
    assert_eq!(normals(&[textured_base(1), base(0.2)]), narrow, "0.2 is narrower than 0.4");
}

#[test]
fn lower_bumps_count_like_a_wider_lobe() {
    let coat = coated(base(0.4), 1.0, 0.35, 0.1);
    assert_eq!(normals(&[coat]), normals(&[base(0.4)]));
    // An alpha of 0 counts as 0.001, the narrowest that errors are measured with: 0.1 beside bumps of a hundredth.
    let polished = coated(base(0.04), 1.0, 0.0, 0.01);
    assert_eq!(normals(&[polished]), normals(&[base(0.04)]));
}

#[test]
fn a_lobe_on_a_larger_grid_is_judged_with_the_directions_that_another_decides() {
    let [first, last] =
        [[textured_base(2), base(0.15)], [base(0.15), textured_base(2)]].map(|materials| baked(&materials, &[]));
    assert_eq!(first.normals, normals(&[base(0.15)]));
    assert_eq!(last.normals, first.normals);
    let choice = |baked: &Baked, material: usize| baked.report["assets"][0]["layers"][material]["choice"].clone();
    assert_eq!(choice(&first, 0), choice(&last, 1));
    let alone = baked(&[textured_base(2)], &[]);
    assert_ne!(choice(&first, 0), choice(&alone, 0), "mean slopes are other directions");
}

#[test]
fn names_of_textures_do_not_depend_on_widths() {
    let material = |roughness, coat| [coated(base(roughness), 1.0, coat, 1.0)];
    let [wide, narrow] =
        [material(0.7, 0.15), material(0.15, 0.7)].map(|materials| baked(&materials, &["--model", "isotropic"]));
    assert!(wide.document["images"].as_array().is_some_and(|images| images.len() > 2), "{}", wide.document);
    assert_eq!(wide.document["textures"], narrow.document["textures"]);
    assert_eq!(wide.document["images"], narrow.document["images"]);
    assert_eq!(
        wide.document["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"],
        narrow.document["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"]
    );
}

#[test]
fn a_layer_that_is_not_seen_decides_nothing() {
    let wide = normals(&[base(0.7)]);
    assert_eq!(normals(&[coated(base(0.7), 0.0, 0.15, 1.0)]), wide);
}
