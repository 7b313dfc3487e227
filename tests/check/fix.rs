//! Tests of `check --fix`, which bakes again the assets whose findings a bake removes, and nothing else.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use roughcast::cli::Outcome;

use crate::fixture::{Bake, bake, findings, roughcast, write_asset};

/// Bakes the asset and a second one below `props`.
fn two_assets() -> Bake {
    let bake = bake(&[]);
    write_asset(&bake.source.join("props"));
    run(&bake, &["bake", bake.source.to_str().unwrap(), "-o", bake.baked.to_str().unwrap(), "-q"]);
    bake
}

fn run(_: &Bake, words: &[&str]) {
    let (outcome, _, err) = roughcast(words);
    assert_eq!(outcome, Outcome::Done, "{err}");
}

/// Runs `check --fix`. Returns the outcome, the codes of the remaining findings, and standard error.
fn fix(bake: &Bake, options: &[&str]) -> (Outcome, Vec<String>, String) {
    let (baked, source) = (bake.baked.to_str().unwrap(), bake.source.to_str().unwrap());
    let words = ["check", baked, "--source", source, "--format", "json", "--fix"];
    let (outcome, out, err) = roughcast(&[&words[..], options].concat());
    (outcome, findings(&serde_json::from_str(&out).unwrap()).into_iter().map(|f| f.0).collect(), err)
}

/// Reads the files below `folder`.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let files = walkdir::WalkDir::new(folder).into_iter().map(|e| e.unwrap()).filter(|e| e.file_type().is_file());
    files.map(|e| (e.path().strip_prefix(folder).unwrap().to_owned(), fs::read(e.path()).unwrap())).collect()
}

fn modified(path: &Path) -> SystemTime {
    fs::metadata(path).unwrap().modified().unwrap()
}

#[test]
fn bakes_only_stale_assets_again() {
    let bake = two_assets();
    fs::copy(bake.source.join("surface.png"), bake.source.join("props/bumps.png")).unwrap();
    let (sources, untouched) = (files(&bake.source), modified(&bake.document()));
    let (outcome, remaining, err) = fix(&bake, &[]);
    assert_eq!((outcome, remaining), (Outcome::Done, vec![]), "{err}");
    let lines: Vec<&str> = err.lines().collect();
    assert!(lines.len() == 1 && lines[0].starts_with("baked again: ") && lines[0].contains("props"), "{err}");
    assert_eq!(files(&bake.source), sources);
    assert_eq!(modified(&bake.document()), untouched);
    let fresh = bake.baked.with_file_name("fresh");
    run(&bake, &["bake", bake.source.to_str().unwrap(), "-o", fresh.to_str().unwrap(), "-q"]);
    assert_eq!(files(&bake.baked), files(&fresh));
    // A second run finds nothing to bake.
    assert_eq!(fix(&bake, &[]), (Outcome::Done, vec![], String::new()));
}

/// The damages are a missing document, a damaged texture, a damaged document, other settings and a missing buffer.
#[test]
fn fixes_every_damage_that_a_bake_removes() {
    let damages: [fn(&Bake); 5] = [
        |b| fs::remove_file(b.document()).unwrap(),
        |b| fs::write(b.texture("bumps.normal.ktx2"), "damaged").unwrap(),
        |b| fs::write(b.document(), "{").unwrap(),
        |b| fs::write(b.source.join("roughcast.toml"), "quality = 'best'").unwrap(),
        |b| fs::remove_file(b.baked.join("mesh.bin")).unwrap(),
    ];
    for (index, damage) in damages.into_iter().enumerate() {
        let bake = two_assets();
        damage(&bake);
        let (baked, source) = (bake.baked.to_str().unwrap(), bake.source.to_str().unwrap());
        assert_eq!(roughcast(&["check", baked, "--source", source]).0, Outcome::Findings, "{index}");
        let (outcome, remaining, err) = fix(&bake, &[]);
        assert_eq!((outcome, remaining), (Outcome::Done, vec![]), "{index}: {err}");
        assert_eq!(err.lines().count(), if index == 3 { 2 } else { 1 }, "{index}: {err}");
    }
}

/// Flags and cache are those of `bake`.
#[test]
fn a_fix_writes_the_outputs_of_a_bake() {
    let bake = bake(&["--gltf", "dual"]);
    let cache = bake.baked.with_file_name("cache");
    let options = ["--gltf", "strict", "--cache", cache.to_str().unwrap()];
    let (outcome, remaining, _) = fix(&bake, &options);
    // The strict form has no fallbacks, so the fallbacks of the dual form are not written again.
    assert_eq!((outcome, remaining), (Outcome::Done, vec![]));
    let (strict, cached) = (files(&bake.baked), files(&cache));
    assert!(!cached.is_empty());
    fs::remove_dir_all(&bake.baked).unwrap();
    fs::create_dir(&bake.baked).unwrap();
    let (source, baked) = (bake.source.to_str().unwrap(), bake.baked.to_str().unwrap());
    run(&bake, &["bake", source, "-o", baked, "-q", "--gltf", "strict", "--cache", cache.to_str().unwrap()]);
    let names = |files: &BTreeMap<PathBuf, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(files(&bake.baked), strict);
    assert_eq!(names(&files(&cache)), names(&cached), "the second bake added nothing to the cache");
}

/// A document that `-o` named keeps its name and its container.
#[test]
fn bakes_documents_with_a_name_of_their_own_again() {
    for name in ["named.glb", "ridges.glb", "named.gltf"] {
        let bake = bake(&[]);
        let source = bake.source.join("ridges.gltf");
        let baked_to = |folder: &str| {
            let folder = bake.baked.with_file_name(folder);
            run(&bake, &["bake", source.to_str().unwrap(), "-o", folder.join(name).to_str().unwrap(), "-q"]);
            folder
        };
        let stale = baked_to("stale");
        fs::copy(bake.source.join("surface.png"), bake.source.join("bumps.png")).unwrap();
        let fresh = baked_to("fresh");
        let (stale, source) = (stale.to_str().unwrap(), bake.source.to_str().unwrap());
        let (outcome, out, err) = roughcast(&["check", stale, "--source", source, "--fix"]);
        assert_eq!(outcome, Outcome::Done, "{name}: {out} {err}");
        assert!(err.starts_with("baked again: ") && err.contains(name), "{name}: {err}");
        assert_eq!(files(Path::new(stale)), files(&fresh), "{name}");
    }
}

#[test]
fn reports_findings_that_remain() {
    let bake = two_assets();
    // No bake can fix an asset without its source.
    fs::remove_file(bake.source.join("ridges.gltf")).unwrap();
    fs::write(bake.texture("bumps.normal.ktx2"), "damaged").unwrap();
    let (outcome, remaining, err) = fix(&bake, &[]);
    assert_eq!((outcome, err.as_str()), (Outcome::Findings, ""));
    assert!(remaining.contains(&"RC1504".to_owned()) && remaining.contains(&"RC1001".to_owned()), "{remaining:?}");
    // This source cannot be baked.
    fs::write(bake.source.join("props/bumps.png"), "no image").unwrap();
    let (outcome, remaining, err) = fix(&bake, &[]);
    assert_eq!(outcome, Outcome::Failed);
    assert!(remaining.contains(&"RC1505".to_owned()) && err.starts_with("error: "), "{remaining:?} {err}");
}

#[test]
fn never_overwrites_sources() {
    let bake = two_assets();
    let before = files(&bake.source);
    let source = bake.source.to_str().unwrap();
    let (outcome, _, err) = roughcast(&["check", source, "--source", source, "--fix", "--gltf", "strict"]);
    assert_ne!(outcome, Outcome::Usage, "{err}");
    assert_eq!(files(&bake.source), before);
    let outer = bake.source.parent().unwrap();
    let (_, _, err) = roughcast(&["check", outer.to_str().unwrap(), "--source", source, "--fix"]);
    assert_eq!(files(&bake.source), before, "{err}");
}

/// Bakes the asset to the file `name` in `folder`. Returns the path of that file.
fn named(source: &Path, folder: &Path, name: &str) -> String {
    let output = folder.join(name).to_str().unwrap().to_owned();
    let (outcome, _, err) = roughcast(&["bake", source.join("ridges.gltf").to_str().unwrap(), "-o", &output, "-q"]);
    assert_eq!(outcome, Outcome::Done, "{err}");
    output
}

/// A document that `-o` names has its source in the record, wherever both are. It is never its own source.
#[test]
fn checks_and_bakes_named_documents_again() {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source");
    write_asset(&source);
    let document = source.join("ridges.gltf");
    for (place, name) in [(folder.path(), "other.glb"), (folder.path(), "other.gltf"), (&*source, "beside.glb")] {
        let output = named(&source, place, name);
        let check = |more: &[&str]| {
            let words = ["check", &output, "--format", "json", "--source"];
            let (outcome, out, err) = roughcast(&[&words[..], more].concat());
            let codes: Vec<String> = findings(&serde_json::from_str(&out).unwrap()).into_iter().map(|f| f.0).collect();
            (outcome, codes, err)
        };
        for path in [source.as_path(), document.as_path()] {
            assert_eq!(check(&[path.to_str().unwrap()]), (Outcome::Done, vec![], String::new()), "{output}");
        }
        let surface = source.join("surface.png");
        let kept = fs::read(&surface).unwrap();
        fs::copy(source.join("bumps.png"), &surface).unwrap();
        let (outcome, codes, _) = check(&[source.to_str().unwrap()]);
        assert!(outcome == Outcome::Findings && codes.contains(&"RC1505".to_owned()), "{output}: {codes:?}");
        let (outcome, codes, err) = check(&[source.to_str().unwrap(), "--fix"]);
        assert_eq!((outcome, codes), (Outcome::Done, vec![]), "{output}: {err}");
        assert!(err.contains(&format!("-> {output}")), "{err}");
        fs::write(&surface, kept).unwrap();
    }
    fs::rename(&document, source.join("renamed.gltf")).unwrap();
    // The missing source is sought beside the output, in its folder.
    let missing = Path::new("source").join("ridges.gltf");
    for (input, folder) in [(&*source.join("beside.glb"), &*source), (folder.path(), folder.path())] {
        let (outcome, out, _) = roughcast(&["check", input.to_str().unwrap(), "--source", folder.to_str().unwrap()]);
        let is_found = out.contains("RC1504") && out.contains(missing.to_str().unwrap());
        assert!(outcome == Outcome::Findings && is_found, "{out}");
    }
}
