//! Tests that the licence of every dependency is allowed by deny.toml, and that every dependency comes from the
//! registry.

use std::path::Path;
use std::process::Command;

use serde_json::Value;
use spdx::{Expression, LicenseReq, Licensee, ParseMode};

#[test]
fn licences_are_allowed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let rules = std::fs::read_to_string(root.join("deny.toml")).expect("deny.toml");
    let rules: toml::Table = rules.parse().expect("TOML");
    let allowed: Vec<Licensee> = rules["licenses"]["allow"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|name| Licensee::parse(name.as_str().expect("a name")).expect("a licence"))
        .collect();
    let is_allowed = |licence: &LicenseReq| allowed.iter().any(|allowed| allowed.satisfies(licence));

    let mut metadata = Command::new(env!("CARGO"));
    metadata.current_dir(root).args(["metadata", "--format-version=1", "--locked", "--offline", "--all-features"]);
    // Only fetched packages are listed. Dependencies of other systems are missing.
    metadata.args(["--filter-platform", "x86_64-unknown-linux-gnu"]);
    let output = metadata.output().expect("cargo");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    assert!(packages.len() > 100);
    for package in packages {
        let name = &package["name"];
        let text = package["license"].as_str().unwrap_or_else(|| panic!("{name} names no licence"));
        let licence = Expression::parse_mode(text, ParseMode::LAX).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(licence.evaluate(is_allowed), "{name} is under {text}, which deny.toml does not allow");
        let is_ours = package["source"].is_null();
        assert!(is_ours || package["source"].as_str().is_some_and(|s| s.starts_with("registry+")), "{name}");
    }
}
