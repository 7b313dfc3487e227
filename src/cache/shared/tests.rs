use std::fs;
use std::path::{Path, PathBuf};

use super::*;
use crate::bake::{Baked, NewFile};
use crate::cache::Cache;
use crate::gltf::document::Container;
use crate::report::AssetReport;

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

/// The id of a job.
fn id(number: u8) -> Digest {
    digest(&[number])
}

const ANY: Fits<'_> = &|_| Ok(());

fn put(shared: &Shared, id: Digest, content: &[u8]) -> Entry {
    let baked = baked(content);
    let entry = Entry::new(id, Path::new("out/a.gltf"), &baked).expect("paths below a folder");
    shared.put(&entry, &[&baked.files[0].bytes, &baked.document]).expect("a writable folder");
    entry
}

fn path(folder: &Path, kind: &str, name: Digest) -> PathBuf {
    folder.join(kind).join(format!("{name:.2}")).join(name.to_string())
}

#[test]
fn what_one_machine_puts_another_finds() {
    let folder = tempfile::tempdir().expect("a folder");
    let entry = put(&shared(folder.path()), id(0), b"texels");
    let other = shared(folder.path());
    assert_eq!(other.entry(id(0), ANY).expect("an entry"), Some(entry.clone()));
    assert_eq!(other.entry(id(1), ANY).expect("no entry"), None);
    let blobs: Vec<_> =
        other.blobs(&entry.stored().collect::<Vec<_>>()).into_iter().map(|b| b.expect("a blob")).collect();
    assert_eq!(blobs, [Some(b"texels".to_vec()), Some(b"{}".to_vec())]);
    let folders = crate::cache::Folder::new(folder.path());
    assert_eq!(folders.entry(id(0), ANY).expect("the same layout"), Some(entry));
}

#[test]
fn what_is_there_is_not_written_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let entry = put(&shared(folder.path()), id(0), b"texels");
    let blob = path(folder.path(), "blobs", entry.files[0].blake3);
    fs::write(&blob, "others").expect("a file");
    put(&shared(folder.path()), id(0), b"texels");
    assert_eq!(fs::read(&blob).expect("a file"), b"others");
}

#[test]
fn damage_is_told_once_and_then_gone() {
    let folder = tempfile::tempdir().expect("a folder");
    let shared = shared(folder.path());
    let entry = put(&shared, id(0), b"texels");
    let (stored, job) = (&entry.files[0], path(folder.path(), "jobs", id(0)));
    let blob = path(folder.path(), "blobs", stored.blake3);
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
            assert!(matches!(shared.entry(id(0), ANY), Err(CacheError::DamagedObject { .. })), "{at}");
            assert!(!job.exists());
        }
    }
    put(&shared, id(0), b"texels");
    assert!(matches!(&shared.blobs(&[stored])[..], [Ok(Some(bytes))] if bytes == b"texels"));
}

#[test]
fn no_more_is_read_than_an_entry_declares() {
    let folder = tempfile::tempdir().expect("a folder");
    let shared = shared(folder.path());
    let stored = put(&shared, id(0), b"texels").files[0].clone();
    let path = shared.path("blobs", stored.blake3);
    fs::write(self::path(folder.path(), "blobs", stored.blake3), vec![0; 1 << 20]).expect("a file");
    let read = shared.runtime.block_on(shared.bytes(&path, stored.bytes)).expect("bytes").expect("bytes");
    assert!(read.len() < 100_000, "{}", read.len());
}

#[test]
fn many_at_once_put_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    std::thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| put(&shared(folder.path()), id(0), &[7; 100_000]));
        }
    });
    let entry = shared(folder.path()).entry(id(0), ANY).expect("an entry").expect("an entry");
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
    let entry = Entry::new(id(0), Path::new("a.gltf"), &baked(b"texels")).expect("paths below a folder");
    let told = [
        shared.entry(id(0), ANY).map(|_| ()),
        shared.put(&entry, &[b"texels", b"{}"]),
        shared.entry(id(0), ANY).map(|_| ()),
    ];
    assert_eq!(told.iter().filter(|told| told.is_err()).count(), 1, "{told:?}");
}

#[test]
fn an_entry_of_the_store_names_no_file_of_the_folder_in_front() {
    let (store, front) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let entry = put(&shared(store.path()), id(0), b"texels");
    let victim = front.path().join("victim");
    fs::write(&victim, "data").expect("a file");
    let url = url::Url::from_file_path(store.path()).expect("an absolute path");
    let cache = Cache::new(Some(front.path()), Some(url.as_str()), 1 << 20).expect("a cache");
    let job = path(store.path(), "jobs", id(0));
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
fn an_entry_of_another_job_or_format_makes_way_for_a_new_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let shared = shared(folder.path());
    let entry = put(&shared, id(0), b"texels");
    let job = |number| path(folder.path(), "jobs", id(number));
    fs::create_dir_all(job(1).parent().expect("a folder")).expect("a folder");
    fs::copy(job(0), job(1)).expect("a file");
    assert!(matches!(shared.entry(id(1), ANY), Err(CacheError::Foreign { .. })));
    assert!(!job(1).exists());
    let mut earlier = serde_json::to_value(&entry).expect("JSON");
    earlier.as_object_mut().expect("members").retain(|name, _| name != "format" && name != "job");
    let json = earlier.to_string();
    fs::write(job(0), format!("{}{json}", digest(json.as_bytes()))).expect("a file");
    assert_eq!(shared.entry(id(0), ANY).expect("no damage"), None);
    put(&shared, id(0), b"texels");
    assert_eq!(shared.entry(id(0), ANY).expect("an entry"), Some(entry));
}
