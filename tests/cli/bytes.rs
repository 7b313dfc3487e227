//! Tests that equal inputs give equal bytes: for any number of threads, in a second run, and for assets without bumps.

use std::fs;
use std::path::Path;

use tempfile::tempdir;

use super::process::{bake, files, fixtures, hashes};

#[test]
fn bytes_do_not_depend_on_threads() {
    let (one, three) = (tempdir().expect("a folder"), tempdir().expect("a folder"));
    bake(&fixtures(), one.path(), &["--profile", "both", "--gltf", "fallback", "--threads", "1"]);
    bake(&fixtures(), three.path(), &["--profile", "both", "--gltf", "fallback", "--threads", "3"]);
    assert_eq!(hashes(one.path()), hashes(three.path()));
}

#[test]
fn a_second_bake_writes_equal_bytes() {
    let folder = tempdir().expect("a folder");
    bake(&fixtures(), folder.path(), &["--gltf", "fallback"]);
    let first = hashes(folder.path());
    bake(&fixtures(), folder.path(), &["--gltf", "fallback"]);
    assert_eq!(hashes(folder.path()), first);
}

#[test]
fn an_asset_without_bumps_is_copied_byte_for_byte() {
    let (source, baked) = (tempdir().expect("a folder"), tempdir().expect("a folder"));
    let text = "{ \"asset\" : {\"version\":\"2.0\"},\n\t\"images\":[{\"uri\":\"a%20picture.png\"}],\r\n \
        \"textures\" : [ {\"source\":0} ], \"materials\":[{\"extras\":{\"n\":[1.50,1e+3,-0.0]},\
        \"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}],\"extensionsUsed\":[\"EXT_unknown\"],\
        \"extensions\":{\"EXT_unknown\":{\"a\":1,\"\\u0061\":2}}}\n\n";
    fs::write(source.path().join("plain.gltf"), text).expect("a file");
    let picture = fixtures().join("brushed/brushed_colour.png");
    fs::copy(picture, source.path().join("a picture.png")).expect("a file");
    fs::write(source.path().join("plain.glb"), glb(text)).expect("a file");
    for name in ["plain.gltf", "plain.glb"] {
        let run = bake(&source.path().join(name), baked.path(), &["--gltf", "strict"]);
        assert!(run.out.starts_with("copied "), "{}", run.out);
        let read = |folder: &Path| fs::read(folder.join(name)).expect("a document");
        assert!(read(source.path()) == read(baked.path()), "{name}");
    }
    assert_eq!(hashes(source.path()), hashes(baked.path()));
    assert_eq!(files(baked.path()).len(), 3);
}

/// Returns a GLB without a BIN chunk.
fn glb(text: &str) -> Vec<u8> {
    let json = format!("{text:width$}", width = text.len().next_multiple_of(4));
    let mut bytes = b"glTF".to_vec();
    for number in [2, 20 + json.len() as u32, json.len() as u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(json.bytes());
    bytes
}
