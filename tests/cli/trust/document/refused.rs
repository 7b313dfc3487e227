//! Files that are not assets or are incomplete. Each error says what they are and what to do.

use super::*;

const POINTER: &str =
    "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32\nsize 12345\n";

#[test]
fn missing_files_are_named_together() {
    let sphere = Sphere::new();
    for name in ["brushed_colour.png", "brushed.bin"] {
        fs::remove_file(sphere.file(name)).expect("a file");
    }
    let line = sphere.error_line(&[]);
    let expected =
        "expected readable files at brushed_colour.png, brushed.bin, found none; put them there or fix their URIs";
    assert!(line.contains(expected), "{line}");
    sphere.edit(|root| {
        let absent = (0..20).map(|image| json!({ "uri": format!("absent{image}.png") }));
        root["images"].as_array_mut().expect("images").extend(absent);
    });
    let line = sphere.error_line(&[]);
    assert!(line.contains("brushed_colour.png, absent0.png, ") && line.contains("absent8.png and 12 more"), "{line}");
}

#[test]
fn errors_on_git_lfs_pointers_name_the_command_to_run() {
    let baked = ["brushed.gltf", "brushed_normal.png", "brushed_surface.png", "brushed.bin"];
    // The last one is copied as it is, or into a .glb.
    for name in baked.into_iter().chain(["brushed_colour.png"]) {
        for options in [&[][..], &["--glb"]] {
            let sphere = Sphere::new();
            fs::write(sphere.file(name), POINTER).expect("a file");
            let line = sphere.error_line(options);
            assert!(line.contains("found a Git LFS pointer instead of the file; run `git lfs pull`"), "{name}: {line}");
        }
    }
    // A document without bumps is copied as it is.
    let sphere = Sphere::new();
    sphere.edit(|root| drop(root["materials"][0].as_object_mut().expect("a material").remove("normalTexture")));
    fs::write(sphere.file("brushed_colour.png"), POINTER).expect("a file");
    let line = sphere.error_line(&[]);
    assert!(line.contains("expected an image at brushed_colour.png, found a Git LFS pointer"), "{line}");
}

#[test]
fn errors_on_other_files_say_what_to_do() {
    let folder = tempdir().expect("a folder");
    let output = folder.path().join("out");
    for (name, bytes, expected) in [
        ("a.glb", &b""[..], "an empty file; copy or export it again"),
        ("a.glb", b"x\n", "a file that starts with \"x\\n\"; export the scene as glTF 2.0 (.glb or .gltf)"),
        ("a.glb", b"Kaydara FBX Binary  \0", "an FBX file; export the scene as glTF 2.0"),
        ("a.gltf", b"<!DOCTYPE html>", "a web page; download the file itself"),
        ("a.fbx", b"Kaydara FBX Binary  \0", "a .fbx file (export the scene as glTF 2.0)"),
        ("a.OBJ", b"v 0 0 0", "a .OBJ file (export the scene as glTF 2.0)"),
        ("a.usdz", b"PK\x03\x04", "a .usdz file (export the scene as glTF 2.0)"),
        ("a.png", b"\x89PNG", "a .png file (standalone maps are for `roughcast map`)"),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, bytes).expect("a file");
        let line = error_line(&path, &output, &[]);
        assert!(line.contains(&format!("found {expected}")), "{name}: {line}");
    }
}

#[test]
fn documents_of_other_versions_are_refused() {
    let folder = tempdir().expect("a folder");
    let path = folder.path().join("a.gltf");
    for (text, expected) in [
        ("null", "expected a GLB or a JSON object"),
        ("[]", "expected a GLB or a JSON object"),
        ("\"x\"", "expected a GLB or a JSON object"),
        ("{}", "found no \"asset\""),
        (r#"{"asset":{"version":"1.0"}}"#, "expected glTF 2.0, found \"1.0\" as asset.version"),
        (r#"{"asset":{"version":"99"}}"#, "expected glTF 2.0, found \"99\" as asset.version"),
        (r#"{"asset":{"version":"2.0","minVersion":"2.1"}}"#, "expected glTF 2.0, found \"2.1\" as asset.minVersion"),
    ] {
        fs::write(&path, text).expect("a file");
        let line = error_line(&path, &folder.path().join("out"), &[]);
        assert!(line.contains(expected) && line.ends_with("(.glb or .gltf)"), "{line}");
    }
}
