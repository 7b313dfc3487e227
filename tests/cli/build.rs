//! What build systems need: depfiles, a build script, completions and manual pages.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::tempdir;

use super::process::{copy, fixtures, roughcast_in};

/// Returns targets and prerequisites as Make reads them.
fn rules(text: &str) -> Vec<(String, Vec<String>)> {
    let text = text.replace("\\\n", " ");
    let names = |text: &str| -> Vec<String> {
        let kept = text.replace("\\ ", "\u{1}").replace("\\#", "#").replace("$$", "$");
        kept.split_whitespace().map(|name| name.replace('\u{1}', " ")).collect()
    };
    text.lines().filter_map(|rule| rule.split_once(": ")).map(|(t, p)| (names(t).remove(0), names(p))).collect()
}

#[test]
fn depfiles_name_what_each_output_was_made_from() {
    let folder = tempdir().expect("a folder");
    let assets = folder.path().join("my assets #1");
    copy(&fixtures().join("brushed"), &assets);
    fs::write(assets.join("roughcast.toml"), "model = \"isotropic\"\n").expect("a file");
    let run = roughcast_in(folder.path(), ["bake", "my assets #1", "-o", "o", "-q", "--depfile", "o/bake.d"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let rules = rules(&fs::read_to_string(folder.path().join("o/bake.d")).expect("a depfile"));
    assert_eq!(rules.len(), 1, "{rules:?}");
    let (target, inputs) = &rules[0];
    for path in inputs.iter().chain([target]) {
        assert!(folder.path().join(path).is_file(), "{path} of {rules:?}");
    }
    let has = |name: &str| inputs.iter().any(|input| input.ends_with(name));
    assert!(
        target.starts_with("o/") && has(".gltf") && has("brushed_normal.png") && has("my assets #1/roughcast.toml"),
        "{rules:?}"
    );
    assert!(has("brushed_colour.png"), "the base colour decides on the reflectance: {rules:?}");
}

/// Make runs a rule again while an output is older than an input.
#[test]
fn outputs_from_the_cache_are_newer_than_touched_inputs() {
    let folder = tempdir().expect("a folder");
    copy(&fixtures().join("brushed"), &folder.path().join("a"));
    let bake = || roughcast_in(folder.path(), ["bake", "a", "-o", "o", "--cache", "c", "--depfile", "o/bake.d"]);
    assert_eq!(bake().code, 0);
    let modified = |path: &str| fs::metadata(folder.path().join(path)).and_then(|m| m.modified()).expect("a time");
    let input = fs::File::options().append(true).open(folder.path().join("a/brushed_normal.png")).expect("a file");
    let later = modified("o/brushed.gltf") + std::time::Duration::from_millis(1);
    input.set_modified(later).expect("a time");
    std::thread::sleep(std::time::Duration::from_millis(20));
    let run = bake();
    assert!(run.out.starts_with("cached "), "{}", run.out);
    assert!(modified("o/brushed.gltf") > modified("a/brushed_normal.png"));
}

#[test]
fn the_build_script_bakes_and_reports_its_inputs_to_cargo() {
    let folder = tempdir().expect("a folder");
    copy(&fixtures().join("brushed"), &folder.path().join("assets"));
    let tests = std::env::current_exe().expect("a path");
    let script = tests.parent().and_then(Path::parent).expect("target/debug").join("examples/build_script");
    let out = folder.path().join("out");
    let output = Command::new(script).env("CARGO_MANIFEST_DIR", folder.path()).env("OUT_DIR", &out).output();
    let output =
        output.expect("`cargo test` builds examples, `cargo test --test cli` needs `cargo build --examples` first");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = String::from_utf8(output.stdout).expect("text");
    let inputs: Vec<&str> = lines.lines().filter_map(|line| line.strip_prefix("cargo::rerun-if-changed=")).collect();
    assert!(inputs.len() > 2 && inputs.iter().all(|input| Path::new(input).exists()), "{lines}");
    let baked = fs::read_dir(&out).expect("outputs").map(|e| e.expect("an entry").path());
    assert!(baked.filter(|path| path.extension().is_some_and(|e| e == "gltf")).count() == 1);
}

#[test]
fn completions_and_manual_pages_list_every_command() {
    let folder = tempdir().expect("a folder");
    let commands = ["bake", "init", "map", "plan", "check", "inspect", "compare", "render"];
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let run = roughcast_in(folder.path(), ["completions", shell]);
        assert!(run.code == 0 && commands.iter().all(|command| run.out.contains(command)), "{shell}");
    }
    let run = roughcast_in(folder.path(), ["man", "man1"]);
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    for command in commands {
        let page = fs::read_to_string(folder.path().join(format!("man1/roughcast-{command}.1"))).expect("a page");
        assert!(page.contains("Example"), "{command}");
    }
    fs::write(folder.path().join("file"), "").expect("a file");
    let run = roughcast_in(folder.path(), ["man", "file/man1"]);
    assert!(run.code == 1 && run.err.contains("expected to write file/man1/"), "{}", run.err);
}
