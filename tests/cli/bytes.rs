//! The same bytes from the same input: golden hashes, thread counts, second runs, and assets without bumps.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::tempdir;

use super::process::{bake, files, fixtures, hashes};

/// Set to 1 to write the hashes of this build instead of comparing with them.
const BLESS: &str = "ROUGHCAST_BLESS";

fn goldens() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/goldens.txt")
}

/// Baked fixtures, in every form for every target whose encoder is ours. (The encoder of `bc` picks its instructions by
/// the processor.) What changes a hash on purpose says so in CHANGELOG.md: caches and version control see it.
#[test]
fn outputs_match_their_golden_hashes() {
    let mut found = String::new();
    for form in ["fallback", "strict", "dual"] {
        for target in ["basis", "float"] {
            let folder = tempdir().expect("a folder");
            let options = ["--gltf", form, "--target", target, "--profile", "both", "--no-provenance"];
            bake(&fixtures(), folder.path(), &options);
            for (name, hash) in hashes(folder.path()) {
                writeln!(found, "{hash}  {form}/{target}/{name}").expect("text");
            }
        }
    }
    if std::env::var(BLESS).as_deref() == Ok("1") {
        fs::write(goldens(), &found).expect("tests/goldens.txt can be written");
    }
    let expected = fs::read_to_string(goldens()).expect("tests/goldens.txt");
    let lines = |text: &str| -> BTreeMap<String, String> {
        text.lines().filter_map(|l| l.split_once("  ")).map(|(hash, name)| (name.into(), hash.into())).collect()
    };
    let (expected, found) = (lines(&expected), lines(&found));
    let differing: Vec<_> = expected
        .keys()
        .chain(found.keys().filter(|name| !expected.contains_key(*name)))
        .filter(|name| expected.get(*name) != found.get(*name))
        .collect();
    assert!(differing.is_empty(), "{BLESS}=1 accepts these changes, which belong into the changelog: {differing:#?}");
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let (one, three) = (tempdir().expect("a folder"), tempdir().expect("a folder"));
    bake(&fixtures(), one.path(), &["--profile", "both", "--threads", "1"]);
    bake(&fixtures(), three.path(), &["--profile", "both", "--threads", "3"]);
    assert_eq!(hashes(one.path()), hashes(three.path()));
}

#[test]
fn a_second_bake_writes_the_same_over_the_first() {
    let folder = tempdir().expect("a folder");
    bake(&fixtures(), folder.path(), &[]);
    let first = hashes(folder.path());
    bake(&fixtures(), folder.path(), &[]);
    assert_eq!(hashes(folder.path()), first);
}

#[test]
fn an_asset_without_bumps_comes_back_byte_for_byte() {
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

/// A GLB without a BIN chunk.
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
