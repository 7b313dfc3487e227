//! Names and texts from files, as terminals and CI logs receive them.

use std::fs;
use std::path::Path;

use tempfile::{TempDir, tempdir};

use crate::process::{Run, copy, fixtures, roughcast_in};

/// Sets the title of a window, reorders text and begins a line that runners of GitHub obey.
const HOSTILE: &str = "\u{1b}]0;x\u{7}\u{202e}\u{9b}\u{2028}\n::error::owned\r";

fn scene() -> TempDir {
    let folder = tempdir().expect("a folder");
    let assets = folder.path().join("A").join(HOSTILE);
    copy(&fixtures().join("brushed"), &assets);
    let document = assets.join("brushed.gltf");
    let text = fs::read_to_string(&document).expect("a document");
    let name = serde_json::to_string(&format!("Brushed steel{HOSTILE}")).expect("JSON");
    assert!(text.contains("\"Brushed steel\""));
    fs::write(&document, text.replace("\"Brushed steel\"", &name)).expect("a file");
    fs::write(assets.join("broken.gltf"), "x").expect("a file");
    fs::write(assets.join("roughcast.toml"), "model = 'none'\n[[override]]\nfiles = '*'\n").expect("a file");
    folder
}

/// Runs `arguments` in `folder`. Expects exit code `code` and no control characters or commands in what is printed.
fn run_and_check_text(folder: &Path, arguments: &[&str], code: i32) -> Run {
    let run = roughcast_in(folder, arguments);
    assert_eq!(run.code, code, "{arguments:?}: {}", run.err);
    for text in [&run.out, &run.err] {
        let acts = |c: char| c != '\n' && (c.is_control() || "\u{2028}\u{202e}".contains(c));
        assert!(!text.contains(acts), "{arguments:?}: {text:?}");
        assert!(!text.lines().any(|line| line.trim_start().starts_with("::")), "{arguments:?}: {text:?}");
    }
    run
}

#[test]
fn names_from_files_are_printed_without_effect() {
    let scene = scene();
    let folder = scene.path();
    let inside = |name: &str| format!("A/{HOSTILE}/{name}");
    let baked = run_and_check_text(folder, &["bake", "A", "-o", "O", "-v"], 1);
    let shown = "\\u{1b}]0;x\\u{7}\\u{202e}\\u{9b}\\u{2028}\\u{a}::error::owned\\u{d}";
    assert!(baked.out.contains(&format!("baked A/{shown}/brushed.gltf: ")), "{}", baked.out);
    assert!(baked.out.contains(&format!("  Brushed steel{shown}: ")), "{}", baked.out);
    assert!(baked.err.contains(&format!("error: A/{shown}/broken.gltf: ")), "{}", baked.err);
    let config = run_and_check_text(folder, &["bake", "A", "-o", "O", "--print-config"], 0);
    assert!(config.out.contains(&format!("# A/{shown}/roughcast.toml")), "{}", config.out);
    run_and_check_text(folder, &["bake", "A", "-o", "O2", "-q", "--depfile", "d"], 1);
    run_and_check_text(folder, &["plan", "A", "-o", "O"], 1);
    run_and_check_text(
        folder,
        &["map", &inside("brushed_normal.png"), "-o", &format!("{HOSTILE}.ktx2"), "--model=none"],
        0,
    );
    run_and_check_text(folder, &["map", &inside("broken.gltf"), "-o", "m.ktx2"], 1);
    run_and_check_text(folder, &["render", &inside("broken.gltf"), "-o", HOSTILE], 1);
    run_and_check_text(folder, &["render", "-o", HOSTILE, "--scene", "highlight", "--width", "8"], 0);
    run_and_check_text(folder, &["compare", &inside("broken.gltf"), "-o", "C"], 1);
    run_and_check_text(folder, &["init", &inside("")], 1);
    run_and_check_text(folder, &["man", HOSTILE], 0);
    run_and_check_text(folder, &["watch", &inside("broken.gltf"), "-o", "W"], 2);
}

#[test]
fn texts_of_plans_and_settings_are_printed_without_effect() {
    let scene = scene();
    let folder = scene.path();
    let config = folder.join("A").join(HOSTILE).join("roughcast.toml");
    for text in
        ["model = \"\n::error::\"", "\u{1b}]0;x\u{7} = 1", "[[override]]\nfiles = 'a[\u{1b}'", "\"\\u001b\\n::\" = 1"]
    {
        fs::write(&config, text).expect("a file");
        let run = run_and_check_text(folder, &["bake", "A", "-o", "O"], 2);
        assert_eq!(run.err.lines().count(), 1, "{}", run.err);
    }
    fs::remove_file(config).expect("a file");
    fs::remove_file(folder.join("A").join(HOSTILE).join("broken.gltf")).expect("a file");
    let plan = roughcast_in(folder, ["plan", "A", "-o", "O", "--json"]);
    assert_eq!(plan.code, 0, "{}", plan.err);
    fs::write(folder.join("plan.json"), &plan.out).expect("a file");
    let plan: serde_json::Value = serde_json::from_str(&plan.out).expect("JSON");
    let report = serde_json::json!({ "formatVersion": 1, "assets": [
        { "job": plan["jobs"][0]["id"], "input": plan["jobs"][0]["source"], "error": HOSTILE },
    ] });
    fs::write(folder.join("report.json"), report.to_string()).expect("a file");
    let merged = run_and_check_text(folder, &["plan", "merge", "plan.json", "report.json"], 1);
    assert!(merged.out.contains("failed A/\\u{1b}]0;x"), "{}", merged.out);
    run_and_check_text(folder, &["plan", "merge", "plan.json"], 4);
}
