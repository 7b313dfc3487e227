//! Files that are not what their names say, given to the commands that read one file.

use std::fs;

use tempfile::tempdir;

use super::assert_contains;
use crate::process::run;

const POINTER: &[u8] = b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 7\n";

#[test]
fn each_command_says_what_a_file_is_instead_and_what_to_do() {
    let folder = tempdir().expect("a folder");
    for (name, bytes) in [
        ("pointer.glb", POINTER),
        ("pointer.gltf", POINTER),
        ("pointer.ktx2", POINTER),
        ("pointer.png", POINTER),
        ("empty.glb", b""),
        ("empty.png", b""),
        ("empty.ktx2", b""),
        ("scene.fbx", b"Kaydara FBX Binary  \0\x1a"),
        ("scene.obj", b"# Blender 4.2\nv 0 0 0\n"),
        ("scene.usdc", b"PXR-USDC\0"),
        ("scene.blend", b"BLENDER-v402"),
        ("scene.glb", b"glTF\x02\0\0\0"),
    ] {
        fs::write(folder.path().join(name), bytes).expect("a file");
    }
    for name in ["folder", "scenes"] {
        fs::create_dir(folder.path().join(name)).expect("a folder");
    }
    fs::copy(folder.path().join("scene.fbx"), folder.path().join("scenes/scene.fbx")).expect("a file");
    let (lfs, empty, export) = ("run `git lfs pull`", "an empty file", "export the scene as glTF 2.0");
    let mut cases = Vec::new();
    for command in ["inspect", "compare -o out", "render -o out"] {
        for name in ["pointer.glb", "pointer.gltf", "pointer.ktx2", "pointer.png"] {
            cases.push((command, name, lfs));
        }
        for name in ["empty.glb", "empty.png", "empty.ktx2"] {
            cases.push((command, name, empty));
        }
        for name in ["scene.fbx", "scene.obj", "scene.usdc", "scene.blend"] {
            cases.push((command, name, export));
        }
        cases.push((command, "folder", "found: a folder; name a file in it"));
    }
    for name in ["pointer.png", "pointer.ktx2"] {
        cases.push(("map -o out.ktx2", name, lfs));
    }
    let (asset, path) = ("found a glTF asset", "found: a folder; name a file in it");
    for (name, part) in [("empty.png", empty), ("scene.fbx", export), ("scene.glb", asset), ("folder", path)] {
        cases.push(("map -o out.ktx2", name, part));
    }
    for (name, part) in [("pointer.glb", lfs), ("empty.glb", empty), ("scene.fbx", export), ("scene.obj", export)] {
        cases.push(("bake -o out", name, part));
    }
    cases.push(("bake -o out", "scenes", "others such as scenes/scene.fbx; export the scenes as glTF 2.0"));
    for (command, name, part) in cases {
        let (command, options) = command.split_once(' ').unwrap_or((command, ""));
        let ended = run(folder.path(), &format!("{command} {name} {options}"));
        assert_eq!((ended.code, ended.err.lines().count()), (1, 1), "{command} {name}: {}", ended.err);
        assert_contains(&ended.err, &["error: ", name, part]);
    }
    assert!(!folder.path().join("out").exists());
}

/// `check` reports damaged files as findings.
#[test]
fn check_says_what_a_file_is_instead_and_what_to_do() {
    let folder = tempdir().expect("a folder");
    for (name, expected) in [("a.glb", "expected a glTF document"), ("a.ktx2", "expected a KTX2 file")] {
        fs::write(folder.path().join(name), POINTER).expect("a file");
        let ended = run(folder.path(), &format!("check {name}"));
        assert_eq!(ended.code, 3, "{}", ended.err);
        let message = format!(": {expected}, found a Git LFS pointer instead of the file; run `git lfs pull`\n");
        assert_contains(&ended.out, &[&message]);
    }
}

#[test]
fn a_number_is_no_roughness_map() {
    let folder = tempdir().expect("a folder");
    let ended = run(folder.path(), "map a.png -o a.ktx2 --roughness 0.2");
    assert_eq!(ended.code, 2, "{}", ended.err);
    assert_contains(&ended.err, &["expected an image, found a number", "use --roughness-factor 0.2"]);
}

#[test]
fn a_map_is_written_to_ktx2_only() {
    let folder = tempdir().expect("a folder");
    fs::write(folder.path().join("a.png"), POINTER).expect("a file");
    for (output, expected) in [("b.png", "b.ktx2"), ("b", "b.ktx2"), ("b.dds", "b.ktx2")] {
        let ended = run(folder.path(), &format!("map a.png -o {output}"));
        assert_eq!(ended.code, 2, "{}", ended.err);
        assert_contains(
            &ended.err,
            &[&format!("-o {output}: expected the name of a .ktx2 file"), &format!("name it {expected}")],
        );
    }
}
