//! Meshes for tests.

use serde_json::{Value, json};

/// Returns a document and its buffer: a quad of 4 x 2 units in the plane z = 0 that faces +z, drawn by one node with
/// material 0. The texture repeats 2 x 1 times. u runs along +x, or with `is_rotated` along +y.
pub fn quad(is_rotated: bool) -> (Value, Vec<u8>) {
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]];
    let positions = corners.iter().flat_map(|[x, y]| if is_rotated { [-y, *x, 0.0] } else { [*x, *y, 0.0] });
    let uvs = corners.iter().flat_map(|[x, y]| [x / 2.0, 1.0 - y / 2.0]);
    let mut bytes: Vec<u8> = positions.chain(uvs).flat_map(|f: f32| f.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0, 2, 3]);
    let root = json!({
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0 }] }],
        "accessors": [
            { "bufferView": 0, "byteOffset": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5121, "count": 6, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 32 },
            { "buffer": 0, "byteOffset": 80, "byteLength": 6 },
        ],
    });
    (root, bytes)
}
