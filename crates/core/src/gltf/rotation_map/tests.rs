use super::*;
use serde_json::{Value, json};

/// Returns two quads in z = 0, side by side on the map. On the left u runs along +x, on the right along +y.
fn document(mirrored: bool) -> (Value, Vec<u8>) {
    let mut bytes = Vec::new();
    let flip = if mirrored { -1.0 } else { 1.0 };
    let corners: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let quads = [corners.map(|[x, y]| [x * flip, y]), corners.map(|[x, y]| [5.0 - y, x])];
    for [x, y] in quads.concat() {
        for value in [x, y, 0.0] {
            bytes.extend_from_slice(&value.to_le_bytes());
        }
    }
    for offset in [0.0, 0.5] {
        for [x, y] in corners {
            for value in [offset + x / 2.0, 1.0 - y] {
                bytes.extend_from_slice(&f32::to_le_bytes(value));
            }
        }
    }
    for _ in 0..8 {
        for value in [0.0, 0.0, 1.0] {
            bytes.extend_from_slice(&f32::to_le_bytes(value));
        }
    }
    bytes.extend_from_slice(&[0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7]);
    let attributes = json!({ "POSITION": 0, "TEXCOORD_0": 1, "NORMAL": 2 });
    let root = json!({
        "meshes": [{ "primitives": [{ "attributes": attributes, "indices": 3, "material": 0 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5126, "count": 8, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5126, "count": 8, "type": "VEC3" },
            { "bufferView": 3, "componentType": 5121, "count": 12, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 96 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 64 },
            { "buffer": 0, "byteOffset": 160, "byteLength": 96 },
            { "buffer": 0, "byteOffset": 256, "byteLength": 12 },
        ],
    });
    (root, bytes)
}

fn map_of(mirrored: bool) -> RotationMap {
    let (root, bytes) = document(mirrored);
    rotation_map(&Meshes::of(&root), 0, &Mapping::default(), [0.0, 1.0, 0.0], &|_| Some(&bytes), [8, 4]).unwrap()
}

#[test]
fn each_part_of_the_map_has_the_rotation_of_its_quad() {
    let map = map_of(false);
    assert!(map.conflict < 1e-3);
    for (i, transform) in map.transforms.iter().enumerate() {
        // m = +y and n = +z, so e1 = +x and e2 = +y.
        let expected = if i % 8 < 4 { FrameTransform::IDENTITY } else { FrameTransform::rotation(0.0, 1.0) };
        let (a, b) = (transform.matrix.concat(), expected.matrix.concat());
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-5), "{i}: {transform:?}");
    }
}

#[test]
fn mirrored_parts_are_reflected() {
    assert_eq!(map_of(true).transforms[0].matrix, [[-1.0, 0.0], [0.0, 1.0]]);
}

#[test]
fn parts_used_twice_in_different_directions_conflict() {
    let (mut root, bytes) = document(false);
    // The transform puts both quads on the same part of the map.
    let transform = json!({ "scale": [2.0, 1.0] });
    root["meshes"][0]["primitives"][0]["material"] = json!(3);
    let mapping = Mapping { tex_coord: 0, transform: Some(transform) };
    let map = rotation_map(&Meshes::of(&root), 3, &mapping, [0.0, 1.0, 0.0], &|_| Some(&bytes), [8, 4]).unwrap();
    assert!(map.conflict > 0.5, "{}", map.conflict);
}

#[test]
fn refuses_too_many_repeats() {
    let (root, bytes) = document(false);
    for scale in [1e9, f64::MAX] {
        let mapping = Mapping { tex_coord: 0, transform: Some(json!({ "scale": [scale, scale] })) };
        assert_eq!(rotation_map(&Meshes::of(&root), 0, &mapping, [0.0, 1.0, 0.0], &|_| Some(&bytes), [64, 64]), None);
    }
    assert_eq!(
        rotation_map(&Meshes::of(&root), 1, &Mapping::default(), [0.0, 1.0, 0.0], &|_| Some(&bytes), [8, 4]),
        None
    );
}
