//! Identity, edits and damage of both containers.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::{Container, Document, DocumentError, check_version};
use crate::gltf::json::Json;
use crate::image::FileFormat;

const TEXT: &str = "{ \"asset\": {\"version\":\"2.0\"},\n\"buffers\":[{\"byteLength\":6 }], \"odd\":1.0e+00 }";

fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    [&(data.len() as u32).to_le_bytes(), &kind[..], data].concat()
}

fn glb(chunks: &[Vec<u8>]) -> Vec<u8> {
    let body = chunks.concat();
    [b"glTF", &2u32.to_le_bytes(), &(12 + body.len() as u32).to_le_bytes(), &body[..]].concat()
}

/// Returns `text` padded with spaces, and four more spaces than the format needs.
fn padded(text: &str) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize(text.len().next_multiple_of(4) + 4, b' ');
    bytes
}

/// Returns a GLB with padding, a BIN chunk, two chunks of unknown types, and a second BIN chunk.
fn rich() -> Vec<u8> {
    let bin = chunk(b"BIN\0", &[1, 2, 3, 4, 5, 6, 77, 88]);
    glb(&[chunk(b"JSON", &padded(TEXT)), bin, chunk(b"WHAT", b"ever"), chunk(b"NONE", b""), chunk(b"BIN\0", b"more")])
}

fn parse(bytes: &[u8]) -> Document {
    Document::parse(bytes).expect("a document")
}

fn message(bytes: &[u8]) -> String {
    Document::parse(bytes).expect_err("no document").to_string()
}

fn text_of(value: &Value) -> Vec<u8> {
    value.to_string().into_bytes()
}

#[test]
fn unedited_files_keep_every_byte() {
    let zeros = [rich(), vec![0; 7]].concat();
    for (bytes, container) in
        [(rich(), Container::Glb), (zeros, Container::Glb), (TEXT.as_bytes().to_vec(), Container::Gltf)]
    {
        let document = parse(&bytes);
        assert_eq!(document.container(), container);
        assert_eq!(document.to_bytes().unwrap(), bytes);
    }
    assert_eq!(parse(&rich()).bin(), Some(&[1, 2, 3, 4, 5, 6, 77, 88][..]));
    assert_eq!(parse(TEXT.as_bytes()).bin(), None);
}

#[test]
fn editing_the_json_of_a_glb_keeps_its_other_chunks() {
    for name in ["a", "ab", "abc", "abcd"] {
        let mut document = parse(&rich());
        document.json_mut().set("/asset/generator", name).unwrap();
        let bytes = document.to_bytes().unwrap();
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        assert_eq!(length % 4, 0);
        assert_eq!(u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize, bytes.len());
        assert_eq!(bytes[20 + length..], rich()[20 + padded(TEXT).len()..]);
        let json = std::str::from_utf8(&bytes[20..20 + length]).unwrap();
        let edited = TEXT.replace("\"2.0\"", &format!("\"2.0\", \"generator\":\"{name}\""));
        assert_eq!(json.trim_end_matches(' '), edited);
        // The old padding is kept if it still fits. Otherwise there is only the needed padding.
        let kept = edited.len() + padded(TEXT).len() - TEXT.len();
        let needed = edited.len().next_multiple_of(4);
        assert_eq!(length, if kept.is_multiple_of(4) { kept } else { needed });
        assert_eq!(parse(&bytes).to_bytes().unwrap(), bytes);
    }
}

#[test]
fn another_reader_reads_the_written_file() {
    let json = Json::parse(TEXT.as_bytes()).unwrap();
    let written = Document::glb(json, Some(vec![1, 2, 3, 4, 5, 6])).to_bytes().unwrap();
    let read = ::gltf::binary::Glb::from_slice(&written).unwrap();
    assert_eq!(serde_json::from_slice::<Value>(&read.json).unwrap(), serde_json::from_str::<Value>(TEXT).unwrap());
    assert_eq!(*read.bin.unwrap(), [1, 2, 3, 4, 5, 6, 0, 0]);
}

#[test]
fn appended_data_begins_at_a_multiple_of_four() {
    let mut document = parse(&rich());
    assert_eq!(document.append_bin(b"abcde").unwrap(), (8, 5));
    assert_eq!(document.append_bin(b"").unwrap(), (16, 0));
    assert_eq!(document.append_bin(b"xyz").unwrap(), (16, 3));
    let again = parse(&document.to_bytes().unwrap());
    assert_eq!(again.bin().unwrap(), b"\x01\x02\x03\x04\x05\x06\x4d\x58abcde\0\0\0xyz\0");
    assert_eq!(again.json().to_string().trim_end(), TEXT.replace(":6 ", ":19 "));
}

#[test]
fn the_first_appended_data_creates_the_buffer() {
    let json = Json::parse(br#"{"asset":{}}"#).unwrap();
    let mut document = Document::glb(json, None);
    assert_eq!(document.append_bin(b"abc").unwrap(), (0, 3));
    let again = parse(&document.to_bytes().unwrap());
    assert_eq!(again.json().to_string().trim_end(), r#"{"asset":{},"buffers":[{"byteLength":3}]}"#);
    assert_eq!(again.bin(), Some(&b"abc\0"[..]));
}

#[test]
fn does_not_append_to_a_buffer_that_is_not_the_bin_chunk() {
    let json = |text: &str| Json::parse(text.as_bytes()).unwrap();
    let external = json(r#"{"buffers":[{"uri":"a.bin","byteLength":4}]}"#);
    let longer = json(r#"{"buffers":[{"byteLength":9}]}"#);
    for mut document in [
        Document::glb(external.clone(), None),
        Document::glb(external, Some(vec![0; 8])),
        Document::glb(longer.clone(), Some(vec![0; 8])),
        Document::glb(longer, None),
        Document::glb(json("{}"), Some(vec![0; 8])),
    ] {
        let before = document.to_bytes().unwrap();
        assert!(matches!(document.append_bin(b"x"), Err(DocumentError::NoBinBuffer)));
        assert_eq!(document.to_bytes().unwrap(), before);
    }
    assert!(matches!(Document::gltf(json("{}")).append_bin(b"x"), Err(DocumentError::NotGlb)));
    let wrong = json(r#"{"buffers":[{"byteLength":-1}]}"#);
    assert!(matches!(Document::glb(wrong, None).append_bin(b"x"), Err(DocumentError::Json(_))));
}

#[test]
fn buffer_views_stay_inside_their_buffers() {
    let document = parse(&text_of(&json!({
        "buffers": [{"byteLength": 4}, {"byteLength": 10, "uri": "a.bin"}],
        "bufferViews": [
            {"buffer": 1, "byteOffset": 2, "byteLength": 8},
            {"buffer": 0, "byteLength": 4},
            {"buffer": 1, "byteOffset": 3, "byteLength": 8},
            {"buffer": 1, "byteOffset": u64::MAX, "byteLength": 2},
            {"buffer": 2, "byteLength": 0},
            {"buffer": 0, "byteOffset": -1, "byteLength": 1},
            {"buffer": 0, "byteLength": 1.5},
            {"byteLength": 1},
        ],
    })));
    assert_eq!(document.buffer_view(0).unwrap(), (1, 2..10));
    assert_eq!(document.buffer_view(1).unwrap(), (0, 0..4));
    assert_eq!(
        document.buffer_view(2).unwrap_err().to_string(),
        "buffer view 2: expected its 8 bytes from byte 3 on within the 10 bytes of buffer 1, found an end beyond them"
    );
    assert!(matches!(document.buffer_view(3), Err(DocumentError::ViewOutside { .. })));
    let nothing = |pointer: &str| format!("nothing at \"{pointer}\": the index is past the end of its array");
    assert_eq!(document.buffer_view(4).unwrap_err().to_string(), nothing("/buffers/2"));
    assert_eq!(document.buffer_view(8).unwrap_err().to_string(), nothing("/bufferViews/8"));
    for wrong in 5..8 {
        assert!(matches!(document.buffer_view(wrong), Err(DocumentError::Json(_))), "{wrong}");
    }
}

#[test]
fn the_last_of_repeated_keys_counts() {
    let text =
        r#"{"buffers":[{"byteLength":1,"byteLength":6}],"bufferViews":[{"buffer":0,"buffer":0,"byteLength":6}]}"#;
    assert_eq!(parse(text.as_bytes()).buffer_view(0).unwrap(), (0, 0..6));
}

#[test]
fn every_truncation_is_an_error() {
    let bytes = rich();
    for end in 0..bytes.len() {
        assert!(Document::parse(&bytes[..end]).is_err(), "{end} bytes");
        // With a corrected length, only a cut between two chunks leaves a valid file.
        if end >= 12 {
            let mut cut = bytes[..end].to_vec();
            cut[8..12].copy_from_slice(&(end as u32).to_le_bytes());
            let chunks_end = 20 + padded(TEXT).len();
            let between = [chunks_end, chunks_end + 16, chunks_end + 28, chunks_end + 36];
            assert_eq!(Document::parse(&cut).is_ok(), between.contains(&end), "{end} bytes");
        }
    }
}

#[test]
fn names_the_damage_of_a_file() {
    let json = chunk(b"JSON", b"{}  ");
    let with = |at: usize, value: u32| {
        let mut bytes = glb(std::slice::from_ref(&json));
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    for (bytes, expected) in [
        (b"glTF".to_vec(), "expected 12 bytes of GLB, found 4; the file is cut short"),
        (with(4, 1), "expected GLB version 2, found 1; export the asset as glTF 2.0"),
        (with(8, 25), "expected 25 bytes of GLB, found 24; the file is cut short"),
        (with(8, u32::MAX), "expected 4294967295 bytes of GLB, found 24; the file is cut short"),
        (with(8, 0), "expected 0 bytes as the GLB header declares, found 24; export the file again"),
        (with(8, 20), "expected 20 bytes as the GLB header declares, found 24; export the file again"),
        (with(12, 8), "expected 16 bytes for the GLB chunk at byte 12, found 12; the file is damaged"),
        (
            with(12, u32::MAX - 3),
            "expected 4294967300 bytes for the GLB chunk at byte 12, found 12; the file is damaged",
        ),
        (
            with(12, 3),
            "expected a multiple of 4 as the length of the GLB chunk at byte 12, found 3; export the file again",
        ),
        (with(16, 0), "expected a JSON chunk first in the GLB, found \\x00\\x00\\x00\\x00; the file is damaged"),
        (with(20, 0), "JSON: line 1, column 1: expected a value, found U+0000; fix the text there, or export it again"),
        (glb(&[]), "expected a JSON chunk first in the GLB, found nothing; the file is damaged"),
        (
            glb(&[chunk(b"BIN\0", b""), json.clone()]),
            "expected a JSON chunk first in the GLB, found BIN\\x00; the file is damaged",
        ),
        (b"{\"\xff\"}".to_vec(), "JSON: line 1, column 3: expected UTF-8, found other bytes; save the file as UTF-8"),
    ] {
        assert_eq!(message(&bytes), expected);
    }
}

#[test]
fn names_other_formats_and_what_to_do() {
    const EXPORT: &str = "; export the scene as glTF 2.0 (.glb or .gltf)";
    for (bytes, found) in [
        (&b"<?xml version=\"1.0\"?>"[..], "an XML file"),
        (b"null", "a file that starts with \"null\""),
        (b"[]", "a file that starts with \"[]\""),
        (b"\"x\"", "a file that starts with \"\\\"x\\\"\""),
        (b"glT", "a file that starts with \"glT\""),
        (b"\x01\x02", "a file that starts with \"\\x01\\x02\""),
    ] {
        assert_eq!(message(bytes), format!("expected a GLB or a JSON object, found {found}{EXPORT}"));
    }
    for (bytes, found) in [
        (&b"Kaydara FBX Binary  \0"[..], "an FBX file"),
        (b"# Blender 4.2\nv 0 0 0\n", "a text such as an OBJ file"),
        (b"PXR-USDC\0", "a USD file"),
    ] {
        assert_eq!(message(bytes), format!("expected a glTF document, found {found}{EXPORT}"));
    }
    for (bytes, format) in [
        (&b"\x89PNG\r\n\x1a\n"[..], FileFormat::Png),
        (b"\xff\xd8\xff\xe0", FileFormat::Jpeg),
        (b"#?RADIANCE\n", FileFormat::Hdr),
    ] {
        let remedy = "name the .gltf or .glb that uses it, or bake it by itself with `roughcast map`";
        assert_eq!(message(bytes), format!("expected a glTF document, found an image ({format}); {remedy}"));
    }
    assert_eq!(message(b""), "expected a glTF document, found an empty file; copy or export it again");
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n";
    let expected = "expected a glTF document, found a Git LFS pointer instead of the file; run `git lfs pull`";
    assert_eq!(message(pointer), expected);
}

#[test]
fn rejects_documents_of_other_versions() {
    let check = |asset: &str| check_version(&serde_json::from_str(asset).unwrap()).map_err(|e| e.to_string());
    for fine in ["2.0", "2.1", "2.10"] {
        assert_eq!(check(&format!(r#"{{"asset":{{"version":"{fine}","minVersion":"2.0"}}}}"#)), Ok(()));
    }
    for (text, found) in [
        ("null", "JSON that is no object"),
        ("[]", "JSON that is no object"),
        ("{}", "no \"asset\""),
        (r#"{"asset":{}}"#, "an \"asset\" without \"version\""),
        (r#"{"asset":{"version":2.0}}"#, "the version 2.0"),
        (r#"{"asset":{"version":"1.0"}}"#, "expected glTF 2.0, found \"1.0\" as asset.version"),
        (r#"{"asset":{"version":"99"}}"#, "expected glTF 2.0, found \"99\" as asset.version"),
        (r#"{"asset":{"version":"2."}}"#, "expected glTF 2.0, found \"2.\" as asset.version"),
        (r#"{"asset":{"version":"2.0","minVersion":"2.1"}}"#, "found \"2.1\" as asset.minVersion"),
        (r#"{"asset":{"version":"2.0","minVersion":2}}"#, "found 2 as asset.minVersion"),
    ] {
        let message = check(text).unwrap_err();
        assert!(message.contains(found) && message.ends_with("(.glb or .gltf)"), "{message}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_do_not_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        data: Vec<u8>,
    ) {
        let mut bytes = rich();
        for (at, byte) in edits {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        for bytes in [bytes, [b"glTF\x02\0\0\0", &data[..]].concat()] {
            let Ok(mut document) = Document::parse(&bytes) else { continue };
            prop_assert_eq!(document.to_bytes().unwrap(), bytes);
            let _ = document.buffer_view(0);
            if document.append_bin(&data).is_ok() {
                let written = document.to_bytes().unwrap();
                prop_assert_eq!(parse(&written).to_bytes().unwrap(), written);
            }
        }
    }
}
