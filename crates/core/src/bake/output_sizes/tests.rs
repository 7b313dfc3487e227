use std::path::PathBuf;

use serde_json::json;

use super::*;
use crate::gltf::json::Json;

#[test]
fn bytes_of_a_glb_are_counted_by_what_its_views_hold() {
    let json = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": 100 }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 20 },
            { "buffer": 0, "byteOffset": 20, "byteLength": 8 },
            { "buffer": 0, "byteOffset": 28, "byteLength": 4 },
        ],
        "images": [{ "bufferView": 0 }, { "bufferView": 1 }, { "bufferView": 2 }, { "bufferView": 1 }],
        "textures": [{ "source": 1, "extensions": { "KHR_texture_basisu": { "source": 0 } } }, { "source": 2 }],
    });
    let mut bin = ::ktx2::MAGIC.to_vec();
    bin.resize(100, 7);
    let document = Document::glb(Json::parse(json.to_string().as_bytes()).unwrap(), Some(bin));
    let bytes = document.to_bytes().unwrap().len();
    let sizes = output_sizes(&document, bytes, &[]).unwrap();
    let expected = OutputSizes { ktx2: 20, fallback: 8, images: 4, geometry: 68, json: bytes as u64 - 100 };
    assert_eq!(sizes, expected);
    assert_eq!(sizes.total(), bytes as u64);
}

#[test]
fn new_files_beside_a_gltf_are_counted_by_their_extensions() {
    let document = Document::gltf(Json::parse(b"{}").unwrap());
    let file = |name: &str, bytes| NewFile::new(PathBuf::from(name), vec![0; bytes]);
    let files = [file("a/n.normal.ktx2", 5), file("a/n.normal.png", 3), file("a/a.bin", 2)];
    let sizes = output_sizes(&document, 2, &files).unwrap();
    assert_eq!(sizes, OutputSizes { ktx2: 5, fallback: 3, images: 0, geometry: 2, json: 2 });
}

#[test]
fn images_in_the_buffer_of_a_glb_that_becomes_a_gltf_are_images() {
    let json = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": 100, "uri": "a.bin" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 20 }, { "buffer": 0, "byteOffset": 20, "byteLength": 30 }],
        "images": [{ "bufferView": 1 }],
    });
    let document = Document::gltf(Json::parse(json.to_string().as_bytes()).unwrap());
    let files = [NewFile::new(PathBuf::from("a.bin"), vec![0; 100])];
    let sizes = output_sizes(&document, 9, &files).unwrap();
    assert_eq!(sizes, OutputSizes { ktx2: 0, fallback: 0, images: 30, geometry: 70, json: 9 });
}
