use super::*;
use crate::cache::test_assets::{ANY, baked, damaged, id};

fn put(cache: &DiskCache, id: Digest, document: &str, content: &[u8]) {
    let baked = baked(content);
    let entry = Entry::new(id, Path::new(document), &baked).expect("paths below a folder");
    cache.put_blob(&entry.files[0], content).expect("a writable folder");
    cache.put_blob(&entry.document, &baked.document).expect("a writable folder");
    cache.put_entry(&entry).expect("a writable folder");
}

/// Writes `entry` as it is stored, with a valid checksum, which anybody can compute.
fn forge(path: &Path, entry: &serde_json::Value) {
    let json = serde_json::to_vec(entry).expect("JSON");
    fs::write(path, [digest(&json).to_string().as_bytes(), &json].concat()).expect("a file");
}

fn filled() -> (tempfile::TempDir, DiskCache, Entry) {
    let folder = tempfile::tempdir().expect("a folder");
    let cache = DiskCache::new(folder.path());
    put(&cache, id(0), "out/a.gltf", b"texels");
    let entry = cache.entry(id(0), ANY).expect("an entry").expect("an entry");
    (folder, cache, entry)
}

#[test]
fn returns_what_was_stored() {
    let (_folder, cache, entry) = filled();
    assert_eq!((entry.document.path.as_path(), entry.document.bytes), (Path::new("a.gltf"), 2));
    assert_eq!(entry.copies[0].as_path(), Path::new("a.bin"));
    assert_eq!(cache.blob(&entry.files[0]).expect("a blob"), Some(b"texels".to_vec()));
    assert!(cache.entry(id(1), ANY).expect("no entry").is_none());
}

#[test]
fn damaged_files_are_reported_and_removed() {
    let (_folder, cache, entry) = filled();
    let blob = cache.path("blobs", entry.files[0].blake3);
    let job = cache.path("jobs", id(0));
    for bytes in [&b"Texels"[..], b"texel", b""] {
        fs::write(&blob, bytes).expect("a file");
        assert!(matches!(cache.blob(&entry.files[0]), Err(CacheError::Damaged { .. })));
        assert_eq!(cache.blob(&entry.files[0]).expect("no blob"), None);
    }
    let whole = fs::read(&job).expect("a file");
    for bytes in damaged(&whole) {
        fs::write(&job, &bytes).expect("a file");
        assert!(matches!(cache.entry(id(0), ANY), Err(CacheError::Damaged { .. })), "{}", bytes.escape_ascii());
        assert!(cache.entry(id(0), ANY).expect("no entry").is_none());
    }
}

#[test]
fn no_entry_writes_outside_the_output_folder() {
    for path in ["../a.gltf", "/a.gltf", "a/../../b"] {
        let (_folder, cache, entry) = filled();
        let mut forged = serde_json::to_value(&entry).expect("JSON");
        forged["files"][0]["path"] = path.into();
        forge(&cache.path("jobs", id(0)), &forged);
        assert!(matches!(cache.entry(id(0), ANY), Err(CacheError::Damaged { .. })), "{path}");
    }
}

#[test]
fn removes_the_least_recently_used_first() {
    let (folder, cache, first) = filled();
    put(&cache, id(1), "out/b.gltf", b"other texels");
    let second = cache.entry(id(1), ANY).expect("an entry").expect("an entry");
    let old = SystemTime::now() - 2 * MARK_AGE;
    for entry in WalkDir::new(folder.path()).into_iter().flatten().filter(|e| e.file_type().is_file()) {
        fs::File::open(entry.path()).and_then(|f| f.set_modified(old)).expect("a file");
    }
    cache.touch(&first);
    let total: u64 = WalkDir::new(folder.path())
        .into_iter()
        .flatten()
        .filter(|e| e.file_type().is_file())
        .map(|e| e.metadata().expect("facts").len())
        .sum();
    cache.trim(total).expect("a folder");
    assert!(cache.blob(&second.files[0]).expect("a blob").is_some(), "the limit is not exceeded");
    cache.trim(total - 1).expect("a folder");
    let is_removed = cache.entry(id(1), ANY).expect("no damage").is_none()
        || cache.blob(&second.files[0]).expect("no damage").is_none();
    assert!(is_removed && cache.entry(id(0), ANY).expect("an entry").is_some());
    cache.trim(0).expect("a folder");
    assert!(cache.entry(id(0), ANY).expect("no damage").is_none());
    assert!(DiskCache::new(&folder.path().join("missing")).trim(0).is_ok());
}

#[test]
fn entries_with_invalid_digests_are_damaged() {
    for text in ["..", "victim", "../../victim", &id(0).to_string().to_uppercase()] {
        let (folder, cache, entry) = filled();
        let victim = folder.path().join("victim");
        fs::write(&victim, "data").expect("a file");
        let absolute = victim.to_str().expect("a path in UTF-8");
        for text in [text, absolute] {
            let mut forged = serde_json::to_value(&entry).expect("JSON");
            forged["files"][0]["blake3"] = text.into();
            forge(&cache.path("jobs", id(0)), &forged);
            assert!(matches!(cache.entry(id(0), ANY), Err(CacheError::Damaged { .. })), "{text}");
            assert_eq!(fs::read(&victim).expect("the file"), b"data", "{text}");
        }
    }
}

#[test]
fn entries_that_do_not_fit_their_job_are_removed() {
    let (_folder, cache, _) = filled();
    put(&cache, id(1), "out/b.gltf", b"other texels");
    fs::rename(cache.path("jobs", id(1)), cache.path("jobs", id(0))).expect("a file");
    let error = cache.entry(id(0), ANY).expect_err("an error");
    assert!(matches!(&error, CacheError::Foreign { found: Unusable::OtherJob(job), .. } if *job == id(1)), "{error}");
    assert!(cache.entry(id(0), ANY).expect("no entry").is_none());
    let (_folder, cache, entry) = filled();
    let refused = cache.entry(id(0), &|entry| Err(Unusable::Document(entry.document.path.clone())));
    let message = refused.expect_err("an error").to_string();
    assert!(message.contains(r#"one with the document "a.gltf", which the job does not write"#), "{message}");
    assert!(!cache.path("jobs", entry.job).exists());
}

#[test]
fn entries_of_other_formats_are_absent_without_an_error() {
    let (_folder, cache, entry) = filled();
    let whole = serde_json::to_value(&entry).expect("JSON");
    let mut earlier = whole.clone();
    earlier.as_object_mut().expect("members").retain(|name, _| name != "formatVersion" && name != "job");
    let mut later = whole;
    later["formatVersion"] = 1000.into();
    for entry in [earlier, later] {
        forge(&cache.path("jobs", id(0)), &entry);
        assert!(cache.entry(id(0), ANY).expect("no damage").is_none(), "{entry}");
    }
}

#[cfg(unix)]
#[test]
fn removes_a_link_and_not_its_target() {
    let (folder, cache, entry) = filled();
    let (blob, victim) = (cache.path("blobs", entry.files[0].blake3), folder.path().join("victim"));
    fs::write(&victim, "data").expect("a file");
    fs::remove_file(&blob).expect("a file");
    std::os::unix::fs::symlink(&victim, &blob).expect("a link");
    assert!(matches!(cache.blob(&entry.files[0]), Err(CacheError::Damaged { .. })));
    assert!(!blob.is_symlink());
    assert_eq!(fs::read(&victim).expect("the file"), b"data");
}

#[test]
fn reads_no_more_than_an_entry_declares() {
    let (_folder, cache, entry) = filled();
    let blob = cache.path("blobs", entry.files[0].blake3);
    fs::File::create(&blob).and_then(|file| file.set_len(1 << 32)).expect("a sparse file");
    assert!(matches!(cache.blob(&entry.files[0]), Err(CacheError::Damaged { .. })));
    let job = cache.path("jobs", id(0));
    fs::File::create(&job).and_then(|file| file.set_len(MAX_ENTRY_BYTES + 1)).expect("a sparse file");
    assert!(matches!(cache.entry(id(0), ANY), Err(CacheError::Damaged { .. })));
}

#[test]
fn trimming_keeps_files_that_the_cache_did_not_write() {
    let (folder, cache, _) = filled();
    let other_files = ["jobs/todo.txt", "jobs/work/cv.txt", "blobs/ab/cd", "blobs/ab/cd/deep"];
    let misplaced = folder.path().join("blobs").join("zz").join(id(0).to_string());
    let written = other_files.iter().filter(|path| !path.ends_with("cd")).map(|path| folder.path().join(path));
    for path in written.chain([misplaced.clone()]) {
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, "mine").expect("a file");
    }
    cache.trim(0).expect("a folder");
    assert!(other_files.iter().all(|path| folder.path().join(path).exists()) && misplaced.exists());
    assert!(cache.entry(id(0), ANY).expect("no damage").is_none());
}
