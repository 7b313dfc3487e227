use serde_json::{Value, json};

use super::*;
use crate::gltf::scene::placements;

/// A quad of 4 x 2 units in the plane z = 0 whose texture is repeated 2 x 1 times, drawn by one node with material 0.
fn quad() -> (Value, Vec<u8>) {
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]];
    let positions = corners.iter().flat_map(|[x, y]| [*x, *y, 0.0]);
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

fn measure_with(root: &Value, bytes: &[u8], mapping: &Mapping, size: (u32, u32)) -> Result<f64, NoDensity> {
    density(&Meshes::of(root), &placements(root)?, 0, mapping, size, &|_| Some(bytes)).map(|density| density.longest)
}

fn measure(root: &Value, bytes: &[u8]) -> Result<f64, NoDensity> {
    measure_with(root, bytes, &Mapping::default(), (64, 64))
}

#[test]
fn a_quad_of_known_size() {
    let (root, bytes) = quad();
    // A repeat is 2 x 2 units.
    assert_eq!(measure(&root, &bytes), Ok(2.0 / 64.0));
    // The coarser axis counts.
    assert_eq!(measure_with(&root, &bytes, &Mapping::default(), (64, 16)), Ok(2.0 / 16.0));
    assert_eq!(measure_with(&root, &bytes, &Mapping::default(), (16, 64)), Ok(2.0 / 16.0));
}

/// A texel of 1/32 x 1/8 and one of 1/2048 x 1/32, too slim for a sampler to follow: 16 sqrt 2 times its width.
#[test]
fn slim_texels_count_as_far_as_anisotropic_filtering_follows() {
    let (root, bytes) = quad();
    let measure = |size| {
        density(&Meshes::of(&root), &placements(&root).unwrap(), 0, &Mapping::default(), size, &|_| Some(&bytes))
    };
    assert_eq!(measure((64, 16)), Ok(Density { longest: 0.125, typical: 0.0625 }));
    let Density { longest, typical } = measure((4096, 64)).unwrap();
    assert!((longest - 16.0 * 2f64.sqrt() / 2048.0).abs() < 1e-12, "{longest}");
    assert!((typical - 1.0 / 256.0).abs() < 1e-12, "{typical}");
}

#[test]
fn texture_transforms_repeat_more_or_less() {
    let (root, bytes) = quad();
    let with = |transform: Value, size| {
        let mapping = Mapping { tex_coord: 0, transform: Some(transform) };
        measure_with(&root, &bytes, &mapping, size)
    };
    let found = with(json!({ "scale": [4.0, 4.0], "offset": [0.3, 0.1] }), (64, 64)).unwrap();
    assert!((found - 0.5 / 64.0).abs() < 1e-12, "{found}");
    assert_eq!(with(json!({ "scale": [4.0, 0.5] }), (64, 64)), Ok(4.0 / 64.0));
    // A quarter turn: scaled u runs along v.
    let turned = with(json!({ "scale": [8.0, 1.0], "rotation": std::f64::consts::FRAC_PI_2 }), (256, 64)).unwrap();
    assert!((turned - 2.0 / 256.0 * 1.0).abs() < 1e-12, "{turned}");
    assert_eq!(with(json!({ "texCoord": 1 }), (64, 64)), Err(NoDensity::NoTriangles));
    assert_eq!(with(json!({ "scale": [0, 0] }), (64, 64)), Err(NoDensity::NoTriangles));
}

/// Texels that are parallelograms: against the longest of many directions.
#[test]
fn the_longest_direction_of_a_texel_counts() {
    let (root, mut bytes) = quad();
    // u grows by 1 towards corner 1, by 3/4 towards corner 3.
    for (i, uv) in [[0.0, 0.0], [1.0, 0.0], [1.75, 0.5], [0.75, 0.5]].into_iter().enumerate() {
        bytes[48 + 8 * i..][..8].copy_from_slice(&uv.map(f32::to_le_bytes).concat());
    }
    let found = measure_with(&root, &bytes, &Mapping::default(), (1, 1)).unwrap();
    // p_u = (4, 0); p_v: 2 units up are (0.75, 0.5), so p_v = ((0, 2) - 0.75 (4, 0)) / 0.5 = (-6, 4).
    let longest = (0..10_000).map(|i| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 10_000.0).sin_cos();
        f64::hypot(4.0 * cos - 6.0 * sin, 4.0 * sin)
    });
    let longest = longest.fold(0.0, f64::max);
    assert!((found / longest - 1.0).abs() < 1e-6, "{found} {longest}");
}

#[test]
fn nodes_scale_texels_and_the_largest_counts() {
    let (mut root, bytes) = quad();
    root["nodes"] = json!([{ "mesh": 0, "scale": [3, 3, 3] }, { "mesh": 0, "scale": [0.1, 0.1, 0.1] }]);
    root["scenes"] = json!([{ "nodes": [0, 1] }]);
    assert_eq!(measure(&root, &bytes), Ok(6.0 / 64.0));
    // Along its normal a flat quad cannot be stretched.
    root["nodes"] = json!([{ "mesh": 0, "scale": [1, 1, 50] }]);
    root["scenes"] = json!([{ "nodes": [0] }]);
    assert_eq!(measure(&root, &bytes), Ok(2.0 / 64.0));
}

#[test]
fn variants_show_their_materials_too() {
    let (mut root, bytes) = quad();
    let primitive = &mut root["meshes"][0]["primitives"][0];
    primitive["material"] = json!(5);
    assert_eq!(measure(&root, &bytes), Err(NoDensity::NoTriangles));
    let primitive = &mut root["meshes"][0]["primitives"][0];
    primitive["extensions"] = json!({ "KHR_materials_variants": { "mappings": [{ "material": 0, "variants": [1] }] } });
    assert_eq!(measure(&root, &bytes), Ok(2.0 / 64.0));
}

#[test]
fn strips_and_fans_are_triangles_and_lines_are_not() {
    let (mut root, bytes) = quad();
    root["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    for (mode, expected) in [(4, true), (5, true), (6, true), (0, false), (1, false), (3, false)] {
        root["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        assert_eq!(measure(&root, &bytes).is_ok(), expected, "{mode}");
    }
}

/// `KHR_mesh_quantization`: integers, which the node scales.
#[test]
fn quantised_positions_are_read() {
    let (mut root, _) = quad();
    let corners: [[i8; 2]; 4] = [[0, 0], [127, 0], [127, 127], [0, 127]];
    let positions = corners.iter().flat_map(|[x, y]| [*x as u8, *y as u8, 0, 0]);
    let uvs = corners.iter().flat_map(|[x, y]| [i16::from(*x) * 258, i16::from(*y) * 258]).flat_map(i16::to_le_bytes);
    let mut bytes: Vec<u8> = positions.chain(uvs).collect();
    bytes.extend([0, 1, 2, 0, 2, 3]);
    root["accessors"][0]["componentType"] = json!(5120);
    root["accessors"][0]["normalized"] = json!(true);
    root["accessors"][1]["componentType"] = json!(5122);
    root["accessors"][1]["normalized"] = json!(true);
    root["bufferViews"] = json!([
        { "buffer": 0, "byteLength": 16, "byteStride": 4 },
        { "buffer": 0, "byteOffset": 16, "byteLength": 16 },
        { "buffer": 0, "byteOffset": 32, "byteLength": 6 },
    ]);
    root["nodes"][0]["scale"] = json!([10, 10, 10]);
    let found = measure(&root, &bytes).unwrap();
    let repeat = 127.0 * 258.0 / 32767.0;
    assert!((found - 10.0 / repeat / 64.0).abs() < 1e-12, "{found}");
}

#[test]
fn triangles_without_area_do_not_count() {
    let (mut root, mut bytes) = quad();
    // One more triangle between equal corners, and one with equal texture coordinates.
    bytes.extend([0, 1, 1, 0, 0, 2]);
    root["accessors"][2]["count"] = json!(12);
    root["bufferViews"][2]["byteLength"] = json!(12);
    assert_eq!(measure(&root, &bytes), Ok(2.0 / 64.0));
}

#[test]
fn what_moves_or_is_not_there_is_told() {
    let (root, bytes) = quad();
    let with = |pointer: &str, value: Value| {
        let mut root = root.clone();
        *root.pointer_mut(pointer).unwrap() = value;
        measure(&root, &bytes)
    };
    assert_eq!(with("/scenes", json!([])), Err(NoDensity::InNoScene { mesh: 0 }));
    let skin = with("/nodes/0", json!({ "mesh": 0, "skin": 0 }));
    assert_eq!(skin, Err(NoDensity::Unsteady { mesh: 0, reason: Unsteady::Skin }));
    assert_eq!(with("/nodes/0", json!(3)), Err(NoDensity::Node(BadNode(0))));
    assert_eq!(with("/meshes", json!({})), Err(NoDensity::NoTriangles));
    // A second mesh with the material that no scene draws may be drawn by something else.
    let mut two = root.clone();
    let mesh = two["meshes"][0].clone();
    two["meshes"].as_array_mut().unwrap().push(mesh);
    assert_eq!(measure(&two, &bytes), Err(NoDensity::InNoScene { mesh: 1 }));
    let mut moving = root.clone();
    let pointer = "/materials/0/normalTexture/extensions/KHR_texture_transform/scale";
    let target = json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } });
    moving["animations"] = json!([{ "channels": [{ "target": target }] }]);
    assert_eq!(measure(&moving, &bytes), Err(NoDensity::MovingCoordinates));
}

/// What cannot be read may be larger than what can.
#[test]
fn hostile_accessors_leave_the_density_unknown() {
    let (root, bytes) = quad();
    let edits = [
        ("/accessors/0/count", json!(usize::MAX)),
        ("/accessors/0/count", json!(3)),
        ("/accessors/0/componentType", json!(5125)),
        ("/accessors/0/byteOffset", json!(u64::MAX)),
        ("/accessors/1", json!({ "componentType": 5126, "count": 4, "type": "VEC2" })),
        ("/accessors/2/componentType", json!(9)),
        ("/accessors/2/count", json!(1u64 << 40)),
        ("/bufferViews/0/byteLength", json!(1e300)),
        ("/bufferViews/1/byteLength", json!(12)),
        ("/bufferViews/1/buffer", json!("one")),
        ("/accessors", json!(7)),
    ];
    for (pointer, value) in edits {
        let mut edited = root.clone();
        *edited.pointer_mut(pointer).unwrap() = value.clone();
        assert_eq!(measure(&edited, &bytes), Err(NoDensity::Unreadable), "{pointer} {value}");
    }
    let mut sparse = root.clone();
    sparse["accessors"][0]["sparse"] = json!({ "count": 1 });
    assert_eq!(measure(&sparse, &bytes), Err(NoDensity::Unreadable));
    for length in 0..bytes.len() {
        assert_eq!(measure(&root, &bytes[..length]), Err(NoDensity::Unreadable), "{length}");
    }
    for value in [f32::NAN, f32::INFINITY, f32::MAX] {
        let mut bytes = bytes.clone();
        bytes[12..16].copy_from_slice(&value.to_le_bytes());
        let found = measure(&root, &bytes);
        assert!(found.is_err() || found.unwrap() > 1e30, "{value}");
    }
}
