use super::*;

/// Accessors in views 0 and 3, a replaced image in view 1 and another one in view 2.
fn document() -> Value {
    json!({
        "accessors": [
            { "bufferView": 0 },
            { "bufferView": 3, "sparse": { "indices": { "bufferView": 3 }, "values": { "bufferView": 4 } } },
        ],
        "meshes": [{ "primitives": [{ "extensions": { "KHR_draco_mesh_compression": { "bufferView": 3 } } }] }],
        "images": [{ "uri": "new.png" }, { "bufferView": 2 }],
        "buffers": [{ "byteLength": 300 }, { "byteLength": 8, "uri": "a.bin" }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 100 },
            { "buffer": 0, "byteOffset": 100, "byteLength": 121 },
            { "buffer": 0, "byteOffset": 224, "byteLength": 30 },
            { "buffer": 0, "byteOffset": 256, "byteLength": 44 },
            { "buffer": 1, "byteLength": 8 },
        ],
    })
}

/// Returns bytes that encode their offsets, with zeros between views.
fn bytes() -> Vec<u8> {
    let is_padding = |i: usize| (221..224).contains(&i) || (254..256).contains(&i);
    (0..300).map(|i| if is_padding(i) { 0 } else { 1 + (i % 255) as u8 }).collect()
}

/// Compacts `root`, whose images were in views 1 and 2 before.
fn compacted(root: &Value, bin: Vec<u8>) -> (Value, Option<Vec<u8>>) {
    let before = json!({ "images": [{ "bufferView": 1 }, { "bufferView": 2 }] });
    let before = Json::parse(before.to_string().as_bytes()).unwrap();
    let mut json = Json::parse(root.to_string().as_bytes()).unwrap();
    let bin = compact(&mut json, &before, bin).unwrap();
    (json.value("").unwrap().unwrap(), bin)
}

/// Returns the bytes of view `index`.
fn bytes_of_view<'b>(root: &Value, bin: &'b [u8], index: usize) -> &'b [u8] {
    let view = View::deserialize(&root["bufferViews"][index]).unwrap();
    &bin[view.range().unwrap()]
}

#[test]
fn removes_views_of_replaced_images_with_their_bytes() {
    let (root, bin) = compacted(&document(), bytes());
    let bin = bin.unwrap();
    assert_eq!(root["bufferViews"].as_array().unwrap().len(), 4);
    assert_eq!(root["images"][1]["bufferView"], 1);
    assert_eq!(root["accessors"][0]["bufferView"], 0);
    assert_eq!(
        root["accessors"][1],
        json!({ "bufferView": 2, "sparse": { "indices": { "bufferView": 2 }, "values": { "bufferView": 3 } } })
    );
    let draco = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/bufferView";
    assert_eq!(root.pointer(draco), Some(&json!(2)));
    for (now, before) in [(0, 0..100), (1, 224..254), (2, 256..300)] {
        assert_eq!(bytes_of_view(&root, &bin, now), &bytes()[before.clone()], "view {now}");
        assert_eq!(root["bufferViews"][now]["byteOffset"].as_u64().unwrap_or(0) % 8, before.start as u64 % 8);
    }
    assert_eq!(root["bufferViews"][3], json!({ "buffer": 1, "byteLength": 8 }));
    assert_eq!((root["buffers"][0]["byteLength"].as_u64(), bin.len()), (Some(180), 180));
}

#[test]
fn keeps_the_numbers_of_views_beside_an_unknown_extension() {
    let mut before = document();
    before["extensionsUsed"] = json!(["EXT_structural_metadata"]);
    before["extensions"] = json!({ "EXT_structural_metadata": { "propertyTables": [{ "values": 3 }] } });
    let (root, bin) = compacted(&before, bytes());
    let bin = bin.unwrap();
    assert_eq!(root["bufferViews"].as_array().unwrap().len(), 5);
    assert_eq!(root["bufferViews"][1], json!({ "buffer": 0, "byteLength": 1 }));
    assert_eq!((root["accessors"].clone(), bin.len()), (before["accessors"].clone(), 180));
    assert_eq!(bytes_of_view(&root, &bin, 3), &bytes()[256..300]);
}

#[test]
fn moves_compressed_views() {
    let mut root = document();
    let compressed = json!({ "buffer": 0, "byteOffset": 256, "byteLength": 20, "byteStride": 4, "count": 11 });
    root["bufferViews"][3] = json!({
        "buffer": 1, "byteLength": 44, "extensions": { "EXT_meshopt_compression": compressed },
    });
    let (root, bin) = compacted(&root, bytes());
    let moved = &root["bufferViews"][2]["extensions"]["EXT_meshopt_compression"];
    let offset = moved["byteOffset"].as_u64().unwrap() as usize;
    assert_eq!(&bin.unwrap()[offset..offset + 20], &bytes()[256..276]);
    assert_eq!(root["bufferViews"][2]["buffer"], 1);
}

#[test]
fn keeps_bytes_that_another_view_shares() {
    let mut root = document();
    root["accessors"][0]["bufferView"] = json!(5);
    let shared = json!({ "buffer": 0, "byteOffset": 90, "byteLength": 20 });
    root["bufferViews"].as_array_mut().unwrap().push(shared);
    let (root, bin) = compacted(&root, bytes());
    assert_eq!(bytes_of_view(&root, &bin.unwrap(), 4), &bytes()[90..110]);
}

#[test]
fn keeps_bytes_that_no_view_names() {
    let mut root = document();
    root["bufferViews"][0]["byteLength"] = json!(60);
    let (_, bin) = compacted(&root, bytes());
    assert_eq!(bin.unwrap()[..100], bytes()[..100]);
}

#[test]
fn removes_a_buffer_that_held_only_replaced_images() {
    let root = json!({
        "images": [{ "uri": "new.png" }],
        "buffers": [{ "byteLength": 20 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 20 }],
    });
    let before = Json::parse(br#"{"images":[{"bufferView":0}]}"#).unwrap();
    let mut json = Json::parse(root.to_string().as_bytes()).unwrap();
    assert_eq!(compact(&mut json, &before, vec![1; 20]).unwrap(), None);
    assert_eq!(json.value("").unwrap().unwrap(), json!({ "images": [{ "uri": "new.png" }] }));
}

#[test]
fn leaves_buffers_unchanged_that_cannot_be_moved() {
    let mut pointing = document();
    pointing["extensions"] = json!({ "EXT_tables": { "buffer": 0, "byteOffset": 100 } });
    let mut beyond = document();
    beyond["bufferViews"][3]["byteLength"] = json!(45);
    let mut used = document();
    used["images"][0] = json!({ "bufferView": 1 });
    for root in [pointing, beyond, used] {
        assert_eq!(compacted(&root, bytes()), (root, Some(bytes())));
    }
}
