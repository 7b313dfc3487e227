//! Tests of the workflows: what a linter finds, and names that several files must agree on.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use serde_json::Value;

use super::shell::{in_repository, path_with, run};
use super::skip::missing_tool;

/// The workflows of this repository.
const OWN: [&str; 2] = [".github/workflows/ci.yml", ".github/workflows/release.yml"];

/// The workflows that users copy.
const EXAMPLES: [&str; 2] = ["examples/ci/github.yml", "examples/farm/github.yml"];

fn text(path: &str) -> String {
    fs::read_to_string(in_repository(path)).expect(path)
}

fn yaml(path: &str) -> Value {
    serde_saphyr::from_str(&text(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Returns the values of a key anywhere in a document.
fn values<'a>(document: &'a Value, key: &str) -> Vec<&'a str> {
    match document {
        Value::Object(members) => {
            let own = members.get(key).and_then(Value::as_str);
            own.into_iter().chain(members.values().flat_map(|value| values(value, key))).collect()
        }
        Value::Array(items) => items.iter().flat_map(|item| values(item, key)).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn linters_find_nothing() {
    let venv = in_repository("tools/distribution/venv/bin");
    if !venv.join("actionlint").is_file() {
        missing_tool("tests of workflows need `bash tools/distribution/install`");
        return;
    }
    // actionlint runs shellcheck on the scripts in workflows if it is on the PATH.
    let mut actionlint = Command::new(venv.join("actionlint"));
    actionlint.current_dir(in_repository("")).env("PATH", path_with(&[&venv]));
    assert_eq!(run(actionlint.args(OWN).args(EXAMPLES)), (0, String::new()));

    let mut shellcheck = Command::new(venv.join("shellcheck"));
    for folder in [".github/action", ".github/release"] {
        let scripts = fs::read_dir(in_repository(folder)).expect("a folder");
        shellcheck.args(scripts.map(|entry| entry.expect("an entry").path()));
    }
    let installers = ["tools/distribution/install", "tools/interop/install-blender", "benches/sizes/install"];
    shellcheck.arg(in_repository("python/check")).args(installers.map(in_repository));
    assert_eq!(run(&mut shellcheck), (0, String::new()));

    let hadolint = run(Command::new(venv.join("hadolint")).arg(in_repository("Containerfile")));
    assert_eq!(hadolint, (0, String::new()));
}

/// A tag of an action can be moved; a digest of a commit cannot.
#[test]
fn actions_are_pinned_to_commits() {
    for path in OWN {
        let document = yaml(path);
        let uses = values(&document, "uses");
        assert!(uses.len() > 2, "{path}");
        for action in uses {
            let commit = action.split_once('@').expect("a version").1;
            assert!(commit.len() == 40 && commit.bytes().all(|byte| byte.is_ascii_hexdigit()), "{path}: {action}");
        }
    }
}

/// The action downloads archives for the targets that a release builds.
#[test]
fn the_action_knows_the_targets_of_a_release() {
    let release = yaml(".github/workflows/release.yml");
    let targets: BTreeSet<&str> = values(&release["jobs"]["build"]["strategy"], "target").into_iter().collect();
    assert_eq!(targets.len(), 6);
    let install = text(".github/action/install");
    let known = install.lines().filter_map(|line| line.split_once(") echo ")?.1.strip_suffix(" ;;"));
    assert_eq!(known.collect::<BTreeSet<_>>(), targets);
}

/// Scripts that workflows and the action name exist and can be executed.
#[test]
fn scripts_exist() {
    for path in OWN.into_iter().chain(["action.yml"]) {
        let document = yaml(path);
        for command in values(&document, "run") {
            for word in command.split(|c: char| c.is_whitespace() || c == '"') {
                let Some(script) = word.find(".github/").map(|start| &word[start..]) else { continue };
                let (code, _) = run(Command::new("test").arg("-x").arg(in_repository(script)));
                assert_eq!(code, 0, "{path}: {script} cannot be executed");
            }
        }
    }
}

/// `.ci/run` is what CI runs, with the Rust version of the manifest.
#[test]
fn ci_runs_all_checks() {
    let workflow = yaml(".github/workflows/ci.yml");
    assert!(values(&workflow, "run").contains(&".ci/run"));
    let rust = env!("CARGO_PKG_RUST_VERSION");
    assert_eq!(workflow["jobs"]["checks"]["container"]["image"], format!("rust:{rust}-bookworm"));
    assert!(text("Containerfile").contains(&format!("FROM rust:{rust}-bookworm AS build\n")));
    for path in OWN {
        let document = yaml(path);
        let toolchains = values(&document, "run").into_iter().filter(|run| run.contains("rustup toolchain"));
        for command in toolchains {
            assert!(command.contains(&format!("rustup default {rust}")), "{path}: {command}");
        }
    }
}
