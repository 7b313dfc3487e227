//! Runs the validator of Khronos, which shares no code with Roughcast, on everything that a bake writes.

use std::path::Path;
use std::process::Command;

use tempfile::tempdir;
use walkdir::WalkDir;

use super::process::{Run, bake, fixtures};
use super::skip::missing_tool;

/// Runs the validator on `folder`. Returns `None` if it is not installed.
fn validate(folder: &Path) -> Option<Run> {
    let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/validate-gltf");
    let is_installed = tool.join("node_modules/gltf-validator").is_dir();
    let output = Command::new("node").arg(tool.join("validate.mjs")).arg(folder).output();
    match output {
        Ok(output) if is_installed => Some(output.into()),
        _ => {
            missing_tool("the glTF validator needs Node 20 and `npm ci` in tools/validate-gltf");
            None
        }
    }
}

/// Returns how many glTF documents are below `folder`.
fn documents(folder: &Path) -> usize {
    let entries = WalkDir::new(folder).into_iter().map(|entry| entry.expect("an entry").into_path());
    entries.filter(|path| path.extension().is_some_and(|e| e == "gltf" || e == "glb")).count()
}

fn assert_valid(options: &[&str]) {
    let folder = tempdir().expect("a folder");
    bake(&fixtures(), folder.path(), options);
    if let Some(run) = validate(folder.path()) {
        assert_eq!(run.code, 0, "{options:?}\n{}{}", run.out, run.err);
        let assets = run.out.lines().filter(|line| line.contains(": 0 error(s)")).count();
        assert_eq!(assets, documents(&fixtures()), "{options:?}\n{}", run.out);
    }
}

#[test]
fn fixtures_are_valid_before_the_bake() {
    if let Some(run) = validate(&fixtures()) {
        assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    }
}

#[test]
fn fallback_is_valid() {
    assert_valid(&["--gltf", "fallback"]);
    assert_valid(&["--gltf", "fallback", "--profile", "both"]);
    assert_valid(&["--gltf", "fallback", "--glb"]);
}

#[test]
fn defaults_and_presets_are_valid() {
    assert_valid(&[]);
    for engine in ["three", "bevy", "godot"] {
        assert_valid(&["--engine", engine]);
    }
}

#[test]
fn all_textures_and_smaller_ones_are_valid() {
    assert_valid(&["--textures", "all"]);
    assert_valid(&["--textures", "all", "--diffuse-light", "suns", "--gltf", "fallback"]);
    assert_valid(&["--textures", "all", "--max-size", "8", "--gltf", "strict", "--glb"]);
}

#[test]
fn trimmed_textures_are_valid() {
    let view = ["--nearest", "400", "--screen-height", "1080", "--trim", "--profile", "both"];
    assert_valid(&[&view[..], &["--gltf", "fallback"]].concat());
    assert_valid(&[&view[..], &["--gltf", "strict", "--glb"]].concat());
}

#[test]
fn strict_is_valid() {
    assert_valid(&["--gltf", "strict", "--profile", "both"]);
    assert_valid(&["--gltf", "strict", "--glb"]);
}

#[test]
fn the_validator_rejects_an_invalid_asset() {
    let folder = tempdir().expect("a folder");
    std::fs::write(folder.path().join("a.gltf"), r#"{"asset":{"version":"2.0"},"scene":7}"#).expect("a file");
    if let Some(run) = validate(folder.path()) {
        assert_eq!(run.code, 1, "{}", run.out);
        assert!(run.out.contains("UNRESOLVED_REFERENCE"), "{}", run.out);
    }
}
