//! Tests that cached assets are not baked again, and that outputs from the cache equal those of a bake.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::SystemTime;

use serde_json::Value;
use tempfile::{TempDir, tempdir};

use super::process::{Run, copy, files, fixtures, hashes, roughcast_in};

fn scene() -> TempDir {
    let folder = tempdir().expect("a folder");
    for asset in ["brushed", "knobs", "waves"] {
        copy(&fixtures().join(asset), &folder.path().join("assets").join(asset));
    }
    fs::write(folder.path().join("assets/flat.gltf"), r#"{"asset":{"version":"2.0"}}"#).expect("a file");
    folder
}

fn run(folder: &Path, options: &str) -> Run {
    roughcast_in(folder, format!("bake assets -o out --cache cache --json {options}").split_whitespace())
}

/// Bakes and returns the status of each asset: brushed, flat, knobs, waves.
fn statuses(folder: &Path, options: &str) -> Vec<String> {
    let run = run(folder, options);
    assert_eq!((run.code, run.err.as_str()), (0, ""), "{options}");
    of_report(&run)
}

fn of_report(run: &Run) -> Vec<String> {
    let report: Value = serde_json::from_str(&run.out).expect("JSON");
    let assets = report["assets"].as_array().expect("assets").iter();
    assets.map(|asset| asset["status"].as_str().expect("a status").to_owned()).collect()
}

fn cached(folder: &Path, kind: &str) -> Vec<PathBuf> {
    files(&folder.join("cache").join(kind)).into_iter().map(|(_, path)| path).collect()
}

#[test]
fn a_second_run_bakes_nothing_and_touches_nothing() {
    let scene = scene();
    let folder = scene.path();
    assert_eq!(statuses(folder, ""), ["baked", "copied", "baked", "baked"]);
    let before = hashes(&folder.join("out"));
    let modified = || -> Vec<SystemTime> {
        files(&folder.join("out"))
            .iter()
            .map(|(_, path)| path.metadata().and_then(|m| m.modified()).expect("a time"))
            .collect()
    };
    let times = modified();
    assert_eq!(statuses(folder, ""), ["cached"; 4]);
    assert_eq!(modified(), times, "outputs that are right are written");
    // Inputs with a new time but equal contents, and outputs that are missing or wrong.
    let image = folder.join("assets/knobs/textures/surface.png");
    fs::write(&image, fs::read(&image).expect("an image")).expect("a file");
    fs::remove_dir_all(folder.join("out/brushed")).expect("a folder");
    fs::write(folder.join("out/waves/waves.glb"), "wrong").expect("a file");
    fs::write(folder.join("out/knobs/knobs.bin"), "wrong").expect("a file");
    assert_eq!(statuses(folder, ""), ["cached"; 4]);
    assert_eq!(hashes(&folder.join("out")), before);
    let report = |run: Run| serde_json::from_str::<Value>(&run.out).expect("JSON");
    let (with, without) =
        (report(run(folder, "")), report(roughcast_in(folder, "bake assets -o out --json".split(' '))));
    for index in 0..4 {
        for member in ["layers", "textures", "bytes", "output"] {
            assert_eq!(with["assets"][index][member], without["assets"][index][member], "{member}");
        }
    }
}

#[test]
fn only_what_changed_is_baked() {
    let scene = scene();
    let folder = scene.path();
    let config = folder.join("assets/roughcast.toml");
    fs::write(&config, "[[override]]\nfiles = 'waves/*'\nmodel = 'isotropic'\n").expect("a file");
    statuses(folder, "");
    fs::write(&config, "# Another.\n[[override]]\nfiles = 'waves/*'\nmodel = 'none'\n").expect("a file");
    assert_eq!(statuses(folder, ""), ["cached", "cached", "cached", "baked"]);
    fs::copy(folder.join("assets/brushed/brushed_normal.png"), folder.join("assets/knobs/knurled grip.png"))
        .expect("a file");
    assert_eq!(statuses(folder, ""), ["cached", "cached", "baked", "cached"]);
    assert_eq!(statuses(folder, "--max-error 0.12"), ["baked", "copied", "baked", "baked"]);
    assert_eq!(statuses(folder, ""), ["cached"; 4]);
    let with = hashes(&folder.join("out"));
    fs::remove_dir_all(folder.join("out")).expect("a folder");
    assert_eq!(roughcast_in(folder, "bake assets -o out -q".split(' ')).code, 0);
    let without = hashes(&folder.join("out"));
    for (name, hash) in without {
        assert_eq!(with.get(&name), Some(&hash), "{name}");
    }
}

/// The base colour decides on the reflectance of texels, and so on the roughness.
#[test]
fn another_base_colour_is_baked_again() {
    let scene = scene();
    let folder = scene.path();
    statuses(folder, "");
    let colour = folder.join("assets/brushed/brushed_colour.png");
    let size = image::open(&colour).expect("a picture").into_rgb8().dimensions();
    image::RgbImage::from_fn(size.0, size.1, |x, _| image::Rgb([(x % 256) as u8; 3])).save(&colour).expect("a file");
    assert_eq!(statuses(folder, ""), ["baked", "cached", "cached", "cached"]);
}

#[test]
fn a_corrupted_entry_is_dropped_with_a_warning_and_baked_again() {
    for kind in ["blobs", "jobs"] {
        let scene = scene();
        let folder = scene.path();
        statuses(folder, "");
        let before = hashes(&folder.join("out"));
        for path in cached(folder, kind) {
            let mut bytes = fs::read(&path).expect("a file");
            *bytes.last_mut().expect("a byte") ^= 1;
            fs::write(path, bytes).expect("a file");
        }
        fs::remove_dir_all(folder.join("out")).expect("a folder");
        let run = run(folder, "");
        assert_eq!(run.code, 0, "{}", run.err);
        assert_eq!(run.err.matches("warning: assets/").count(), 4, "{}", run.err);
        assert!(run.err.contains("the damaged file was removed"), "{}", run.err);
        assert_eq!(of_report(&run), ["baked", "copied", "baked", "baked"]);
        assert_eq!(hashes(&folder.join("out")), before);
        assert_eq!(statuses(folder, ""), ["cached"; 4]);
    }
}

#[test]
fn missing_blobs_are_baked_again() {
    let scene = scene();
    let folder = scene.path();
    statuses(folder, "");
    let before = hashes(&folder.join("out"));
    cached(folder, "blobs").iter().for_each(|path| fs::remove_file(path).expect("a file"));
    assert_eq!(statuses(folder, ""), ["cached"; 4], "outputs that are in place need no blob");
    fs::remove_dir_all(folder.join("out")).expect("a folder");
    assert_eq!(statuses(folder, ""), ["baked", "copied", "baked", "baked"]);
    assert_eq!(hashes(&folder.join("out")), before);
}

#[test]
fn the_cache_stays_within_its_size() {
    let scene = scene();
    let folder = scene.path();
    statuses(folder, "");
    let size =
        || -> u64 { files(&folder.join("cache")).iter().map(|(_, path)| path.metadata().expect("facts").len()).sum() };
    let all = size();
    statuses(folder, "--cache-size 40K");
    assert!(size() <= 40 << 10 && size() < all, "{} of {all}", size());
    statuses(folder, "--cache-size 0");
    assert_eq!(size(), 0);
    assert_eq!(statuses(folder, ""), ["baked", "copied", "baked", "baked"]);
}

#[test]
fn several_processes_share_a_cache_and_a_folder() {
    let scene = scene();
    let folder = scene.path();
    let start = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_roughcast"));
        command.current_dir(folder).args([
            "bake",
            "assets",
            "-o",
            "out",
            "--cache",
            "cache",
            "-q",
            "--cache-size",
            "60K",
        ]);
        command.stderr(Stdio::piped()).spawn().expect("the command starts")
    };
    for child in [start(), start(), start()] {
        let run = Run::from(child.wait_with_output().expect("an exit"));
        // On a busy machine a run may wait for so long that it says so, once.
        let wait = "note: waiting for another run of roughcast that writes to out\n";
        assert!(run.code == 0 && ["", wait].contains(&run.err.as_str()), "{}: {}", run.code, run.err);
    }
    let shared = hashes(&folder.join("out"));
    assert_eq!(roughcast_in(folder, "bake assets -o alone -q".split(' ')).code, 0);
    assert_eq!(hashes(&folder.join("alone")), shared);
    assert!(files(folder).iter().all(|(name, _)| !name.contains(".roughcast-")), "leftovers");
}

#[test]
fn a_cache_that_cannot_be_written_does_not_stop_a_bake() {
    let scene = scene();
    fs::write(scene.path().join("cache"), "a file").expect("a file");
    let run = run(scene.path(), "");
    assert_eq!((run.code, of_report(&run)), (0, ["baked", "copied", "baked", "baked"].map(str::to_owned).to_vec()));
    assert!(
        run.err.lines().all(|line| line.starts_with("warning: ") && line.contains("expected a cache")),
        "{}",
        run.err
    );
}

#[test]
#[cfg(not(feature = "object-store"))]
fn a_build_without_object_stores_rejects_their_urls() {
    let run = roughcast_in(scene().path(), "bake assets -o out --cache s3://bucket/prefix".split(' '));
    assert!(run.code == 2 && run.err.contains("build it with --features object-store"), "{}", run.err);
}
