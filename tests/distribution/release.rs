//! Tests of the scripts that publish a release, with stand-ins for the command lines of registries and hosts.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::{TempDir, tempdir};

use super::shell::{run, script};

/// Makes a folder with a program that takes the place of another one.
fn stand_in(name: &str, text: &str) -> TempDir {
    let folder = tempdir().expect("a folder");
    let program = folder.path().join(name);
    fs::write(&program, format!("#!/bin/sh\n{text}\n")).expect("a file");
    run(Command::new("chmod").arg("+x").arg(program));
    folder
}

/// Packs a tarball of an npm package that has a name and no contents.
fn npm_package(folder: &Path, name: &str, file: &str) {
    fs::create_dir_all(folder.join("package")).expect("a folder");
    let manifest = format!("{{\"name\":\"{name}\",\"version\":\"1.2.3\"}}");
    fs::write(folder.join("package/package.json"), manifest).expect("a file");
    let (code, text) = run(Command::new("tar").args(["-czf", file, "package"]).current_dir(folder));
    assert_eq!(code, 0, "{text}");
}

/// A release stops before it publishes anything if a file has another version, or an address is missing.
#[test]
fn a_release_of_another_version_is_refused() {
    let (code, text) = run(script(".github/release/check-version", &[]).arg("v99.0.0"));
    assert_eq!(code, 1, "{text}");
    assert!(text.contains("error: crate roughcast: expected the version of tag v99.0.0, found "), "{text}");
    assert!(text.contains("error: npm/roughcast/package.json: expected the version of tag v99.0.0, found "), "{text}");
    assert!(text.contains("error: CHANGELOG.md: expected a section [99.0.0], found none"), "{text}");
}

#[test]
fn npm_packages_of_platforms_come_first_and_once() {
    let packages = tempdir().expect("a folder");
    npm_package(packages.path(), "roughcast", "a.tgz");
    npm_package(packages.path(), "@roughcast/linux-x64", "b.tgz");
    let published = |known: &str| {
        let npm =
            stand_in("npm", "case $1 in view) [ \"$2\" != \"$KNOWN\" ] || echo 1.2.3 ;; *) basename \"$4\" ;; esac");
        let mut publish = script(".github/release/publish-npm", &[npm.path()]);
        run(publish.arg(packages.path()).env("KNOWN", known))
    };
    assert_eq!(published("none"), (0, "b.tgz\na.tgz\n".to_owned()));
    let again = "@roughcast/linux-x64@1.2.3 is published already\na.tgz\n";
    assert_eq!(published("@roughcast/linux-x64@1.2.3"), (0, again.to_owned()));
}

/// The release has the changes of its version only, and a version that is no candidate moves the tag of the action.
#[test]
fn a_release_has_its_section_of_the_changelog() {
    let gh = stand_in(
        "gh",
        "case $* in 'release view'*) exit 1 ;; *notes-file*) echo \"$@\" && cat ;; *) echo \"$@\" ;; esac",
    );
    let folder = tempdir().expect("a folder");
    let changes = "# Changelog\n\n## [1.2.3] - 2026-01-02\n\n- new\n\n## [1.2.2]\n\n- old\n";
    fs::write(folder.path().join("CHANGELOG.md"), changes).expect("a file");
    fs::write(folder.path().join("file"), "").expect("a file");
    let published = |tag: &str| {
        let mut publish = script(".github/release/publish-release", &[gh.path()]);
        publish.arg(".").current_dir(folder.path()).env("GITHUB_REF_NAME", tag).env("GITHUB_SHA", "abc");
        run(publish.env("GITHUB_REPOSITORY", "OWNER/REPOSITORY"))
    };
    let (code, text) = published("v1.2.3");
    assert!(code == 0 && text.contains("\n- new\n") && !text.contains("old"), "{text}");
    assert!(text.contains("release upload v1.2.3 --clobber ./CHANGELOG.md ./file\n"), "{text}");
    assert!(text.contains("repos/OWNER/REPOSITORY/git/refs/tags/v1 -f sha=abc"), "{text}");
    let (code, text) = published("v1.2.4-rc.1");
    assert!(code == 0 && text.contains("--prerelease") && !text.contains("git/refs"), "{text}");
}
