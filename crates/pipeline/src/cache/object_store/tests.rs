use std::fs;
use std::path::{Path, PathBuf};

use super::*;
use crate::cache::Cache;
use crate::cache::test_assets::{ANY, baked, damaged, id};

fn store_at(folder: &Path) -> ObjectStoreCache {
    ObjectStoreCache::open(url::Url::from_file_path(folder).expect("an absolute path").as_ref()).expect("a folder")
}

fn put(store: &ObjectStoreCache, id: Digest, content: &[u8]) -> Entry {
    let baked = baked(content);
    let entry = Entry::new(id, Path::new("out/a.gltf"), &baked).expect("paths below a folder");
    store.put(&entry, &[&baked.files[0].bytes, &baked.document]).expect("a writable folder");
    entry
}

fn path(folder: &Path, kind: &str, name: Digest) -> PathBuf {
    folder.join(kind).join(format!("{name:.2}")).join(name.to_string())
}

#[test]
fn another_machine_finds_what_was_stored() {
    let folder = tempfile::tempdir().expect("a folder");
    let entry = put(&store_at(folder.path()), id(0), b"texels");
    let other = store_at(folder.path());
    assert_eq!(other.entry(id(0), ANY).expect("an entry"), Some(entry.clone()));
    assert_eq!(other.entry(id(1), ANY).expect("no entry"), None);
    let blobs: Vec<_> =
        other.blobs(&entry.stored().collect::<Vec<_>>()).into_iter().map(|b| b.expect("a blob")).collect();
    assert_eq!(blobs, [Some(b"texels".to_vec()), Some(b"{}".to_vec())]);
    let disk = crate::cache::DiskCache::new(folder.path());
    assert_eq!(disk.entry(id(0), ANY).expect("the same layout"), Some(entry));
}

#[test]
fn existing_objects_are_not_overwritten() {
    let folder = tempfile::tempdir().expect("a folder");
    let entry = put(&store_at(folder.path()), id(0), b"texels");
    let blob = path(folder.path(), "blobs", entry.files[0].blake3);
    fs::write(&blob, "others").expect("a file");
    put(&store_at(folder.path()), id(0), b"texels");
    assert_eq!(fs::read(&blob).expect("a file"), b"others");
}

#[test]
fn damaged_objects_are_reported_and_deleted() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = store_at(folder.path());
    let entry = put(&store, id(0), b"texels");
    let (stored, job) = (&entry.files[0], path(folder.path(), "jobs", id(0)));
    let blob = path(folder.path(), "blobs", stored.blake3);
    for bytes in [&b"Texels"[..], b"texel", b"", &[b't'; 100_000]] {
        fs::write(&blob, bytes).expect("a file");
        assert!(matches!(store.blobs(&[stored])[..], [Err(CacheError::DamagedObject { .. })]));
        assert!(matches!(store.blobs(&[stored])[..], [Ok(None)]));
    }
    let whole = fs::read(&job).expect("a file");
    for bytes in damaged(&whole) {
        fs::write(&job, &bytes).expect("a file");
        assert!(matches!(store.entry(id(0), ANY), Err(CacheError::DamagedObject { .. })), "{}", bytes.escape_ascii());
        assert!(!job.exists());
    }
    put(&store, id(0), b"texels");
    assert!(matches!(&store.blobs(&[stored])[..], [Ok(Some(bytes))] if bytes == b"texels"));
}

#[test]
fn reads_no_more_than_an_entry_declares() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = store_at(folder.path());
    let stored = put(&store, id(0), b"texels").files[0].clone();
    let path = store.path("blobs", stored.blake3);
    fs::write(self::path(folder.path(), "blobs", stored.blake3), vec![0; 1 << 20]).expect("a file");
    let read = store.runtime.block_on(store.bytes(&path, stored.bytes)).expect("bytes").expect("bytes");
    assert!(read.len() < 100_000, "{}", read.len());
}

#[test]
fn several_machines_may_store_one_job_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    std::thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| put(&store_at(folder.path()), id(0), &[7; 100_000]));
        }
    });
    let store = store_at(folder.path());
    let entry = store.entry(id(0), ANY).expect("an entry").expect("an entry");
    assert!(matches!(&store.blobs(&[&entry.files[0]])[..], [Ok(Some(bytes))] if *bytes == [7; 100_000]));
    let names = walkdir::WalkDir::new(folder.path()).into_iter().flatten().filter(|e| e.file_type().is_file()).count();
    assert_eq!(names, 3, "unfinished files are left");
}

#[test]
fn a_store_that_cannot_be_used_is_reported_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("a file");
    let store = store_at(&file);
    let entry = Entry::new(id(0), Path::new("a.gltf"), &baked(b"texels")).expect("paths below a folder");
    let results = [
        store.entry(id(0), ANY).map(|_| ()),
        store.put(&entry, &[b"texels", b"{}"]),
        store.entry(id(0), ANY).map(|_| ()),
    ];
    assert_eq!(results.iter().filter(|result| result.is_err()).count(), 1, "{results:?}");
}

#[test]
fn entries_of_the_store_cannot_name_files_outside_the_disk_cache() {
    let (folder, front) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let entry = put(&store_at(folder.path()), id(0), b"texels");
    let victim = front.path().join("victim");
    fs::write(&victim, "data").expect("a file");
    let url = url::Url::from_file_path(folder.path()).expect("an absolute path");
    let cache = Cache::new(Some(front.path()), Some(url.as_str()), 1 << 20).expect("a cache");
    let job = path(folder.path(), "jobs", id(0));
    for name in [victim.to_str().expect("a path in UTF-8"), "../../victim", "../victim"] {
        let mut forged = serde_json::to_value(&entry).expect("JSON");
        forged["files"][0]["blake3"] = name.into();
        let json = forged.to_string();
        fs::write(&job, format!("{}{json}", digest(json.as_bytes()))).expect("a file");
        let mut warnings = Vec::new();
        let found = cache.entry(id(0), ANY, &mut |warning| warnings.push(warning));
        assert!(found.is_none() && matches!(warnings[..], [CacheError::DamagedObject { .. }]), "{warnings:?}");
        assert!(victim.is_file() && !job.exists());
    }
}

#[test]
fn unusable_entries_are_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = store_at(folder.path());
    let entry = put(&store, id(0), b"texels");
    let job = |number| path(folder.path(), "jobs", id(number));
    fs::create_dir_all(job(1).parent().expect("a folder")).expect("a folder");
    fs::copy(job(0), job(1)).expect("a file");
    assert!(matches!(store.entry(id(1), ANY), Err(CacheError::Foreign { .. })));
    assert!(!job(1).exists());
    let mut earlier = serde_json::to_value(&entry).expect("JSON");
    earlier.as_object_mut().expect("members").retain(|name, _| name != "formatVersion" && name != "job");
    let json = earlier.to_string();
    fs::write(job(0), format!("{}{json}", digest(json.as_bytes()))).expect("a file");
    assert_eq!(store.entry(id(0), ANY).expect("no damage"), None);
    put(&store, id(0), b"texels");
    assert_eq!(store.entry(id(0), ANY).expect("an entry"), Some(entry));
}
