//! Tests what is published: inputs as they were planned, only files of the run, nothing stale, and outputs of one run
//! only.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};

use roughcast::cache::Cache;
use roughcast::output::Guard;
use roughcast::project::resolve;
use roughcast::run::{Job, Lookup, MemoryBudget, RunError, finish, prepare};
use serde_json::{Value, json};
use tempfile::tempdir;

use super::super::process::{copy, done, files, fixtures, hashes, run};
#[cfg(target_os = "linux")]
use super::super::skip::skip;

/// Copies the fixture `name` to `to` in `folder`.
fn fixture(folder: &Path, name: &str, to: &str) {
    copy(&fixtures().join(name), &folder.join(to));
}

fn names(folder: &Path) -> Vec<String> {
    files(folder).into_iter().map(|(name, _)| name).collect()
}

/// Replaces every `old` in the text file at `path`.
fn edit(path: &Path, old: &str, new: &str) {
    let text = fs::read_to_string(path).expect("a text");
    assert!(text.contains(old), "{old:?} is not in {}", path.display());
    fs::write(path, text.replace(old, new)).expect("a file");
}

#[test]
fn a_file_that_changes_before_it_is_copied_is_not_published() {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    fixture(folder, "brushed", "in");
    let (source, out) = (folder.join("in/brushed.gltf"), folder.join("out"));
    let settings = resolve(&[]).expect("defaults").values;
    let cache = Cache::new(Some(&folder.join("cache")), None, 1 << 30).expect("a cache");
    let job = Job::new(&source, &out, None, &settings).expect("a job");
    // Fills the cache.
    let _ = prepare(&job, Some(Lookup::new(&job, &cache)), &MemoryBudget::new(1), &|_| ());
    for is_cached in [false, true] {
        let prepare = || {
            let lookup = is_cached.then(|| Lookup::new(&job, &cache));
            prepare(&job, lookup, &MemoryBudget::new(1), &|_| ())
        };
        let finish = |prepared| finish(&job, prepared, &mut Guard::default(), &mut |error| panic!("{error}"));
        for name in ["brushed_colour.png", "brushed.bin"] {
            let path = folder.join("in").join(name);
            let bytes = fs::read(&path).expect("a file");
            for change in [Some(&bytes[..100]), None] {
                let prepared = prepare();
                match change {
                    Some(bytes) => fs::write(&path, bytes).expect("a file"),
                    None => fs::remove_file(&path).expect("a file"),
                }
                let found = finish(prepared).err();
                let is_recorded = matches!(&found, Some(error @ RunError::Changed { path: changed })
                    if *changed == path && error.is_transient());
                assert!(is_recorded, "{name}, cached: {is_cached}: {found:?}");
                let document = out.join("brushed.gltf");
                assert!(!out.join(name).exists() && !document.exists(), "{name} was published");
                fs::write(&path, &bytes).expect("a file");
                // Files that did not change may exist already.
                let _ = fs::remove_dir_all(&out);
            }
        }
        let done = finish(prepare()).expect("a bake of what was planned");
        assert_eq!(done.is_cached, is_cached);
        for file in &done.written {
            let bytes = fs::read(&file.path).expect("an output");
            assert_eq!(blake3::hash(&bytes).to_hex().as_str(), file.blake3.to_string(), "{}", file.path.display());
        }
        fs::remove_dir_all(&out).expect("a folder");
    }
}

/// Bakes to a disk of 20 kB, if this process may mount one. A scheduler runs the job again, and `plan merge --rest`
/// keeps it.
#[cfg(target_os = "linux")]
#[test]
fn jobs_that_fail_on_a_full_disk_are_worth_a_retry() {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    fixture(folder, "brushed", "in");
    fs::create_dir(folder.join("out")).expect("a folder");
    let plan = done(folder, "plan in -o out --json");
    fs::write(folder.join("plan.json"), plan).expect("a file");
    let script =
        "mount -t tmpfs -o size=20k none out || exit 77; exec \"$0\" bake --plan plan.json -q --report report.json";
    let mut command = Command::new("unshare");
    command.args(["--mount", "--map-root-user", "sh", "-c", script, env!("CARGO_BIN_EXE_roughcast")]);
    let output = command.current_dir(folder).output();
    let code = output.as_ref().ok().and_then(|output| output.status.code());
    let Some(output) = output.ok().filter(|output| code != Some(77) && !output.stderr.starts_with(b"unshare")) else {
        return skip("a full disk needs the right to mount one");
    };
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(code, Some(4), "{err}");
    assert!(err.contains("No space left"), "{err}");
    let merged = run(folder, "plan merge plan.json report.json --rest rest.json");
    assert_eq!(merged.code, 4, "{}{}", merged.out, merged.err);
    let rest: Value = serde_json::from_slice(&fs::read(folder.join("rest.json")).expect("a plan")).expect("JSON");
    assert_eq!(rest["jobs"].as_array().map(Vec::len), Some(1));
    done(folder, "bake --plan rest.json -q");
}

#[test]
fn assets_whose_names_differ_in_case_only_are_refused() {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    let document = fs::read(fixtures().join("waves/waves.glb")).expect("a fixture");
    for name in ["in/Lake.glb", "in/lake.glb", "in/deep/x.glb", "in/Deep/x.glb"] {
        fs::create_dir_all(folder.join(name).parent().expect("a folder")).expect("a folder");
        fs::write(folder.join(name), &document).expect("a file");
    }
    if files(&folder.join("in")).len() < 4 {
        return skip("this file system ignores the case of names");
    }
    let found = run(folder, "bake in -o out -q --model none");
    assert_eq!((found.code, found.err.lines().count()), (1, 2), "{}", found.err);
    for pair in [["in/lake.glb", "in/Lake.glb"], ["in/deep/x.glb", "in/Deep/x.glb"]] {
        let is_recorded =
            |line: &str| pair.iter().all(|name| line.contains(name)) && line.contains("rename one of them");
        assert!(found.err.lines().any(is_recorded), "{pair:?}: {}", found.err);
    }
    let documents: Vec<String> = names(&folder.join("out")).into_iter().filter(|name| name.ends_with(".glb")).collect();
    assert_eq!(documents, ["Deep/x.glb", "Lake.glb"]);
}

#[test]
fn files_whose_names_differ_in_case_only_are_refused() {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    // An image that is only copied: within an asset, and between two assets of one folder.
    fixture(folder, "brushed", "one");
    fixture(folder, "brushed", "two/a");
    fixture(folder, "brushed", "two/b");
    fs::rename(folder.join("two/a/brushed.gltf"), folder.join("two/a/first.gltf")).expect("a file");
    fs::rename(folder.join("two/b/brushed_colour.png"), folder.join("two/b/Brushed_Colour.png")).expect("a file");
    edit(&folder.join("two/b/brushed.gltf"), "brushed_colour.png", "Brushed_Colour.png");
    let asset = folder.join("one/brushed.gltf");
    let mut document: Value = serde_json::from_slice(&fs::read(&asset).expect("a file")).expect("JSON");
    document["images"].as_array_mut().expect("images").push(json!({ "uri": "BRUSHED.BIN" }));
    fs::write(&asset, document.to_string()).expect("a file");
    fs::write(folder.join("one/BRUSHED.BIN"), "another file").expect("a file");
    if names(&folder.join("one")).len() < 6 {
        return skip("this file system ignores the case of names");
    }
    for (inputs, parts) in [
        ("one", ["one/brushed.gltf: ", "BRUSHED.BIN", "brushed.bin"]),
        ("two/a/first.gltf two/b/brushed.gltf", ["two/b/brushed.gltf: ", "Brushed_Colour.png", "brushed_colour.png"]),
    ] {
        let found = run(folder, &format!("bake {inputs} -o out -q --model none"));
        assert_eq!((found.code, found.err.lines().count()), (1, 1), "{}", found.err);
        let is_recorded = parts.iter().all(|part| found.err.contains(part)) && found.err.contains("rename one of them");
        assert!(is_recorded, "{}", found.err);
    }
}

#[test]
fn an_output_of_another_source_is_not_replaced() {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    fixture(folder, "brushed", "in");
    fs::copy(fixtures().join("waves/waves.glb"), folder.join("brushed.glb")).expect("a file");
    // The output is kept even if nothing is to be baked.
    for options in ["", "--cache cache", "--cache cache"] {
        done(folder, "bake brushed.glb -o out -q --glb=false");
        let before = hashes(&folder.join("out"));
        let found = run(folder, &format!("bake in/brushed.gltf -o out -q {options}"));
        assert_eq!((found.code, found.err.lines().count()), (1, 1), "{}", found.err);
        for part in ["in/brushed.gltf: ", "out/brushed.gltf", "brushed.glb", "another folder"] {
            assert!(found.err.contains(part), "{part:?}: {}", found.err);
        }
        assert_eq!(hashes(&folder.join("out")), before);
        // The remedy works, and so does the original source.
        fs::remove_dir_all(folder.join("out")).expect("a folder");
        done(folder, &format!("bake in/brushed.gltf -o out -q {options}"));
        done(folder, &format!("bake in/brushed.gltf -o out -q {options}"));
        fs::remove_dir_all(folder.join("out")).expect("a folder");
    }
}

#[test]
fn only_textures_that_an_asset_no_longer_has_are_removed() {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    fixture(folder, "knobs", "in");
    for options in ["", "--cache cache"] {
        done(folder, &format!("bake in -o clean -q --gltf strict {options}"));
        done(folder, &format!("bake in -o out -q --gltf fallback {options}"));
        let textures_folder = folder.join("out/knobs.roughcast");
        let stale: Vec<String> = names(&textures_folder).into_iter().filter(|name| name.ends_with(".png")).collect();
        assert!(stale.len() > 2, "{stale:?}");
        // A texture copied by hand, and a file of somebody else.
        fs::write(textures_folder.join(&stale[0]), "edited").expect("a file");
        fs::write(textures_folder.join("foreign.ktx2"), "foreign").expect("a file");
        fs::write(folder.join("victim"), "not an output").expect("a file");
        // A document may record files that it does not textures_folder.
        let document = folder.join("out/knobs.gltf");
        let mut forged: Value = serde_json::from_slice(&fs::read(&document).expect("a file")).expect("JSON");
        let outputs = forged["asset"]["extras"]["roughcast"]["outputs"].as_array_mut().expect("what was written");
        let blake3 = blake3::hash(b"not an output").to_hex().to_string();
        for uri in ["../victim", "knobs.roughcast/../../victim", "knobs.roughcast/..%2F..%2Fvictim", "/victim"] {
            outputs.push(json!({ "uri": uri, "blake3": blake3 }));
        }
        fs::write(&document, forged.to_string()).expect("a file");
        done(folder, &format!("bake in -o out -q --gltf strict {options}"));
        let mut found = hashes(&folder.join("out"));
        for kept in [&stale[0], "foreign.ktx2"] {
            assert!(found.remove(&format!("knobs.roughcast/{kept}")).is_some(), "{kept} is gone");
        }
        assert_eq!(found, hashes(&folder.join("clean")));
        assert!(folder.join("victim").is_file());
        fs::remove_dir_all(folder.join("out")).expect("a folder");
        fs::remove_dir_all(folder.join("clean")).expect("a folder");
    }
    done(folder, "bake in -o out -q --gltf fallback --no-provenance");
    let before = names(&folder.join("out"));
    done(folder, "bake in -o out -q --gltf strict --no-provenance");
    assert_eq!(names(&folder.join("out")), before, "without provenance nothing is known, and nothing is removed");
}

#[test]
fn outputs_of_earlier_bakes_are_left_out_of_folders_with_one_note() {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    fixture(folder, "brushed", "brushed");
    fixture(folder, "waves", "waves");
    done(folder, "bake brushed waves -o earlier -q");
    done(folder, "bake waves -o other -q --glb");
    let found = run(folder, "bake . -o out");
    let note = "note: left out 3 file(s) that Roughcast has baked, such as ./earlier/brushed.gltf; name a file itself to \
        bake it anyway\n";
    assert_eq!((found.code, found.err.as_str()), (0, note));
    let documents: Vec<String> = names(&folder.join("out"))
        .into_iter()
        .filter(|name| name.ends_with(".gltf") || name.ends_with(".glb"))
        .collect();
    assert_eq!(documents, ["brushed/brushed.gltf", "waves/waves.glb"]);
    done(folder, "bake . -o out -q");
    let planned = run(folder, "plan . -o out");
    assert_eq!((planned.code, planned.out.lines().count(), planned.err.as_str()), (0, 2, note));
    // Inputs that are named explicitly are baked.
    let named = run(folder, "bake earlier/brushed.gltf -o again");
    assert!(named.code == 1 && named.err.contains("bake from the original"), "{}", named.err);
    let only = run(folder, "bake earlier -o again");
    assert_eq!((only.code, only.err.lines().count()), (1, 1), "{}", only.err);
    assert!(only.err.contains("earlier: ") && only.err.contains("earlier/brushed.gltf"), "{}", only.err);
    assert!(!folder.join("again").exists());
}

/// Settings whose outputs differ in bytes and names.
const OPTIONS: [&str; 2] = ["--model=isotropic", "--model=isotropic --gltf=strict --target=float"];

#[test]
fn two_bakes_of_different_settings_into_one_folder_do_not_mix() {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    for asset in ["brushed", "knobs", "waves"] {
        fixture(folder, asset, &format!("in/{asset}"));
    }
    let expected: Vec<BTreeMap<String, String>> = OPTIONS
        .iter()
        .map(|options| {
            done(folder, &format!("bake in -o expected -q {options}"));
            let expected = hashes(&folder.join("expected"));
            fs::remove_dir_all(folder.join("expected")).expect("a folder");
            expected
        })
        .collect();
    for round in 0..6 {
        let start = |options: &&str| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_roughcast"));
            command.current_dir(folder).args("bake in -o out -q".split(' ')).args(options.split(' ')).spawn()
        };
        let bakes: Vec<_> = OPTIONS.iter().map(|options| start(options).expect("the command starts")).collect();
        for mut bake in bakes {
            assert!(bake.wait().expect("an end").success());
        }
        let found = hashes(&folder.join("out"));
        assert!(expected.contains(&found), "round {round}: {:?}", found.keys());
    }
}

#[cfg(unix)]
#[test]
fn a_bake_waits_for_one_that_writes_to_its_folder() {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    fixture(folder, "waves", "in");
    fs::create_dir(folder.join("out")).expect("a folder");
    let held = File::open(folder.join("out")).expect("a folder");
    if held.lock().is_err() {
        return skip("this file system does not lock folders");
    }
    let start = |options: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_roughcast"));
        command.current_dir(folder).args("bake in -o out -q --model=none".split(' '));
        command.args(options.split_whitespace()).stderr(Stdio::piped());
        command.spawn().expect("the command starts")
    };
    let mut bake = start("");
    let mut err = BufReader::new(bake.stderr.take().expect("a pipe"));
    let mut line = String::new();
    err.read_line(&mut line).expect("a line");
    assert_eq!(line, "note: waiting for another run of roughcast that writes to out\n");
    assert_eq!(names(&folder.join("out")), [""; 0]);
    drop(held);
    assert!(bake.wait().expect("an end").success());
    let mut rest = String::new();
    err.read_to_string(&mut rest).expect("text");
    assert_eq!(rest, "");
    // Parts of one run write at the same time.
    let held = File::open(folder.join("out")).expect("a folder");
    held.lock_shared().expect("a lock");
    assert!(start("--shard 1/1").wait().expect("an end").success());
}
