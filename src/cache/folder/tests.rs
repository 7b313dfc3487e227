use super::*;
use crate::bake::report::AssetReport;
use crate::bake::{Baked, NewFile};
use crate::gltf::document::Container;

fn baked(content: &[u8]) -> Baked {
    Baked {
        document: b"{}".to_vec(),
        container: Container::Gltf,
        files: vec![NewFile { path: PathBuf::from("a.roughcast/a.ktx2"), bytes: content.to_vec() }],
        copies: vec![PathBuf::from("../a.bin")],
        report: AssetReport::default(),
    }
}

fn put(folder: &Folder, id: &str, document: &str, content: &[u8]) {
    let baked = baked(content);
    let entry = Entry::new(Path::new(document), &baked);
    folder.put_blob(&entry.files[0], content).expect("a writable folder");
    folder.put_blob(&entry.document, &baked.document).expect("a writable folder");
    folder.put_entry(id, &entry).expect("a writable folder");
}

fn filled() -> (tempfile::TempDir, Folder, Entry) {
    let folder = tempfile::tempdir().expect("a folder");
    let cache = Folder::new(folder.path());
    put(&cache, "0123", "out/a.gltf", b"texels");
    let entry = cache.entry("0123").expect("an entry").expect("an entry");
    (folder, cache, entry)
}

#[test]
fn what_is_put_is_there() {
    let (_folder, cache, entry) = filled();
    assert_eq!((entry.document.path.as_path(), entry.document.bytes), (Path::new("a.gltf"), 2));
    assert_eq!(entry.copies, [PathBuf::from("../a.bin")]);
    assert_eq!(cache.blob(&entry.files[0].blake3).expect("a blob"), Some(b"texels".to_vec()));
    assert!(cache.entry("4567").expect("no entry").is_none());
}

#[test]
fn damage_is_told_once_and_then_gone() {
    let (_folder, cache, entry) = filled();
    let blob = cache.path("blobs", &entry.files[0].blake3);
    let job = cache.path("jobs", "0123");
    for bytes in [&b"Texels"[..], b"texel", b""] {
        fs::write(&blob, bytes).expect("a file");
        assert!(matches!(cache.blob(&entry.files[0].blake3), Err(CacheError::Damaged { .. })));
        assert_eq!(cache.blob(&entry.files[0].blake3).expect("no blob"), None);
    }
    let whole = fs::read(&job).expect("a file");
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        for bytes in [&bytes[..], &whole[..at]] {
            fs::write(&job, bytes).expect("a file");
            assert!(matches!(cache.entry("0123"), Err(CacheError::Damaged { .. })), "{at}");
            assert!(cache.entry("0123").expect("no entry").is_none());
        }
    }
}

#[test]
fn no_entry_writes_outside_the_output_folder() {
    for path in ["../a.gltf", "/a.gltf", "a/../../b"] {
        let (_folder, cache, mut entry) = filled();
        entry.files[0].path = PathBuf::from(path);
        let json = serde_json::to_vec(&entry).expect("JSON");
        fs::write(cache.path("jobs", "0123"), [digest(&json).as_bytes(), &json].concat()).expect("a file");
        assert!(matches!(cache.entry("0123"), Err(CacheError::Damaged { .. })), "{path}");
    }
}

#[test]
fn what_was_not_used_for_longest_goes_first() {
    let (folder, cache, first) = filled();
    put(&cache, "4567", "out/b.gltf", b"other texels");
    let second = cache.entry("4567").expect("an entry").expect("an entry");
    let old = SystemTime::now() - 2 * MARK_AGE;
    for entry in WalkDir::new(folder.path()).into_iter().flatten().filter(|e| e.file_type().is_file()) {
        fs::File::open(entry.path()).and_then(|f| f.set_modified(old)).expect("a file");
    }
    cache.touch("0123", &first);
    let total: u64 = WalkDir::new(folder.path())
        .into_iter()
        .flatten()
        .filter(|e| e.file_type().is_file())
        .map(|e| e.metadata().expect("facts").len())
        .sum();
    cache.trim(total).expect("a folder");
    assert!(cache.blob(&second.files[0].blake3).expect("a blob").is_some(), "nothing need go");
    cache.trim(total - 1).expect("a folder");
    let gone = cache.entry("4567").expect("no damage").is_none()
        || cache.blob(&second.files[0].blake3).expect("no damage").is_none();
    assert!(gone && cache.entry("0123").expect("an entry").is_some());
    cache.trim(0).expect("a folder");
    assert!(cache.entry("0123").expect("no damage").is_none());
    assert!(Folder::new(&folder.path().join("missing")).trim(0).is_ok());
}
