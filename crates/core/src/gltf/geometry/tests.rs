use super::*;
use crate::gltf::test_meshes::quad;
use serde_json::{Value, json};

fn measure(root: &Value, bytes: &[u8], mapping: &Mapping) -> Option<Layout> {
    layout(&Meshes::of(root), 0, mapping, [0.0, 1.0, 0.0], &|_| Some(bytes))
}

#[test]
fn lengths_are_units_per_repeat() {
    let (root, bytes) = quad(false);
    let layout = measure(&root, &bytes, &Mapping::default()).unwrap();
    assert_eq!(layout.units_per_repeat, [2.0, 2.0]);
    // m = +y and n = +z, so e1 = m x n = +x = T.
    assert_eq!(layout.tangent_rotation, [1.0, 0.0]);
    assert!(layout.rotation_deviation < 1e-3);
}

#[test]
fn texture_transforms_scale_repeats() {
    let (root, bytes) = quad(false);
    let transform = Some(json!({ "scale": [4.0, 0.5], "offset": [0.3, 0.1] }));
    let layout = measure(&root, &bytes, &Mapping { tex_coord: 0, transform }).unwrap();
    assert_eq!(layout.units_per_repeat, [0.5, 4.0]);
}

#[test]
fn the_tangent_rotation_is_from_e1_to_the_tangent() {
    let (root, bytes) = quad(true);
    let layout = measure(&root, &bytes, &Mapping::default()).unwrap();
    let [cos, sin] = layout.tangent_rotation;
    assert!(cos.abs() < 1e-6 && (sin - 1.0).abs() < 1e-6, "{layout:?}");
}

/// Vectors that overlap, values that are not finite, and lengths whose squares overflow have no layout.
#[test]
fn invalid_positions_have_no_layout() {
    let (root, bytes) = quad(false);
    for stride in [1, 2, 4, 10, 13] {
        let mut root = root.clone();
        root["bufferViews"][0]["byteStride"] = json!(stride);
        assert_eq!(measure(&root, &bytes, &Mapping::default()), None, "stride {stride}");
    }
    for x in [f32::NAN, f32::INFINITY, 3e38, 1e12] {
        let mut bytes = bytes.clone();
        for vertex in 0..4 {
            bytes[12 * vertex..12 * vertex + 4].copy_from_slice(&(x * vertex as f32).to_le_bytes());
        }
        assert_eq!(measure(&root, &bytes, &Mapping::default()), None, "{x}");
    }
}

#[test]
fn unreadable_triangles_have_no_layout() {
    let (root, bytes) = quad(false);
    let other = Mapping { tex_coord: 1, transform: None };
    assert_eq!(measure(&root, &bytes, &other), None);
    assert_eq!(measure(&root, &bytes[..40], &Mapping::default()), None);
    assert_eq!(measure(&json!({ "meshes": 3 }), &bytes, &Mapping::default()), None);
}
