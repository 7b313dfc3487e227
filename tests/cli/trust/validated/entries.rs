//! Cache entries written by others: no bake reads, writes or removes other files because of them.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::process::{Run, copy, files, fixtures, hashes, run};

/// A change, and what the warning says about it.
type Change<'c> = (&'c dyn Fn(&mut Value), &'c str);

/// Returns a folder in which `A`, with `assets`, was baked to `O` through the cache `C`.
fn baked(assets: &[&str]) -> TempDir {
    let folder = tempdir().expect("a folder");
    for asset in assets {
        copy(&fixtures().join(asset), &folder.path().join("A").join(asset));
    }
    fs::write(folder.path().join("victim"), "data").expect("a file");
    assert_eq!(again(folder.path()).err, "");
    folder
}

/// Removes the outputs and bakes again.
fn again(folder: &Path) -> Run {
    let _ = fs::remove_dir_all(folder.join("O"));
    let run = run(folder, "bake A -o O -q --cache C --model none");
    assert_eq!(run.code, 0, "{}", run.err);
    run
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    files(&folder.join("C/jobs")).into_iter().map(|(_, path)| path).collect()
}

/// Changes the entry at `path` and corrects its checksum, as anybody can.
fn forge(path: &Path, change: &dyn Fn(&mut Value)) {
    let mut entry: Value = serde_json::from_slice(&fs::read(path).expect("an entry")[64..]).expect("JSON");
    change(&mut entry);
    let text = entry.to_string();
    fs::write(path, blake3::hash(text.as_bytes()).to_hex().to_string() + &text).expect("a file");
}

/// Returns all files except those of the cache.
fn files_outside_of_the_cache(folder: &Path) -> std::collections::BTreeMap<String, String> {
    let mut all = hashes(folder);
    all.retain(|name, _| !name.starts_with("C/"));
    all
}

/// Expects one warning that contains `part`, correct outputs, no change of other files, and a repaired cache.
fn expect_harmless(folder: &Path, before: &std::collections::BTreeMap<String, String>, part: &str) {
    let ended = again(folder);
    assert_eq!(ended.err.lines().count(), 1, "{part}: {}", ended.err);
    assert!(ended.err.starts_with("warning: A/") && ended.err.contains(part), "{part}: {}", ended.err);
    assert_eq!(&files_outside_of_the_cache(folder), before, "{part}");
    assert_eq!(again(folder).err, "", "{part}: the entry was dropped");
    assert_eq!(&files_outside_of_the_cache(folder), before, "{part}");
}

#[test]
fn a_cache_entry_deletes_no_file() {
    let scene = baked(&["brushed"]);
    let folder = scene.path();
    let before = files_outside_of_the_cache(folder);
    let absolute = |name: &str| folder.join(name).to_str().expect("a path in UTF-8").to_owned();
    let entry = entries(folder).remove(0);
    for victim in [absolute("victim"), absolute("A/brushed/brushed.gltf"), "../../../victim".into(), "..".into()] {
        for pointer in ["/files/0/blake3", "/document/blake3"] {
            forge(&entry, &|entry| *entry.pointer_mut(pointer).expect("a member") = json!(victim));
            expect_harmless(folder, &before, "expected the bytes that were stored there, found others");
        }
    }
}

#[test]
fn swapped_entries_are_not_used() {
    let scene = baked(&["brushed", "waves"]);
    let folder = scene.path();
    let before = files_outside_of_the_cache(folder);
    let [first, second] = entries(folder).try_into().expect("two entries");
    let swap = || {
        fs::rename(&first, folder.join("t")).expect("a file");
        fs::rename(&second, &first).expect("a file");
        fs::rename(folder.join("t"), &second).expect("a file");
    };
    swap();
    let ended = again(folder);
    assert_eq!(ended.err.matches("expected the entry of this job, found the one of job ").count(), 2, "{}", ended.err);
    assert_eq!(files_outside_of_the_cache(folder), before);
    assert_eq!(again(folder).err, "");
    // An entry that claims to be of the other job.
    swap();
    let name = |path: &Path| path.file_name().expect("a name").to_str().expect("UTF-8").to_owned();
    for path in [&first, &second] {
        forge(path, &|entry| entry["job"] = json!(name(path)));
    }
    let ended = again(folder);
    assert_eq!(ended.err.matches("which the job does not write").count(), 2, "{}", ended.err);
    assert_eq!(files_outside_of_the_cache(folder), before);
}

#[test]
fn entries_of_equal_names_are_distinguished() {
    let folder = tempdir().expect("a folder");
    let folder = folder.path();
    for (name, text) in [("x", "one"), ("y", "two")] {
        let asset = folder.join("A").join(name).join("s.gltf");
        fs::create_dir_all(asset.parent().expect("a folder")).expect("a folder");
        fs::write(asset, json!({ "asset": { "version": "2.0", "generator": text } }).to_string()).expect("a file");
    }
    again(folder);
    let before = files_outside_of_the_cache(folder);
    let [first, second] = entries(folder).try_into().expect("two entries");
    fs::rename(&first, folder.join("t")).expect("a file");
    fs::rename(&second, &first).expect("a file");
    fs::rename(folder.join("t"), &second).expect("a file");
    assert_eq!(again(folder).err.matches("found the one of job ").count(), 2);
    assert_eq!(files_outside_of_the_cache(folder), before, "the wrong asset is in place");
}

#[test]
fn an_entry_holds_exactly_the_outputs_of_its_job() {
    let scene = baked(&["brushed"]);
    let folder = scene.path();
    fs::write(folder.join("A/brushed/other.txt"), "no input").expect("a file");
    let before = files_outside_of_the_cache(folder);
    let entry = entries(folder).remove(0);
    let file = |entry: &Value, path: &str| {
        let mut file = entry["document"].clone();
        file["path"] = json!(path);
        file
    };
    let damaged = "expected the bytes that were stored there, found others";
    let changes: [Change<'_>; 10] = [
        (&|entry| entry["copies"] = json!(["../A/brushed/other.txt"]), damaged),
        (&|entry| entry["copies"] = json!(["/etc/hostname"]), damaged),
        (&|entry| entry["files"][0]["path"] = json!("../escape"), damaged),
        (&|entry| entry["document"]["path"] = json!("../brushed.gltf"), damaged),
        (&|entry| entry["unknown"] = json!(0), damaged),
        (
            &|entry| entry["copies"] = json!(["other.txt"]),
            "one with a copy of \"other.txt\", which the job does not read",
        ),
        (&|entry| entry["copies"] = json!([]), "one without \"O/brushed/brushed.bin\", which the job writes"),
        (&|entry| entry["document"]["path"] = json!("other.gltf"), "one with the document \"other.gltf\""),
        (
            &|entry| entry["files"] = json!([file(entry, "other.roughcast/a.ktx2")]),
            "one with the file \"other.roughcast/a.ktx2\"",
        ),
        (&|entry| entry["files"] = json!([file(entry, "brushed.gltf")]), "one with the file \"brushed.gltf\""),
    ];
    for (change, warning) in changes {
        forge(&entry, change);
        expect_harmless(folder, &before, warning);
    }
}

#[test]
fn an_entry_of_an_earlier_format_is_baked_again_without_a_warning() {
    let scene = baked(&["brushed"]);
    let before = files_outside_of_the_cache(scene.path());
    let entry = entries(scene.path()).remove(0);
    let is_kept = |name: &String| name != "formatVersion" && name != "job";
    forge(&entry, &|entry| entry.as_object_mut().expect("members").retain(|name, _| is_kept(name)));
    assert_eq!(again(scene.path()).err, "");
    assert_eq!(files_outside_of_the_cache(scene.path()), before);
}

#[cfg(unix)]
#[test]
fn a_pipe_in_a_cache_is_not_waited_for() {
    let scene = baked(&["brushed"]);
    let folder = scene.path();
    let before = files_outside_of_the_cache(folder);
    for (_, path) in files(&folder.join("C")) {
        fs::remove_file(&path).expect("a file");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().expect("mkfifo").success());
    }
    let ended = again(folder);
    assert!(
        ended.err.contains("expected a cache that can be read and written, found: not an ordinary file"),
        "{}",
        ended.err
    );
    assert_eq!(files_outside_of_the_cache(folder), before);
}
