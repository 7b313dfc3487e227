//! Outputs that cannot or must not be written.

use std::fs;
use std::process::Command;

use super::super::process::bake;
use super::super::skip::skip;
use super::*;

/// Bakes the scene to `output`, expects a failure, and returns the only line of the error.
fn refused(scene: &Scene, inputs: &[&Path], output: &Path) -> String {
    let before = hashes(&scene.input());
    let mut arguments = vec!["bake".as_ref()];
    arguments.extend(inputs.iter().map(|i| i.as_os_str()));
    arguments.extend(["-o".as_ref(), output.as_os_str()]);
    let run = roughcast(arguments);
    assert_eq!(hashes(&scene.input()), before, "a source changed");
    assert_no_leftovers(scene.folder.path());
    one_line(&run)
}

#[test]
fn rejects_the_folder_of_an_input_as_output() {
    let scene = Scene::new();
    let bad = scene.input().join("bad");
    for output in [bad.clone(), bad.join("."), bad.join("../bad")] {
        for input in [&bad, &bad.join("brushed.gltf")] {
            assert_contains(&refused(&scene, &[input], &output), &["expected an output folder apart from the inputs"]);
        }
    }
}

/// Baking `in` to `in/out` works twice, because the output folder is not searched for inputs.
#[test]
fn accepts_an_output_folder_within_the_input() {
    let scene = Scene::new();
    let output = scene.input().join("out");
    bake(&scene.input(), &output, &[]);
    let first = hashes(&scene.input());
    bake(&scene.input(), &output, &[]);
    assert_eq!(hashes(&scene.input()), first);
}

/// The outputs of `in/bad` would replace its sources.
#[test]
fn rejects_an_output_folder_that_holds_an_input() {
    let scene = Scene::new();
    let nested = scene.input().join("bad/bad");
    copy(&scene.input().join("bad"), &nested);
    let before = hashes(&scene.input());
    let input = scene.input().join("bad");
    let run = roughcast(["bake".as_ref(), input.as_os_str(), "-o".as_ref(), scene.input().as_os_str()]);
    for (name, hash) in before {
        assert_eq!(hashes(&scene.input()).get(&name), Some(&hash), "{name} is a source and changed: {}", run.err);
    }
    assert_ne!(run.code, 0);
}

#[test]
fn rejects_a_file_as_output_folder() {
    let scene = Scene::new();
    fs::write(scene.output(), "here first").expect("a file");
    for output in [scene.output(), scene.output().join("below")] {
        let line = refused(&scene, &[&scene.bad("brushed.gltf")], &output);
        assert_contains(&line, &["bad/brushed.gltf: ", "expected to write ", "out", "choose another output folder"]);
    }
    assert_eq!(fs::read(scene.output()).expect("a file"), b"here first");
}

#[test]
fn rejects_two_inputs_for_one_output() {
    let scene = Scene::new();
    let other = scene.folder.path().join("in/other/waves.glb");
    copy(&scene.input().join("good"), &scene.folder.path().join("in/other"));
    let good = scene.input().join("good/waves.glb");
    let line = refused(&scene, &[&good, &other], &scene.output());
    assert_contains(&line, &["other/waves.glb", "good/waves.glb", "different folders"]);
    assert!(scene.output().join("waves.glb").is_file(), "the first is not baked");
}

#[test]
fn rejects_a_baked_asset_as_input() {
    let scene = Scene::new();
    let again = scene.folder.path().join("again");
    for form in ["fallback", "strict", "dual"] {
        bake(&scene.input(), &scene.output(), &["--gltf", form]);
        let line = refused(&scene, &[&scene.output().join("bad/brushed.gltf")], &again);
        assert_contains(&line, &["brushed.gltf: ", "Brushed steel", "Roughcast has baked", "original"]);
        assert!(!again.exists());
    }
}

#[test]
fn rejects_a_map_over_its_source() {
    let scene = Scene::new();
    let map = scene.bad("brushed_normal.png");
    let before = hashes(&scene.input());
    let run = roughcast(["map".as_ref(), map.as_os_str(), "-o".as_ref(), map.as_os_str()]);
    assert_contains(&one_line(&run), &["brushed_normal.png", "it is a source of this run"]);
    assert_eq!(hashes(&scene.input()), before);
}

/// Writes beyond the limit fail in the middle of a file, as on a full disk.
#[cfg(unix)]
#[test]
fn removes_a_file_that_exceeds_the_size_limit() {
    let scene = Scene::new();
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$0\" bake \"$1\" -o \"$2\"";
    let command = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_roughcast")])
        .args([scene.bad("brushed.gltf"), scene.output()])
        .output();
    let run = Run::from(command.expect("a shell"));
    assert_contains(&one_line(&run), &["bad/brushed.gltf: ", "expected to write ", "too large", "free space"]);
    assert_no_leftovers(scene.folder.path());
    assert!(!scene.output().exists(), "half an asset was left behind");
}

/// Bakes to a disk of 20 kB and to a read-only one, if this process may mount them.
#[cfg(target_os = "linux")]
#[test]
fn reports_a_full_and_a_read_only_disk() {
    for (options, part) in [("size=20k", "No space left"), ("ro", "Read-only")] {
        let scene = Scene::new();
        fs::create_dir(scene.output()).expect("a folder");
        let script = "mount -t tmpfs -o \"$3\" none \"$2\" || exit 77; \"$0\" bake \"$1\" -o \"$2\"; code=$?; \
            ls -A \"$2\"; exit $code";
        let command = Command::new("unshare")
            .args(["--mount", "--map-root-user", "sh", "-c", script, env!("CARGO_BIN_EXE_roughcast")])
            .args([scene.bad("brushed.gltf"), scene.output()])
            .arg(options)
            .output();
        let run = match command.map(Run::from) {
            Ok(run) if run.code != 77 && !run.err.starts_with("unshare") => run,
            _ => {
                return skip(&format!("a disk with {options} needs the right to mount one"));
            }
        };
        assert_eq!(run.code, 4, "a disk may have room again: {}", run.err);
        assert_contains(&run.err, &["error: ", "bad/brushed.gltf: ", "expected to write ", part]);
        assert_eq!(run.err.lines().count(), 1, "{}", run.err);
        assert!(!run.out.contains(".roughcast-") && !run.out.contains("brushed.gltf"), "{}", run.out);
    }
}
