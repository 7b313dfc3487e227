use std::fs;
use std::path::{Path, PathBuf};

use super::*;
use crate::bake::report::AssetReport;
use crate::bake::{Baked, NewFile};
use crate::gltf::document::Container;

fn baked(content: &[u8]) -> Baked {
    Baked {
        document: b"{}".to_vec(),
        container: Container::Gltf,
        files: vec![NewFile { path: PathBuf::from("a.roughcast/a.ktx2"), bytes: content.to_vec() }],
        copies: Vec::new(),
        report: AssetReport::default(),
    }
}

fn shared(folder: &Path) -> Shared {
    Shared::open(url::Url::from_file_path(folder).expect("an absolute path").as_ref()).expect("a folder")
}

fn put(shared: &Shared, id: &str, content: &[u8]) -> Entry {
    let baked = baked(content);
    let entry = Entry::new(Path::new("out/a.gltf"), &baked);
    shared.put(id, &entry, &[&baked.files[0].bytes, &baked.document]).expect("a writable folder");
    entry
}

fn path(folder: &Path, kind: &str, name: &str) -> PathBuf {
    folder.join(kind).join(&name[..2]).join(name)
}

#[test]
fn what_one_machine_puts_another_finds() {
    let folder = tempfile::tempdir().expect("a folder");
    let entry = put(&shared(folder.path()), "0123", b"texels");
    let other = shared(folder.path());
    assert_eq!(other.entry("0123").expect("an entry"), Some(entry.clone()));
    assert_eq!(other.entry("4567").expect("no entry"), None);
    let blobs: Vec<_> =
        other.blobs(&entry.stored().collect::<Vec<_>>()).into_iter().map(|b| b.expect("a blob")).collect();
    assert_eq!(blobs, [Some(b"texels".to_vec()), Some(b"{}".to_vec())]);
    let folders = crate::cache::Folder::new(folder.path());
    assert_eq!(folders.entry("0123").expect("the same layout"), Some(entry));
}

#[test]
fn what_is_there_is_not_written_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let entry = put(&shared(folder.path()), "0123", b"texels");
    let blob = path(folder.path(), "blobs", &entry.files[0].blake3);
    fs::write(&blob, "others").expect("a file");
    put(&shared(folder.path()), "0123", b"texels");
    assert_eq!(fs::read(&blob).expect("a file"), b"others");
}

#[test]
fn damage_is_told_once_and_then_gone() {
    let folder = tempfile::tempdir().expect("a folder");
    let shared = shared(folder.path());
    let entry = put(&shared, "0123", b"texels");
    let (stored, job) = (&entry.files[0], path(folder.path(), "jobs", "0123"));
    let blob = path(folder.path(), "blobs", &stored.blake3);
    for bytes in [&b"Texels"[..], b"texel", b"", &[b't'; 100_000]] {
        fs::write(&blob, bytes).expect("a file");
        assert!(matches!(shared.blobs(&[stored])[..], [Err(CacheError::DamagedObject { .. })]));
        assert!(matches!(shared.blobs(&[stored])[..], [Ok(None)]));
    }
    let whole = fs::read(&job).expect("a file");
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        for bytes in [&bytes[..], &whole[..at]] {
            fs::write(&job, bytes).expect("a file");
            assert!(matches!(shared.entry("0123"), Err(CacheError::DamagedObject { .. })), "{at}");
            assert!(!job.exists());
        }
    }
    put(&shared, "0123", b"texels");
    assert!(matches!(&shared.blobs(&[stored])[..], [Ok(Some(bytes))] if bytes == b"texels"));
}

#[test]
fn no_more_is_read_than_an_entry_declares() {
    let folder = tempfile::tempdir().expect("a folder");
    let shared = shared(folder.path());
    let stored = put(&shared, "0123", b"texels").files[0].clone();
    let path = shared.path("blobs", &stored.blake3);
    fs::write(folder.path().join("blobs").join(&stored.blake3[..2]).join(&stored.blake3), vec![0; 1 << 20])
        .expect("a file");
    let read = shared.runtime.block_on(shared.bytes(&path, stored.bytes)).expect("bytes").expect("bytes");
    assert!(read.len() < 100_000, "{}", read.len());
}

#[test]
fn many_at_once_put_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    std::thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| put(&shared(folder.path()), "0123", &[7; 100_000]));
        }
    });
    let entry = shared(folder.path()).entry("0123").expect("an entry").expect("an entry");
    assert!(
        matches!(&shared(folder.path()).blobs(&[&entry.files[0]])[..], [Ok(Some(bytes))] if *bytes == [7; 100_000])
    );
    let names = walkdir::WalkDir::new(folder.path()).into_iter().flatten().filter(|e| e.file_type().is_file()).count();
    assert_eq!(names, 3, "leftovers");
}

#[test]
fn a_folder_that_is_a_file_is_told_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("a file");
    let shared = shared(&file);
    let entry = Entry::new(Path::new("a.gltf"), &baked(b"texels"));
    let told = [
        shared.entry("0123").map(|_| ()),
        shared.put("0123", &entry, &[b"texels", b"{}"]),
        shared.entry("0123").map(|_| ()),
    ];
    assert_eq!(told.iter().filter(|told| told.is_err()).count(), 1, "{told:?}");
}
