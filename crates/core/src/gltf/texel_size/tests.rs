use serde_json::{Value, json};

use super::*;
use crate::gltf::scene::placements;
use crate::gltf::test_meshes;

fn quad() -> (Value, Vec<u8>) {
    test_meshes::quad(false)
}

fn measure_with(root: &Value, bytes: &[u8], mapping: &Mapping, size: (u32, u32)) -> Result<f64, NoDensity> {
    density(&Meshes::of(root), &placements(root)?, 0, mapping, size, &|_| Some(bytes)).map(|density| density.longest)
}

fn measure(root: &Value, bytes: &[u8]) -> Result<f64, NoDensity> {
    measure_with(root, bytes, &Mapping::default(), (64, 64))
}

#[test]
fn a_quad_of_known_size_has_its_density() {
    let (root, bytes) = quad();
    // One repeat of the texture is 2 x 2 units.
    assert_eq!(measure(&root, &bytes), Ok(2.0 / 64.0));
    // The axis with the longer texels counts.
    assert_eq!(measure_with(&root, &bytes, &Mapping::default(), (64, 16)), Ok(2.0 / 16.0));
    assert_eq!(measure_with(&root, &bytes, &Mapping::default(), (16, 64)), Ok(2.0 / 16.0));
}

/// A texel of 1/32 x 1/8 counts in full. A texel of 1/2048 x 1/32 is too slim for a sampler to follow: it counts as
/// 16 sqrt 2 times its width.
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
fn texture_transforms_change_the_density() {
    let (root, bytes) = quad();
    let with = |transform: Value, size| {
        let mapping = Mapping { tex_coord: 0, transform: Some(transform) };
        measure_with(&root, &bytes, &mapping, size)
    };
    let found = with(json!({ "scale": [4.0, 4.0], "offset": [0.3, 0.1] }), (64, 64)).unwrap();
    assert!((found - 0.5 / 64.0).abs() < 1e-12, "{found}");
    assert_eq!(with(json!({ "scale": [4.0, 0.5] }), (64, 64)), Ok(4.0 / 64.0));
    // Under a quarter rotation, the scaled u runs along v.
    let rotated = with(json!({ "scale": [8.0, 1.0], "rotation": std::f64::consts::FRAC_PI_2 }), (256, 64)).unwrap();
    assert!((rotated - 2.0 / 256.0 * 1.0).abs() < 1e-12, "{rotated}");
    assert_eq!(with(json!({ "texCoord": 1 }), (64, 64)), Err(NoDensity::NoTriangles));
    assert_eq!(with(json!({ "scale": [0, 0] }), (64, 64)), Err(NoDensity::NoTriangles));
}

/// The texels are parallelograms. Their density is compared with the longest of many directions.
#[test]
fn the_longest_direction_of_a_texel_counts() {
    let (root, mut bytes) = quad();
    // u grows by 1 towards corner 1, and by 3/4 towards corner 3.
    for (i, uv) in [[0.0, 0.0], [1.0, 0.0], [1.75, 0.5], [0.75, 0.5]].into_iter().enumerate() {
        bytes[48 + 8 * i..][..8].copy_from_slice(&uv.map(f32::to_le_bytes).concat());
    }
    let found = measure_with(&root, &bytes, &Mapping::default(), (1, 1)).unwrap();
    // p_u = (4, 0). For p_v, 2 units up are (0.75, 0.5) on the map: p_v = ((0, 2) - 0.75 (4, 0)) / 0.5 = (-6, 4).
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
    // A flat quad is not stretched along its normal.
    root["nodes"] = json!([{ "mesh": 0, "scale": [1, 1, 50] }]);
    root["scenes"] = json!([{ "nodes": [0] }]);
    assert_eq!(measure(&root, &bytes), Ok(2.0 / 64.0));
}

#[test]
fn materials_of_variants_count() {
    let (mut root, bytes) = quad();
    let primitive = &mut root["meshes"][0]["primitives"][0];
    primitive["material"] = json!(5);
    assert_eq!(measure(&root, &bytes), Err(NoDensity::NoTriangles));
    let primitive = &mut root["meshes"][0]["primitives"][0];
    primitive["extensions"] = json!({ "KHR_materials_variants": { "mappings": [{ "material": 0, "variants": [1] }] } });
    assert_eq!(measure(&root, &bytes), Ok(2.0 / 64.0));
}

#[test]
fn strips_and_fans_count_and_lines_and_points_do_not() {
    let (mut root, bytes) = quad();
    root["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    for (mode, expected) in [(4, true), (5, true), (6, true), (0, false), (1, false), (3, false)] {
        root["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        assert_eq!(measure(&root, &bytes).is_ok(), expected, "{mode}");
    }
}

/// `KHR_mesh_quantization` has integers, which the node scales.
#[test]
fn reads_quantised_positions() {
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
    // One more triangle has equal corners, and one has equal texture coordinates.
    bytes.extend([0, 1, 1, 0, 0, 2]);
    root["accessors"][2]["count"] = json!(12);
    root["bufferViews"][2]["byteLength"] = json!(12);
    assert_eq!(measure(&root, &bytes), Ok(2.0 / 64.0));
}

#[test]
fn meshes_that_move_or_are_in_no_scene_have_no_density() {
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
    // No scene draws the second mesh with the material, but something else may.
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

/// Triangles that cannot be read may be larger than those that can.
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

#[test]
fn the_extension_that_compresses_a_mesh_is_named() {
    let (mut root, bytes) = quad();
    root["meshes"][0]["primitives"][0]["extensions"] = json!({ "KHR_draco_mesh_compression": { "bufferView": 0 } });
    // The accessors of this mesh have data, too, for readers without Draco.
    assert_eq!(measure(&root, &bytes), Ok(2.0 / 64.0));
    root["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(measure(&root, &bytes), Err(NoDensity::Compressed("KHR_draco_mesh_compression")));
}
