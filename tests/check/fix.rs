//! `check --fix` bakes again what a bake cures, and nothing else.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use roughcast::cli::Outcome;

use crate::fixture::{Bake, bake, findings, roughcast, write_asset};

/// A second asset below `props`, baked too.
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

/// `check --fix`: outcome, codes of what is left, and what is said of bakes.
fn fix(bake: &Bake, options: &[&str]) -> (Outcome, Vec<String>, String) {
    let (baked, source) = (bake.baked.to_str().unwrap(), bake.source.to_str().unwrap());
    let words = ["check", baked, "--source", source, "--format", "json", "--fix"];
    let (outcome, out, err) = roughcast(&[&words[..], options].concat());
    (outcome, findings(&serde_json::from_str(&out).unwrap()).into_iter().map(|f| f.0).collect(), err)
}

/// Files below `folder`, with their bytes.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let files = walkdir::WalkDir::new(folder).into_iter().map(|e| e.unwrap()).filter(|e| e.file_type().is_file());
    files.map(|e| (e.path().strip_prefix(folder).unwrap().to_owned(), fs::read(e.path()).unwrap())).collect()
}

fn modified(path: &Path) -> SystemTime {
    fs::metadata(path).unwrap().modified().unwrap()
}

#[test]
fn what_is_stale_is_baked_again_and_nothing_else() {
    let bake = two_assets();
    fs::copy(bake.source.join("surface.png"), bake.source.join("props/bumps.png")).unwrap();
    let (sources, untouched) = (files(&bake.source), modified(&bake.document()));
    let (outcome, left, said) = fix(&bake, &[]);
    assert_eq!((outcome, left), (Outcome::Done, vec![]), "{said}");
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines.len() == 1 && lines[0].starts_with("baked again: ") && lines[0].contains("props"), "{said}");
    assert_eq!(files(&bake.source), sources);
    assert_eq!(modified(&bake.document()), untouched);
    let fresh = bake.baked.with_file_name("fresh");
    run(&bake, &["bake", bake.source.to_str().unwrap(), "-o", fresh.to_str().unwrap(), "-q"]);
    assert_eq!(files(&bake.baked), files(&fresh));
    // With nothing to do, nothing is done.
    assert_eq!(fix(&bake, &[]), (Outcome::Done, vec![], String::new()));
}

/// A missing output, a damaged texture, a damaged document, other settings.
#[test]
fn what_a_bake_cures_is_cured() {
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
        let (outcome, left, said) = fix(&bake, &[]);
        assert_eq!((outcome, left), (Outcome::Done, vec![]), "{index}: {said}");
        assert_eq!(said.lines().count(), if index == 3 { 2 } else { 1 }, "{index}: {said}");
    }
}

/// Flags and cache are those of `bake`.
#[test]
fn a_fix_is_a_bake() {
    let bake = bake(&["--gltf", "dual"]);
    let cache = bake.baked.with_file_name("cache");
    let options = ["--gltf", "strict", "--cache", cache.to_str().unwrap()];
    let (outcome, left, _) = fix(&bake, &options);
    // The fallbacks of the form before are not there any more; what is left over is for a person to delete.
    assert_eq!((outcome, left), (Outcome::Done, vec![]));
    let (strict, kept) = (files(&bake.baked), files(&cache));
    assert!(!kept.is_empty());
    fs::remove_dir_all(&bake.baked).unwrap();
    fs::create_dir(&bake.baked).unwrap();
    let (source, baked) = (bake.source.to_str().unwrap(), bake.baked.to_str().unwrap());
    run(&bake, &["bake", source, "-o", baked, "-q", "--gltf", "strict", "--cache", cache.to_str().unwrap()]);
    let names = |files: &BTreeMap<PathBuf, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(files(&bake.baked), strict);
    assert_eq!(names(&files(&cache)), names(&kept), "the second bake had nothing to add");
}

#[test]
fn what_is_left_is_told() {
    let bake = two_assets();
    // Its source is gone: no bake cures that.
    fs::remove_file(bake.source.join("ridges.gltf")).unwrap();
    fs::write(bake.texture("bumps.normal.ktx2"), "damaged").unwrap();
    let (outcome, left, said) = fix(&bake, &[]);
    assert_eq!((outcome, said.as_str()), (Outcome::Findings, ""));
    assert!(left.contains(&"RC1504".to_owned()) && left.contains(&"RC1001".to_owned()), "{left:?}");
    // A source that cannot be baked.
    fs::write(bake.source.join("props/bumps.png"), "no image").unwrap();
    let (outcome, left, said) = fix(&bake, &[]);
    assert_eq!(outcome, Outcome::Failed);
    assert!(left.contains(&"RC1505".to_owned()) && said.starts_with("error: "), "{left:?} {said}");
}

#[test]
fn sources_are_never_written_over() {
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
