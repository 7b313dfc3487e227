use super::*;
use crate::gltf::document::Document;
use serde_json::json;
use std::sync::Mutex;

/// Makes a reader of files of 64 bytes, and returns the paths that were read.
fn with_reader(root: &Value, keeps_all: bool, then: impl FnOnce(Result<Reader<'_>, SourceError>)) -> Vec<PathBuf> {
    let reads = Mutex::new(Vec::new());
    let files = |path: &Path| {
        reads.lock().unwrap().push(path.to_owned());
        Ok(vec![7; 64])
    };
    let document = Document::parse(root.to_string().as_bytes()).unwrap();
    then(Reader::new(&Source::new("a", &document, &files), root, keeps_all));
    reads.into_inner().unwrap()
}

#[test]
fn a_buffer_is_read_once_for_all_images_in_it() {
    let view = |buffer: usize, offset: usize| json!({ "buffer": buffer, "byteOffset": offset, "byteLength": 8 });
    let root = json!({
        "buffers": [{ "uri": "a.bin", "byteLength": 64 }, { "uri": "a.bin", "byteLength": 32 }],
        "bufferViews": [view(0, 0), view(0, 8), view(1, 16)],
        "images": [{ "bufferView": 0 }, { "bufferView": 1 }, { "bufferView": 2 }],
    });
    let reads = with_reader(&root, false, |reader| {
        let reader = reader.unwrap();
        for view in 0..3 {
            assert_eq!(*reader.image(&ImageLocation::BufferView(view)).unwrap(), [7; 8]);
        }
        assert_eq!(reader.digest(Path::new("a.bin")), Some(digest(&[7; 64])));
    });
    assert_eq!(reads, [Path::new("a.bin")]);
}

#[test]
fn a_file_is_read_once_for_all_buffers_in_it() {
    let buffers = vec![json!({ "uri": "a.bin", "byteLength": 64 }); 10_000];
    let root = json!({ "buffers": buffers });
    for keeps_all in [false, true] {
        let reads = with_reader(&root, keeps_all, |reader| {
            assert_eq!(reader.unwrap().buffer(9_999).is_ok(), keeps_all);
        });
        assert_eq!(reads.len(), 1);
    }
}

#[test]
fn reports_a_short_buffer() {
    let root = json!({ "buffers": [{ "uri": "a.bin", "byteLength": 65 }] });
    with_reader(&root, false, |reader| {
        let error = reader.err().unwrap();
        assert!(matches!(error, SourceError::ShortBuffer { buffer: 0, expected: 65, found: 64 }), "{error}");
    });
}
