//! Tests of `file://`, an object store without a server.

use std::fs;
use std::process::Output;

use super::machine::{Machine, without_cache};

#[test]
fn machines_share_a_folder() {
    let shared = tempfile::tempdir().expect("a folder");
    let url = format!("file://{}/some%20where", shared.path().display());
    let (first, second) = (Machine::new(""), Machine::new(""));
    assert_eq!(first.statuses(&format!("--cache {url}")), ["baked"; 3]);
    assert_eq!(second.statuses(&format!("--cache {url} --cache cache")), ["cached"; 3]);
    assert_eq!(second.outputs(), without_cache());
    // The disk cache is complete, so the store may be removed.
    fs::remove_dir_all(shared.path().join("some where")).expect("a folder");
    assert_eq!(second.statuses(&format!("--cache cache --cache {url}")), ["cached"; 3]);
    assert!(!shared.path().join("some where").exists());
}

#[test]
fn a_damaged_disk_cache_reads_from_the_store() {
    let shared = tempfile::tempdir().expect("a folder");
    let options = format!("--cache cache --cache file://{}", shared.path().display());
    let machine = Machine::new("");
    machine.statuses(&options);
    let blobs = walkdir::WalkDir::new(machine.path().join("cache/blobs")).into_iter().flatten();
    for blob in blobs.filter(|e| e.file_type().is_file()) {
        fs::write(blob.path(), "damaged").expect("a file");
    }
    let run = machine.bake(&options);
    assert_eq!(run.statuses, ["cached"; 3]);
    assert!(run.warnings().iter().all(|warning| warning.contains("the damaged file was removed")), "{}", run.err);
    assert_eq!(machine.outputs(), without_cache());
    assert_eq!(machine.statuses(&options), ["cached"; 3]);
}

#[test]
fn refuses_invalid_caches_as_wrong_use() {
    let machine = Machine::new("");
    for (options, part) in [
        ("--cache a --cache b", "expected one folder and one URL at most, found a and b"),
        ("--cache file:///a --cache s3://b/c", "expected one folder and one URL at most"),
        ("--cache http://127.0.0.1/a", "a scheme that no store has"),
        ("--cache s3://user:hunter@bucket/a", "credentials belong into environment variables"),
        ("--cache s3://", "expected s3://bucket/prefix"),
    ] {
        let Output { status, stderr, .. } = machine.command(options).output().expect("the command starts");
        let err = String::from_utf8(stderr).expect("UTF-8");
        assert!(status.code() == Some(2) && err.contains(part) && !err.contains("hunter"), "{options}: {err}");
        assert!(!machine.path().join("out").exists());
    }
}
