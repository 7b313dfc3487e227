//! A `roughcast.toml` that was delivered with assets has fewer rights than one of the user.

use super::*;
use crate::process::roughcast_in;

/// Writes `home/.profile`, and a pack in `away` with `config`, whose buffer refers to that file.
fn pack(config: &str) -> TempDir {
    let scene = tempdir().expect("a folder");
    let folder = scene.path();
    fs::create_dir(folder.join("home")).expect("a folder");
    fs::write(folder.join("home/.profile"), "mine").expect("a file");
    let pack = folder.join("away/pack");
    copy(&fixtures().join("brushed"), &pack);
    fs::rename(pack.join("brushed.bin"), pack.join(".profile")).expect("a file");
    let text = fs::read_to_string(pack.join("brushed.gltf")).expect("a document");
    fs::write(pack.join("brushed.gltf"), text.replace("brushed.bin", ".profile")).expect("a file");
    fs::write(pack.join("roughcast.toml"), config).expect("a file");
    scene
}

fn output(name: &str) -> String {
    format!("output = '{name}'\nmodel = 'none'\n")
}

#[test]
fn a_pack_writes_to_no_folder_outside_of_the_working_folder() {
    for name in ["../../home", "../../home/new", "..", "../../away", "../.config", "../out/.hidden/x"] {
        let scene = pack(&output(name));
        let folder = scene.path().join("away");
        let before = hashes(scene.path());
        for line in ["bake pack -q", "bake pack/brushed.gltf -q", "plan pack", "watch pack"] {
            let run = run(&folder, line);
            assert_eq!(run.code, 2, "{line}: {}", run.err);
            for part in ["pack/roughcast.toml: expected `output` below the working folder", "name the folder with -o"] {
                assert!(run.err.contains(part), "{line}: {}", run.err);
            }
        }
        assert_eq!(hashes(scene.path()), before, "{name}");
    }
}

#[cfg(unix)]
#[test]
fn a_pack_writes_through_no_link() {
    let scene = pack(&output("../out"));
    let folder = scene.path().join("away");
    std::os::unix::fs::symlink("../home", folder.join("out")).expect("a link");
    let run = run(&folder, "bake pack -q");
    assert_eq!(run.code, 2, "{}", run.err);
    assert_eq!(fs::read(scene.path().join("home/.profile")).expect("a file"), b"mine");
}

#[test]
fn a_file_of_the_user_may_name_any_folder() {
    let scene = pack(&output("../../home/new"));
    let folder = scene.path().join("away");
    done(&folder, "bake pack -q --config pack/roughcast.toml");
    let named = hashes(&scene.path().join("home/new"));
    fs::remove_dir_all(scene.path().join("home/new")).expect("a folder");
    done(&folder.join("pack"), "bake . -q");
    assert_eq!(hashes(&scene.path().join("home/new")), named, "that of the working folder");
    done(&folder, "bake pack -q -o ../home/other");
    assert_eq!(hashes(&scene.path().join("home/other")), named, "-o wins");
    fs::write(folder.join("pack/roughcast.toml"), output("../baked")).expect("a file");
    done(&folder, "bake pack -q");
    assert_eq!(hashes(&folder.join("baked")), named, "below the working folder");
}

/// A server would get the assets, decide what the pictures are, and run the file that `tool` names.
#[test]
fn the_server_of_a_pack_is_not_used() {
    let words = |line: &'static str| line.split(' ');
    let scene = pack("[remote]\nurl = 'grpc://localhost:1'\nretries = 0\ntool = 'missing'\n");
    let folder = scene.path().join("away");
    let run = roughcast_in(&folder, words("bake pack -o O -q"));
    assert_eq!(run.code, 2, "{}", run.err);
    assert!(run.err.contains("pack/roughcast.toml: expected no [remote]"), "{}", run.err);
    done(&folder, "bake pack -o O -q --no-remote");
    // Builds without the feature refuse every server before they look for its tool.
    if cfg!(not(feature = "remote")) {
        return;
    }
    // The server of the user does not get the tool of the pack.
    let run = roughcast_in(&folder, words("bake pack -o O -q --remote grpc://localhost:1 --remote-retries 0"));
    assert!(run.code != 0 && run.err.contains("localhost:1") && !run.err.contains("missing"), "{}", run.err);
    // These settings are of the user, and the tool is looked for.
    for (line, working_folder) in
        [("bake . -o ../O -q", "pack"), ("bake pack -o O -q --config pack/roughcast.toml", ".")]
    {
        let run = roughcast_in(&folder.join(working_folder), words(line));
        assert!(run.code != 0 && run.err.contains("missing"), "{line}: {}", run.err);
    }
}
