//! Tests that any edits of a folder, in any order, lead to the outputs of a clean bake and the last good outputs of
//! assets that cannot be baked.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

use tempfile::tempdir;

use super::session::Session;
use crate::process::fixtures;
use crate::random::Random;

/// Most edits in a run.
const EDITS: usize = 14;

/// Folders of assets, names of documents, and images. Some images are shared or linked, and one is outside the watched
/// folder.
const FOLDERS: [&str; 4] = ["assets", "assets/a", "assets/b/c", "assets/b"];
const DOCUMENTS: [&str; 3] = ["one.gltf", "two.gltf", "One.gltf"];
const IMAGES: [&str; 4] = ["assets/a.png", "assets/a/a.png", "assets/b/shared.png", "shared/far.png"];
const URIS: [&str; 6] = ["a.png", "shared.png", "a/a.png", "b/shared.png", "link.png", "c/link.png"];
const CONFIGS: [&str; 3] = [
    "model = 'none'\n",
    "model = 'none'\n[[override]]\nfiles = 'one.gltf'\nmodel = 'isotropic'\n",
    "model = 'none'\n[[override]]\nfiles = 'a/**'\nglb = true\n",
];
const MAPS: [&str; 3] = ["line_normal.png", "vgroove_normal.png", "two_channel_normal.png"];

fn document(uri: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"images":[{{"uri":"{uri}"}}],"textures":[{{"source":0}}],
        "materials":[{{"normalTexture":{{"index":0}}}}]}}"#
    )
}

fn image(random: &mut Random) -> Vec<u8> {
    fs::read(fixtures().join("maps").join(random.pick(&MAPS))).expect("a fixture")
}

/// Saves a file as programs do: at once, in two parts, by renaming a new file, or after removing the old file.
fn save(random: &mut Random, path: &Path, bytes: &[u8]) {
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    let beside = path.with_extension("tmp~");
    match random.below(4) {
        0 => fs::write(path, bytes).expect("a file"),
        1 => {
            let (half, rest) = bytes.split_at(bytes.len() / 2);
            let mut file = fs::File::create(path).expect("a file");
            file.write_all(half).expect("bytes");
            sleep(Duration::from_millis(random.below(20) as u64));
            file.write_all(rest).expect("bytes");
        }
        2 => {
            fs::write(&beside, bytes).expect("a file");
            fs::rename(&beside, path).expect("a file");
        }
        _ => {
            let _ = fs::rename(path, &beside);
            fs::write(path, bytes).expect("a file");
            let _ = fs::remove_file(&beside);
        }
    }
}

/// Writes every image, and an asset to each folder.
fn fill(random: &mut Random, root: &Path) {
    for path in IMAGES {
        let bytes = image(random);
        save(random, &root.join(path), &bytes);
    }
    #[cfg(unix)]
    for (link, to) in [("assets/b/link.png", "../../shared/far.png"), ("assets/b/c/link.png", "../shared.png")] {
        fs::create_dir_all(root.join(link).parent().expect("a folder")).expect("a folder");
        let _ = std::os::unix::fs::symlink(to, root.join(link));
    }
    for (path, uri) in [
        ("assets/one.gltf", "a.png"),
        ("assets/two.gltf", "b/shared.png"),
        ("assets/a/two.gltf", "a.png"),
        ("assets/b/one.gltf", "link.png"),
        ("assets/b/c/two.gltf", "link.png"),
        ("assets/b/two.gltf", "shared.png"),
    ] {
        save(random, &root.join(path), document(uri).as_bytes());
    }
}

/// Makes one edit and returns its description.
fn edit(random: &mut Random, root: &Path) -> String {
    let asset = Path::new(random.pick(&FOLDERS)).join(random.pick(&DOCUMENTS));
    let picture = random.pick(&IMAGES);
    // An edit that fails, such as removing a missing file, counts as an edit.
    match random.below(15) {
        0..=2 => {
            let uri = random.pick(&URIS);
            save(random, &root.join(&asset), document(uri).as_bytes());
            format!("write {} of {uri}", asset.display())
        }
        3..=5 => {
            let bytes = image(random);
            save(random, &root.join(picture), &bytes);
            format!("write {picture}")
        }
        6 => {
            let bytes = image(random);
            save(random, &root.join(picture), &bytes[..bytes.len() / 2]);
            format!("break {picture}")
        }
        7 => {
            let _ = fs::remove_file(root.join(&asset));
            format!("remove {}", asset.display())
        }
        8 => {
            let _ = fs::remove_file(root.join(picture));
            format!("remove {picture}")
        }
        9 => {
            let to = root.join(random.pick(&FOLDERS)).join(random.pick(&DOCUMENTS));
            let _ = fs::rename(root.join(&asset), &to);
            format!("rename {} to {}", asset.display(), to.display())
        }
        10 => {
            let (from, to) = (random.pick(&FOLDERS[1..]), random.pick(&["assets/d", "assets/a", "away", "assets/b/e"]));
            let _ = fs::rename(root.join(from), root.join(to));
            format!("rename {from} to {to}")
        }
        11 => {
            let folder = random.pick(&FOLDERS[1..]);
            let _ = fs::remove_dir_all(root.join(folder));
            format!("remove {folder}")
        }
        12 => {
            let text = random.pick(&CONFIGS);
            save(random, &root.join("assets/roughcast.toml"), text.as_bytes());
            format!("configure {text:?}")
        }
        13 => {
            fill(random, root);
            "write all".to_owned()
        }
        _ => {
            // The folder goes and returns, as when a disk is mounted again or a branch is checked out.
            let _ = fs::rename(root.join("assets"), root.join("elsewhere"));
            sleep(Duration::from_millis(random.below(30) as u64));
            fs::rename(root.join("elsewhere"), root.join("assets")).expect("a folder");
            "move the folder away and back".to_owned()
        }
    }
}

fn sequence(seed: u64, options: &str) {
    let mut random = Random::new(seed);
    let folder = tempdir().expect("a folder");
    let root = folder.path();
    fs::create_dir_all(root.join("assets")).expect("a folder");
    save(&mut random, &root.join("assets/roughcast.toml"), CONFIGS[0].as_bytes());
    let mut history = vec![format!("seed {seed}, {options:?}")];
    fill(&mut random, root);
    let mut session = Session::start(root, options);
    for _ in 0..1 + random.below(EDITS) {
        history.push(edit(&mut random, root));
        sleep(Duration::from_millis([0, 0, 5, 60][random.below(4)]));
    }
    session.settle(root);
    session.assert_as_baked(root, &history.join("\n"));
    assert_eq!(session.stop().code, 0, "{history:#?}");
}

#[test]
fn any_edits_end_in_the_bytes_of_a_clean_bake() {
    for seed in 0..10 {
        sequence(seed, "");
    }
}

#[test]
fn any_edits_end_in_the_bytes_of_a_clean_bake_without_events() {
    for seed in 100..103 {
        sequence(seed, "--poll=10");
    }
    sequence(200, "--cache cache --settle 0");
}
