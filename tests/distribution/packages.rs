//! Tests that every crate can be published: what its manifest says and what its package holds.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use serde_json::Value;

use super::shell::in_repository;

/// Returns the packages of the workspace that are published, by name, as `cargo metadata` describes them.
fn published() -> BTreeMap<String, Value> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["metadata", "--format-version=1", "--no-deps", "--locked", "--offline"]);
    let output = cargo.current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("cargo");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages").iter();
    let published = packages.filter(|package| package["publish"].is_null());
    published.map(|package| (package["name"].as_str().expect("a name").to_owned(), package.clone())).collect()
}

#[test]
fn manifests_have_what_the_registry_shows() {
    let published = published();
    let names: Vec<&str> = published.keys().map(String::as_str).collect();
    assert_eq!(names, ["roughcast", "roughcast-core", "roughcast-pipeline", "texel-simd", "uastc-encoder"]);
    for (name, package) in &published {
        let text = |field: &str| package[field].as_str().unwrap_or_else(|| panic!("{name} has no {field}"));
        assert!((20..200).contains(&text("description").len()), "{name}: {}", text("description"));
        assert_eq!(text("license"), "MIT OR Apache-2.0", "{name}");
        assert_eq!(text("documentation"), format!("https://docs.rs/{name}"));
        assert!(text("readme") == "README.md" && !text("rust_version").is_empty(), "{name}");
        for field in ["keywords", "categories"] {
            let count = package[field].as_array().map_or(0, Vec::len);
            assert!((1..=5).contains(&count), "{name} has {count} {field}");
        }
        assert!(package["metadata"]["docs"]["rs"].is_object(), "{name} has no settings for docs.rs");
    }
}

/// A crate that is published needs the version of each crate of the workspace that it depends on.
#[test]
fn crates_name_the_versions_of_each_other() {
    let published = published();
    for (name, package) in &published {
        for dependency in package["dependencies"].as_array().expect("dependencies") {
            let other = dependency["name"].as_str().expect("a name");
            if dependency["path"].is_null() {
                continue;
            }
            let version = published.get(other).unwrap_or_else(|| panic!("{name} needs {other}, which stays here"));
            let version = version["version"].as_str().expect("a version");
            assert_eq!(dependency["req"], format!("^{version}"), "{name} needs {other}");
        }
    }
}

#[test]
fn packages_hold_what_is_needed_and_little_more() {
    for (name, package) in published() {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["package", "--list", "--allow-dirty", "--offline", "--package", &name]);
        let output = cargo.current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("cargo");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let list = String::from_utf8(output.stdout).expect("paths");
        for file in ["README.md", "LICENSE-APACHE", "LICENSE-MIT", "src/lib.rs"] {
            assert!(list.lines().any(|line| line == file), "the package of {name} has no {file}");
        }
        let manifest = package["manifest_path"].as_str().expect("a path");
        let folder = std::path::Path::new(manifest).parent().expect("a folder");
        let bytes = |file: &str| fs::metadata(folder.join(file)).map_or(0, |metadata| metadata.len());
        let size: u64 = list.lines().map(bytes).sum();
        assert!(size < 2 << 20, "the package of {name} has {size} bytes");
        for file in list.lines() {
            assert!(bytes(file) < 256 << 10 && !file.starts_with("fixtures"), "the package of {name} has {file}");
        }
    }
}

/// The texts of all packages come from the same two files.
#[test]
fn licences_are_those_of_the_repository() {
    for folder in ["simd", "uastc", "core", "pipeline"] {
        for file in ["LICENSE-APACHE", "LICENSE-MIT"] {
            let text = |path: &str| fs::read_to_string(in_repository(path)).expect(path);
            assert_eq!(text(&format!("crates/{folder}/{file}")), text(file), "{folder}");
        }
    }
}
