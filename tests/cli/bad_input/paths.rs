//! Files that are missing, or that an asset must not refer to.

use std::fs;

use super::*;

#[test]
fn reports_missing_files() {
    for name in ["brushed_normal.png", "brushed_surface.png", "brushed_colour.png", "brushed.bin"] {
        let scene = Scene::new();
        fs::remove_file(scene.bad(name)).expect("a file");
        assert_contains(&scene.error_line(&[]), &["bad/brushed.gltf: ", "expected a readable file at ", name]);
    }
}

#[test]
fn rejects_a_folder_instead_of_a_file() {
    let scene = Scene::new();
    fs::remove_file(scene.bad("brushed_normal.png")).expect("a file");
    fs::create_dir(scene.bad("brushed_normal.png")).expect("a folder");
    assert_contains(
        &scene.error_line(&[]),
        &["bad/brushed.gltf: ", "Brushed steel", "brushed_normal.png", "found: a folder"],
    );
}

/// Each URI names a file that exists, or one that an asset must not ask for.
#[test]
fn rejects_uris_that_leave_the_folder() {
    let secret = |scheme: &str| format!("{scheme}{}", fixtures().join("brushed/brushed_normal.png").display());
    for (uri, part) in [
        ("../good/waves.glb".to_owned(), "inside the folder"),
        ("%2E%2E/good/waves.glb".to_owned(), "inside the folder"),
        ("..%2Fgood%2Fwaves.glb".to_owned(), "without '/'"),
        ("..\\\\good\\\\waves.glb".to_owned(), "without '/'"),
        (secret(""), "relative to the asset"),
        (secret("file://"), "the scheme \"file:\""),
        ("http://localhost:9/a.png".to_owned(), "the scheme \"http:\""),
        ("C:\\\\a.png".to_owned(), "relative to the asset"),
        ("//localhost/a.png".to_owned(), "relative to the asset"),
    ] {
        for old in ["brushed_normal.png", "brushed_colour.png", "brushed.bin"] {
            let scene = Scene::new();
            scene.edit(old, &uri);
            assert_contains(&scene.error_line(&[]), &["bad/brushed.gltf: ", "expected", part]);
        }
    }
}

#[test]
fn rejects_data_uris_without_data() {
    for (uri, part) in [("data:image/png;base64", "','"), ("data:image/png;base64,@@@@", "base64")] {
        let scene = Scene::new();
        scene.edit("brushed_normal.png", uri);
        assert_contains(&scene.error_line(&[]), &["bad/brushed.gltf: ", "expected", part]);
    }
}

#[test]
fn rejects_inputs_that_are_not_assets() {
    let scene = Scene::new();
    let empty = scene.folder.path().join("empty");
    fs::create_dir(&empty).expect("a folder");
    let image = fixtures().join("maps/vgroove_normal.png");
    let missing = scene.folder.path().join("missing.gltf");
    let good = scene.input().join("good");
    for (bad, part) in [(empty, "found none"), (image, "roughcast map"), (missing, "No such file")] {
        let output = scene.output();
        let run = roughcast(["bake".as_ref(), bad.as_os_str(), good.as_os_str(), "-o".as_ref(), output.as_os_str()]);
        assert_contains(&one_line(&run), &["expected", part]);
        assert!(output.join("waves.glb").is_file(), "the other input is not baked");
        fs::remove_dir_all(output).expect("a folder");
    }
}
