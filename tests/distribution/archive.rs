//! Tests of the archives of a release, which `cargo binstall` and the action unpack.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tempfile::tempdir;

use super::shell::{in_repository, run, script};

/// The target of the archives of these tests. Any would do, since nothing is built for it.
pub const TARGET: &str = "x86_64-unknown-linux-gnu";
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Packs the tool of this build into an archive in a folder, and returns its path.
pub fn pack(folder: &Path) -> PathBuf {
    let mut archive = script(".github/release/archive", &[]);
    let (code, text) = run(archive.args([env!("CARGO_BIN_EXE_roughcast"), TARGET]).arg(folder));
    assert_eq!(code, 0, "{text}");
    folder.join(format!("roughcast-{VERSION}-{TARGET}.tar.gz"))
}

/// Returns a template of `[package.metadata.binstall]` with its variables replaced as cargo-binstall does.
fn binstall(key: &str) -> String {
    let manifest = fs::read_to_string(in_repository("Cargo.toml")).expect("Cargo.toml");
    let manifest: toml::Table = manifest.parse().expect("TOML");
    let template = manifest["package"]["metadata"]["binstall"][key].as_str().expect("a template");
    let values = [("name", "roughcast"), ("bin", "roughcast"), ("version", VERSION), ("target", TARGET)];
    let values = values.into_iter().chain([("binary-ext", ""), ("repo", "REPOSITORY")]);
    values.fold(template.to_owned(), |text, (name, value)| text.replace(&format!("{{ {name} }}"), value))
}

#[test]
fn the_archive_is_what_binstall_expects() {
    let folder = tempdir().expect("a folder");
    let archive = pack(folder.path());
    let name = archive.file_name().expect("a name").to_str().expect("text");
    assert_eq!(binstall("pkg-url"), format!("REPOSITORY/releases/download/v{VERSION}/{name}"));
    assert_eq!(binstall("pkg-fmt"), "tgz");

    let (code, list) = run(Command::new("tar").arg("-tzf").arg(&archive));
    assert_eq!(code, 0, "{list}");
    let root = format!("roughcast-{VERSION}-{TARGET}");
    let files = ["LICENSE-MIT", "LICENSE-APACHE", "README.md", "man/roughcast-bake.1", "completions/roughcast.zsh"];
    for file in files.iter().map(|file| format!("{root}/{file}")).chain([binstall("bin-dir")]) {
        assert!(list.lines().any(|line| line == file), "no {file} in {list}");
    }
}

/// The sample of a release is baked by the tool of the archive, and has the extension with its base lobe.
#[test]
fn the_sample_has_the_vendor_extension() {
    let folder = tempdir().expect("a folder");
    let archive = pack(folder.path());
    let (code, text) = run(script(".github/release/sample", &[]).arg(archive).arg(folder.path()));
    assert_eq!(code, 0, "{text}");
    let sample = fs::read(folder.path().join(format!("roughcast-sample-{VERSION}.glb"))).expect("a sample");
    let length = u32::from_le_bytes(sample[12..16].try_into().expect("four bytes")) as usize;
    let document: Value = serde_json::from_slice(&sample[20..20 + length]).expect("JSON");
    let extension = &document["materials"][0]["extensions"]["ROUGHCAST_materials_roughness_pyramid"];
    assert!(extension["baseLobe"].is_object(), "{document}");
}

/// The digests of a bake are compared between platforms, so that they must not depend on the order of a folder.
#[test]
fn digests_list_every_file_in_order() {
    let folder = tempdir().expect("a folder");
    fs::create_dir(folder.path().join("b")).expect("a folder");
    for (file, text) in [("b/two words.txt", "x"), ("a.txt", "x"), ("c.txt", "y")] {
        fs::write(folder.path().join(file), text).expect("a file");
    }
    let (code, text) = run(script(".github/release/digests", &[]).arg(folder.path()));
    let lines: Vec<(&str, &str)> = text.lines().map(|line| line.split_once(' ').expect("a digest")).collect();
    assert_eq!((code, lines.len()), (0, 3), "{text}");
    assert_eq!(lines.iter().map(|line| line.1).collect::<Vec<_>>(), ["./a.txt", "./b/two words.txt", "./c.txt"]);
    assert!(lines[0].0 == lines[1].0 && lines[0].0 != lines[2].0, "{text}");
}
