//! Output names that are too long for a file system are shortened.

use super::*;

/// Returns `waves.glb` with its material called `name`.
fn glb(name: &str) -> Vec<u8> {
    let bytes = fs::read(fixtures().join("waves/waves.glb")).expect("a file");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("a word")) as usize;
    let json = std::str::from_utf8(&bytes[20..20 + length]).expect("JSON").trim_end();
    let mut json = json.replace("\"Lake\"", &format!("\"{name}\""));
    json += &" ".repeat(json.len().next_multiple_of(4) - json.len());
    let total = (bytes.len() - length + json.len()) as u32;
    let length_of_json = json.len() as u32;
    let header = [&bytes[..8], &total.to_le_bytes(), &length_of_json.to_le_bytes(), &bytes[16..20]].concat();
    [&header, json.as_bytes(), &bytes[20 + length..]].concat()
}

fn assert_fit(folder: &Path) {
    let names: Vec<String> = hashes(folder).into_keys().collect();
    assert!(names.len() > 2, "{names:?}");
    assert!(names.iter().all(|name| name.split('/').all(|part| part.len() < 256)), "{names:?}");
}

#[test]
fn long_names_of_materials_are_shortened() {
    for name in ["a".repeat(300), "ä".repeat(125), "\u{1f4a7}".repeat(64)] {
        let scene = tempdir().expect("a folder");
        let folder = scene.path();
        fs::write(folder.join("w.glb"), glb(&name)).expect("a file");
        done(folder, "bake w.glb -o O -q --model anisotropic --glb=false");
        assert_fit(&folder.join("O"));
    }
}

#[test]
fn long_names_of_assets_are_shortened() {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    // The names differ only at their ends.
    let stem = "w".repeat(249);
    for last in ["1", "2"] {
        copy(&fixtures().join("waves"), &folder.join("A"));
        fs::rename(folder.join("A/waves.glb"), folder.join(format!("A/{stem}{last}.glb"))).expect("a file");
    }
    done(folder, "bake A -o O -q --cache cache --glb=false");
    assert_fit(&folder.join("O"));
    let documents = hashes(&folder.join("O")).into_keys().filter(|name| name.ends_with(".gltf")).count();
    assert_eq!(documents, 2);
    done(folder, "check O --source A --deep");
    let first = hashes(&folder.join("O"));
    fs::remove_dir_all(folder.join("O")).expect("a folder");
    done(folder, "bake A -o O -q --cache cache --glb=false");
    assert_eq!(hashes(&folder.join("O")), first);
}

#[test]
fn long_names_of_images_are_shortened() {
    let scene = scene();
    let folder = scene.path();
    for (name, letter) in [("brushed_normal", "n"), ("brushed_surface", "s")] {
        let long = letter.repeat(250);
        fs::rename(folder.join(format!("A/{name}.png")), folder.join(format!("A/{long}.png"))).expect("a file");
        edit(folder, name, &long);
    }
    done(folder, "bake A -o O -q");
    assert_fit(&folder.join("O"));
    done(folder, "inspect O/brushed.gltf --extract levels");
    done(folder, "render A/brushed.gltf -o pictures --scene sphere --width 8 --samples 2 -q");
}
