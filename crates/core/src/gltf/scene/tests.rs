use serde_json::json;

use super::*;
use crate::math::vector::cross;

const MESH: usize = 0;

fn placement(mut root: Value) -> Placement {
    if root.get("scenes").is_none() {
        root["scenes"] = json!([{ "nodes": [0] }]);
    }
    root["meshes"] = json!([{ "primitives": [{}] }]);
    placements(&root).unwrap()[MESH].clone()
}

fn metrics(root: Value) -> Vec<Metric> {
    match placement(root) {
        Placement::At(metrics) => metrics,
        other => panic!("{other:?}"),
    }
}

fn assert_close(metric: Metric, expected: Metric) {
    let pairs = metric.as_flattened().iter().zip(expected.as_flattened());
    assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12), "{metric:?}");
}

#[test]
fn scales_multiply_down_the_tree() {
    let root = json!({ "nodes": [
        { "scale": [2, 2, 2], "children": [1] },
        { "rotation": [0.0, 0.6, 0.0, 0.8], "children": [2] },
        { "mesh": 0, "matrix": [3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 7, 8, 9, 1] },
    ] });
    let [metric] = metrics(root)[..] else { panic!() };
    assert_close(metric, uniform(36.0));
}

#[test]
fn rotations_decide_what_an_anisotropic_scale_stretches() {
    // A quarter rotation about z takes x to y, which the parent stretches by 3.
    let half = 0.5_f64.sqrt();
    let root = json!({ "nodes": [
        { "scale": [1, 3, 1], "children": [1] },
        { "mesh": 0, "rotation": [0.0, 0.0, half, half] },
    ] });
    let [metric] = metrics(root)[..] else { panic!() };
    assert_close(metric, [[9.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
}

/// Compares each column of the matrix of glTF 2.0, section 3.5.3, with an axis rotated by the quaternion itself.
#[test]
fn quaternions_rotate_axes() {
    let q = [0.1, -0.5, 0.3, 0.8_f64];
    let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z, w] = q.map(|c| c / norm);
    for (i, axis) in axes([x, y, z, w]).into_iter().enumerate() {
        let mut v = [0.0; 3];
        v[i] = 1.0;
        // v + 2 w (r x v) + 2 r x (r x v).
        let once = cross([x, y, z], v);
        let twice = cross([x, y, z], once);
        for k in 0..3 {
            assert!((axis[k] - (v[k] + 2.0 * w * once[k] + 2.0 * twice[k])).abs() < 1e-12);
        }
    }
}

#[test]
fn each_size_of_a_mesh_is_kept_and_equal_ones_once() {
    let scaled = |s: f64| json!({ "mesh": 0, "scale": [s, s, s] });
    let root =
        json!({ "nodes": [scaled(1.0), scaled(2.0), scaled(1.0)], "scenes": [{ "nodes": [0, 1] }, { "nodes": [2] }] });
    let mut found: Vec<f64> = metrics(root).iter().map(|m| m[0][0]).collect();
    found.sort_by(f64::total_cmp);
    assert_eq!(found, [1.0, 4.0]);
}

#[test]
fn beyond_the_limit_the_largest_metric_replaces_all() {
    let nodes: Vec<Value> = (1..=200).map(|s| json!({ "mesh": 0, "scale": [1, s, 1] })).collect();
    let root = json!({ "scenes": [{ "nodes": (0..200).collect::<Vec<_>>() }], "nodes": nodes });
    let found = metrics(root);
    assert!(found.len() <= MAX_METRICS);
    assert!(found.contains(&uniform(40_000.0)), "{found:?}");
}

#[test]
fn meshes_in_no_scene_are_absent() {
    assert_eq!(placement(json!({ "nodes": [{}, { "mesh": 0 }] })), Placement::Absent);
    assert_eq!(placement(json!({ "nodes": [{ "mesh": 0 }], "scenes": [] })), Placement::Absent);
}

#[test]
fn skins_instances_and_morph_targets_change_the_size() {
    let node = |node: Value| placement(json!({ "nodes": [node] }));
    assert_eq!(node(json!({ "mesh": 0, "skin": 0 })), Placement::Unsteady(Unsteady::Skin));
    let instances = |attribute: &str| {
        node(json!({ "mesh": 0, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { attribute: 3 } } } }))
    };
    assert_eq!(instances("SCALE"), Placement::Unsteady(Unsteady::Instances));
    assert_eq!(instances("TRANSLATION"), Placement::At(vec![IDENTITY]));
    let mesh = json!({ "primitives": [{}, { "targets": [{ "POSITION": 1 }] }] });
    let root = json!({ "meshes": [mesh], "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }] });
    assert_eq!(placements(&root).unwrap(), [Placement::Unsteady(Unsteady::Morph)]);
}

/// The animation of a parent reaches its children.
#[test]
fn animated_scales_change_the_size() {
    let animated = |target: Value| {
        placement(json!({
            "nodes": [{ "children": [1] }, { "mesh": 0 }, {}],
            "animations": [{ "channels": [{ "sampler": 0, "target": target }] }],
        }))
    };
    let pointer = |pointer: &str| {
        animated(json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } }))
    };
    let (steady, unsteady) = (Placement::At(vec![IDENTITY]), Placement::Unsteady(Unsteady::Scale));
    for node in [0, 1] {
        assert_eq!(animated(json!({ "node": node, "path": "scale" })), unsteady);
        assert_eq!(pointer(&format!("/nodes/{node}/scale")), unsteady);
    }
    assert_eq!(animated(json!({ "node": 2, "path": "scale" })), steady);
    assert_eq!(animated(json!({ "node": 1, "path": "rotation" })), steady);
    assert_eq!(animated(json!({ "node": 1, "path": "translation" })), steady);
    assert_eq!(pointer("/nodes/1/translation"), steady);
    assert_eq!(pointer("nonsense"), steady);
}

#[test]
fn an_animated_rotation_under_an_anisotropic_scale_takes_the_largest_stretch() {
    let root = json!({
        "nodes": [{ "scale": [1, 3, 1], "children": [1] }, { "mesh": 0 }],
        "animations": [{ "channels": [{ "sampler": 0, "target": { "node": 1, "path": "rotation" } }] }],
    });
    assert_eq!(metrics(root), [uniform(9.0)]);
}

#[test]
fn animated_texture_transforms_are_found() {
    let moving = |pointer: &str| {
        let target = json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } });
        moving_coordinates(&json!({ "animations": [{ "channels": [{ "target": target }] }] })).contains(&1)
    };
    assert!(moving("/materials/1/normalTexture/extensions/KHR_texture_transform/scale"));
    assert!(moving("/materials/1/normalTexture/extensions/KHR_texture_transform/rotation"));
    assert!(!moving("/materials/1/normalTexture/extensions/KHR_texture_transform/offset"));
    assert!(!moving("/materials/0/normalTexture/extensions/KHR_texture_transform/scale"));
    assert!(!moving("/materials/1/normalTexture/scale"));
}

#[test]
fn animated_scales_of_bumps_are_found() {
    let animated = |pointer: &str| {
        let target = json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } });
        animated_bumps(&json!({ "animations": [{ "channels": [{ "target": target }] }] })).contains(&1)
    };
    assert!(animated("/materials/1/normalTexture/scale"));
    assert!(animated("/materials/1/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale"));
    assert!(!animated("/materials/1/normalTexture/extensions/KHR_texture_transform/scale"));
    assert!(!animated("/materials/0/normalTexture/scale"));
}

#[test]
fn cycles_end_and_bad_nodes_are_errors() {
    let cycle = json!({ "nodes": [{ "mesh": 0, "children": [1, 0] }, { "children": [0, 0, 1], "mesh": 9 }] });
    assert_eq!(placement(cycle), Placement::At(vec![IDENTITY]));
    let bad = |nodes: Value| placements(&json!({ "nodes": nodes, "scenes": [{ "nodes": [0] }] }));
    assert_eq!(bad(json!([{ "children": [7] }])), Err(BadNode(7)));
    assert_eq!(bad(json!([{ "scale": [1, 2] }])), Err(BadNode(0)));
    assert_eq!(bad(json!([{ "mesh": -1 }])), Err(BadNode(0)));
    assert_eq!(bad(json!([])), Err(BadNode(0)));
    assert_eq!(placements(&json!({ "scenes": [{ "nodes": ["a"] }] })), Err(BadNode(usize::MAX)));
    assert_eq!(placements(&json!({ "scenes": 3, "nodes": {}, "meshes": null })), Ok(vec![]));
}
