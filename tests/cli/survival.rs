//! Tests that no file is lost or incomplete when bakes are killed, run at the same time, or find links in circles.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::tempdir;

use super::process::{bake, copy, files, fixtures, hashes, roughcast, roughcast_in};

/// Starts a bake of `assets` to `out` in `folder`.
fn start(folder: &Path, options: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_roughcast"));
    command.current_dir(folder).args(["bake", "assets", "-o", "out", "--cache", "cache", "--quiet"]).args(options);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the command starts")
}

/// Two sets of options that bake quickly.
const OPTIONS: [&[&str]; 2] = [&["--model=isotropic", "--gltf=fallback"], &["--model=none", "--gltf=dual"]];

/// Returns the outputs with each set of options, by name.
fn expected(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let bake = |(index, options): (usize, &&[&str])| {
        let out = folder.join(format!("expected{index}"));
        bake(&folder.join("assets"), &out, options);
        hashes(&out)
    };
    OPTIONS.iter().enumerate().map(bake).collect()
}

#[test]
fn a_killed_bake_leaves_whole_files_and_the_next_bake_completes() {
    let folder = tempdir().expect("a folder");
    let folder = folder.path();
    copy(&fixtures().join("waves"), &folder.join("assets"));
    copy(&fixtures().join("knobs"), &folder.join("assets/knobs"));
    let (sources, expected) = (hashes(&folder.join("assets")), expected(folder));
    let start_of_run = Instant::now();
    assert!(start(folder, OPTIONS[0]).wait().expect("an end").success());
    let mut whole_run = start_of_run.elapsed();
    let mut random = 1_u64;
    let mut killed = 0;
    for round in 0..50 {
        if round % 4 < 2 {
            // The folder does not exist if the previous bake was killed before it began.
            let _ = fs::remove_dir_all(folder.join("cache"));
        }
        let index = round % 2;
        let (mut child, begin) = (start(folder, OPTIONS[index]), Instant::now());
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let moment = whole_run.mul_f64((random >> 40) as f64 / (1 << 24) as f64);
        while begin.elapsed() < moment && child.try_wait().expect("a process").is_none() {
            sleep(Duration::from_millis(1));
        }
        if child.try_wait().expect("a process").is_some() {
            // The bake ended before it was killed. The next one is killed sooner.
            whole_run = begin.elapsed();
        }
        let _ = child.kill();
        killed += i32::from(!child.wait().expect("an end").success());
        assert_eq!(hashes(&folder.join("assets")), sources, "a source changed");
        for (name, hash) in hashes(&folder.join("out")) {
            let is_left_over = name.rsplit('/').next().is_some_and(|name| name.starts_with(".roughcast-"));
            let is_whole = expected.iter().any(|outputs| outputs.get(&name) == Some(&hash));
            assert!(is_left_over || is_whole, "round {round}: {name} is half there");
        }
    }
    assert!(killed > 10, "only {killed} of 50 were killed in time");
    assert!(start(folder, OPTIONS[1]).wait().expect("an end").success());
    let found = hashes(&folder.join("out"));
    for (name, hash) in &expected[1] {
        assert_eq!(found.get(name), Some(hash), "{name}");
    }
}

#[test]
fn old_leftovers_of_a_killed_bake_are_removed() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("out");
    fs::create_dir(&out).expect("a folder");
    let names = [".roughcast-old", ".roughcast-new", "other"];
    for name in names {
        fs::write(out.join(name), "half").expect("a file");
    }
    let day_ago = std::time::SystemTime::now() - Duration::from_secs(86_400);
    for name in [names[0], names[2]] {
        fs::File::options().write(true).open(out.join(name)).and_then(|f| f.set_modified(day_ago)).expect("a file");
    }
    bake(&fixtures().join("waves/waves.glb"), &out, OPTIONS[0]);
    // A new temporary file may belong to a running bake.
    assert_eq!(names.map(|name| out.join(name).exists()), [false, true, true]);
}

#[test]
fn two_bakes_into_one_folder_at_once_both_finish() {
    let folder = tempdir().expect("a folder");
    let folder = folder.path();
    copy(&fixtures().join("waves"), &folder.join("assets"));
    copy(&fixtures().join("knobs"), &folder.join("assets/knobs"));
    let expected = expected(folder);
    for _ in 0..3 {
        let children: Vec<Child> = (0..3).map(|_| start(folder, OPTIONS[0])).collect();
        for mut child in children {
            assert!(child.wait().expect("an end").success());
        }
        assert_eq!(hashes(&folder.join("out")), expected[0]);
        fs::remove_dir_all(folder.join("out")).expect("a folder");
        fs::remove_dir_all(folder.join("cache")).expect("a folder");
    }
}

#[test]
fn rejects_paths_that_no_system_allows() {
    let folder = tempdir().expect("a folder");
    let waves = fixtures().join("waves/waves.glb");
    let long = "n".repeat(5000);
    let (deep, file) = (folder.path().join(&long), folder.path().join(format!("{long}.gltf")));
    for (input, output) in [(waves.as_path(), deep.as_path()), (file.as_path(), folder.path())] {
        let run = roughcast(["bake".as_ref(), input.as_os_str(), "-o".as_ref(), output.as_os_str()]);
        assert_eq!((run.code, run.err.lines().count()), (1, 1), "{}", run.err);
        assert!(run.err.contains("expected") && run.err.contains("File name too long"), "{}", run.err);
    }
    copy(&fixtures().join("brushed"), folder.path());
    let asset = folder.path().join("brushed.gltf");
    let text = fs::read_to_string(&asset).expect("a file").replace("brushed_normal.png", &format!("{long}.png"));
    fs::write(&asset, text).expect("a file");
    let run = roughcast(["bake".as_ref(), asset.as_os_str(), "-o".as_ref(), folder.path().join("out").as_os_str()]);
    assert_eq!((run.code, run.err.lines().count()), (1, 1), "{}", run.err);
    assert!(run.err.contains("expected a path of at most 4096 bytes, found 5004"), "{}", run.err);
    assert!(!folder.path().join("out").exists());
}

#[cfg(unix)]
#[test]
fn reports_names_that_are_not_utf_8() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempdir().expect("a folder");
    let not_utf8 = OsStr::from_bytes(b"odd \xff name");
    let assets = folder.path().join(not_utf8);
    copy(&fixtures().join("waves"), &assets);
    // A folder may have any name. The name of an asset is part of the URIs of its outputs.
    let out = folder.path().join("out").join(not_utf8);
    bake(&assets, &out, OPTIONS[0]);
    assert!(out.join("waves.glb").is_file());
    let mut name = OsString::from(not_utf8);
    name.push(".glb");
    fs::copy(assets.join("waves.glb"), assets.join(name)).expect("a file");
    let run = roughcast(["bake".as_ref(), assets.as_os_str(), "-o".as_ref(), out.as_os_str()]);
    assert_eq!((run.code, run.err.lines().count()), (1, 1), "{}", run.err);
    assert!(run.err.contains("expected a file name in UTF-8") && run.err.contains("rename"), "{}", run.err);
}

#[cfg(unix)]
#[test]
fn ends_at_links_in_circles() {
    use std::os::unix::fs::symlink;
    let folder = tempdir().expect("a folder");
    let folder = folder.path();
    let assets = folder.join("assets");
    copy(&fixtures().join("waves"), &assets);
    symlink("..", assets.join("up")).expect("a link");
    symlink("round", assets.join("round")).expect("a link");
    symlink("self.gltf", assets.join("self.gltf")).expect("a link");
    let run = roughcast_in(folder, ["bake", "assets", "-o", "out", "--model=isotropic"]);
    assert_eq!(run.code, 1, "{}", run.err);
    assert!(run.err.lines().all(|line| line.starts_with("error: ") && line.contains("expected")), "{}", run.err);
    assert!(run.err.contains("assets/up") && run.err.contains("assets/round"), "{}", run.err);
    assert!(folder.join("out/waves.glb").is_file(), "the other asset is not baked");
    symlink("circle", folder.join("circle")).expect("a link");
    let run = roughcast_in(folder, ["bake", "assets/waves.glb", "-o", "circle", "--model=isotropic"]);
    assert_eq!((run.code, run.err.lines().count()), (1, 1), "{}", run.err);
    assert!(run.err.contains("expected to write circle/"), "{}", run.err);
    assert_eq!(files(&fixtures().join("waves")).len(), 1);
}
