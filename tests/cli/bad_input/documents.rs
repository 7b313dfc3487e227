//! Documents that are truncated, damaged, or refer to nothing.

use std::fs;

use super::*;

#[test]
fn rejects_a_document_that_is_not_json() {
    let scene = Scene::new();
    cut_in_half(&scene.bad("brushed.gltf"));
    assert_contains(&scene.error_line(&[]), &["bad/brushed.gltf: ", "JSON"]);
}

#[test]
fn rejects_an_empty_document() {
    let scene = Scene::new();
    fs::write(scene.bad("brushed.gltf"), "").expect("a file");
    assert_contains(&scene.error_line(&[]), &["bad/brushed.gltf: ", "found an empty file"]);
}

#[test]
fn rejects_a_document_of_repeated_brackets() {
    let scene = Scene::new();
    fs::write(scene.bad("brushed.gltf"), "[".repeat(1 << 20)).expect("a file");
    assert_contains(&scene.error_line(&[]), &["bad/brushed.gltf: ", "JSON"]);
}

#[test]
fn rejects_values_of_wrong_types() {
    for (old, new) in [
        ("\"index\": 1", "\"index\": -1"),
        ("\"index\": 1", "\"index\": \"1\""),
        ("\"index\": 1", "\"index\": 1, \"scale\": \"much\""),
        ("\"name\": \"Brushed steel\"", "\"name\": \"Brushed steel\", \"pbrMetallicRoughness\": 7, \"_\": 0"),
    ] {
        let scene = Scene::new();
        if new.contains("\"_\"") {
            scene.edit("\"pbrMetallicRoughness\"", "\"was\"");
        }
        scene.edit(old, new);
        assert_contains(&scene.error_line(&[]), &["bad/brushed.gltf: ", "Brushed steel", "expected"]);
    }
}

#[test]
fn rejects_a_truncated_glb() {
    let scene = Scene::new();
    let whole = fs::read(fixtures().join("waves/waves.glb")).expect("a fixture");
    fs::remove_file(scene.bad("brushed.gltf")).expect("a file");
    for end in [0, 3, 4, 11, 12, 19, 20, 400, whole.len() / 2, whole.len() - 1] {
        fs::write(scene.bad("lake.glb"), &whole[..end]).expect("a file");
        assert_contains(&scene.error_line(&[]), &["bad/lake.glb: ", "expected"]);
    }
}

#[test]
fn rejects_an_index_out_of_range() {
    for (old, new, parts) in [
        ("\"index\": 1", "\"index\": 99", &["Brushed steel", "normal", "textures[99]"] as &[&str]),
        ("\"index\": 2", "\"index\": 99", &["Brushed steel", "roughness", "textures[99]"]),
        ("\"source\": 1", "\"source\": 99", &["Brushed steel", "normal", "images[99]"]),
        ("\"source\": 1", "\"source\": 1, \"sampler\": 99", &["Brushed steel", "normal", "samplers[99]"]),
        ("\"uri\": \"brushed_normal.png\"", "\"bufferView\": 99", &["Brushed steel", "99"]),
    ] {
        let scene = Scene::new();
        scene.edit(old, new);
        assert_contains(&scene.error_line(&[]), &[&["bad/brushed.gltf: "], parts].concat());
    }
}

#[test]
fn rejects_a_texture_without_an_image() {
    let scene = Scene::new();
    scene.edit("\"source\": 1", "\"name\": \"none\"");
    assert_contains(&scene.error_line(&[]), &["bad/brushed.gltf: ", "Brushed steel", "texture 1", "image"]);
}

#[test]
fn rejects_an_image_beyond_its_buffer() {
    let scene = Scene::new();
    let text = fs::read_to_string(scene.bad("brushed.gltf")).expect("a document");
    let length = fs::metadata(scene.bad("brushed.bin")).expect("a file").len();
    scene.edit(
        "\"bufferViews\": [",
        &format!("\"bufferViews\": [\n    {{ \"buffer\": 0, \"byteOffset\": 8, \"byteLength\": {length} }},"),
    );
    scene.edit("\"uri\": \"brushed_normal.png\"", "\"bufferView\": 0, \"mimeType\": \"image/png\"");
    assert_ne!(text, fs::read_to_string(scene.bad("brushed.gltf")).expect("a document"));
    assert_contains(
        &scene.error_line(&[]),
        &["bad/brushed.gltf: ", "Brushed steel", "buffer view 0", "expected", "found"],
    );
}

#[test]
fn rejects_a_buffer_that_is_too_short() {
    let scene = Scene::new();
    cut_in_half(&scene.bad("brushed.bin"));
    assert_contains(&scene.error_line(&[]), &["bad/brushed.gltf: ", "buffer", "25248", "12624"]);
    assert_contains(&scene.error_line(&["--glb"]), &["bad/brushed.gltf: ", "buffer", "25248", "12624"]);
}
