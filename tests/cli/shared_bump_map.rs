//! Tests of a bump map that several lobes share: the narrowest lobe beside its bumps decides the normal texture.

use std::fs;

use serde_json::{Value, json};
use tempfile::tempdir;

use super::process::{bake, copy, files, fixtures};

/// Bakes `materials` over the bump map of `tiny` (texture 0; the roughness of texture 1 has a mean of 0.4), and returns
/// the bytes of the normal texture.
fn normals(materials: &[Value]) -> Vec<u8> {
    let folder = tempdir().expect("a folder");
    copy(&fixtures().join("tiny"), folder.path());
    let path = folder.path().join("tiny.gltf");
    let document = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_materials_clearcoat"],
        "images": [{ "uri": "cloth_normal.png" }, { "uri": "cloth_surface.png" }],
        "textures": [{ "source": 0 }, { "source": 1 }],
        "materials": materials,
    });
    fs::write(&path, document.to_string()).expect("a document");
    let output = folder.path().join("out");
    // Block encoders choose by the width of the lobe, which these tests are not about.
    let run = bake(&path, &output, &["--target", "float", "--no-provenance"]);
    let is_normals = |name: &str| name.ends_with("normal.ktx2");
    let (_, normals) = files(&output).into_iter().find(|(name, _)| is_normals(name)).expect(&run.out);
    fs::read(normals).expect("a texture")
}

fn base(roughness: f64) -> Value {
    json!({ "normalTexture": { "index": 0 }, "pbrMetallicRoughness": { "roughnessFactor": roughness } })
}

fn textured_base() -> Value {
    json!({
        "normalTexture": { "index": 0 },
        "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 1 } },
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
    let textured = normals(&[textured_base()]);
    let narrow = normals(&[base(0.2)]);
    assert_ne!(textured, narrow);
    assert_eq!(normals(&[base(0.8), textured_base()]), textured, "0.4 is narrower than 0.8");
    assert_eq!(normals(&[textured_base(), base(0.2)]), narrow, "0.2 is narrower than 0.4");
}

#[test]
fn lower_bumps_count_like_a_wider_lobe() {
    let coat = coated(base(0.4), 1.0, 0.35, 0.1);
    assert_eq!(normals(&[coat]), normals(&[base(0.4)]));
}

#[test]
fn a_layer_that_is_not_seen_decides_nothing() {
    let wide = normals(&[base(0.7)]);
    assert_eq!(normals(&[coated(base(0.7), 0.0, 0.15, 1.0)]), wide);
}
