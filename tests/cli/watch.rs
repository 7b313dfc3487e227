//! Tests that watching bakes what changed and removes what is gone, so that the outputs equal those of a bake.

mod edits;
pub mod session;

use std::fs;
use std::io::Write;
use std::path::Path;
#[cfg(target_os = "linux")]
use std::process::Command;

use tempfile::{TempDir, tempdir};

use super::process::{copy, files, fixtures, hashes, roughcast_in};
#[cfg(target_os = "linux")]
use super::skip::skip;
use session::{Session, assert_as_baked};

fn scene() -> TempDir {
    let folder = tempdir().expect("a folder");
    for asset in ["brushed", "knobs", "waves"] {
        copy(&fixtures().join(asset), &folder.path().join("assets").join(asset));
    }
    let config = "model = 'none'\n";
    fs::write(folder.path().join("assets/roughcast.toml"), config).expect("a file");
    folder
}

fn rename(folder: &Path, from: &str, to: &str) {
    fs::rename(folder.join(from), folder.join(to)).expect("a file");
}

#[test]
fn only_what_depends_on_a_change_is_baked() {
    for options in ["", "--poll=20"] {
        let scene = scene();
        let folder = scene.path();
        let mut session = Session::start(folder, options);
        let first = session.until("idle");
        assert_eq!(first.iter().filter(|event| event["event"] == "baked").count(), 3, "{first:?}");
        assert_as_baked(folder, "at first");
        let at = |name: &str| folder.join("assets").join(name);
        // A file that is empty for a moment has changed at once.
        let touch = |name: &str| {
            fs::copy(at(name), at("copy")).expect("a file");
            fs::rename(at("copy"), at(name)).expect("a file");
        };
        touch("waves/waves.glb");
        touch("roughcast.toml");
        touch("knobs/knobs.bin");
        assert_eq!(session.settle(folder), Vec::<String>::new(), "touched");
        fs::copy(at("brushed/brushed_normal.png"), at("knobs/knurled grip.png")).expect("a file");
        assert_eq!(session.settle(folder), ["baked assets/knobs/knobs.gltf"], "an image");
        fs::write(at("knobs/knobs.bin"), [&fs::read(at("knobs/knobs.bin")).expect("a file")[..], b"more"].concat())
            .expect("a file");
        assert_eq!(session.settle(folder), ["baked assets/knobs/knobs.gltf"], "a buffer");
        let config = "model = 'none'\n[[override]]\nfiles = 'waves/*'\nmodel = 'isotropic'\n";
        fs::write(at("roughcast.toml"), config).expect("a file");
        assert_eq!(session.settle(folder), ["baked assets/waves/waves.glb"], "a setting of one");
        rename(folder, "assets/brushed", "assets/renamed");
        let events = session.settle(folder);
        assert_eq!(events, ["removed assets/brushed/brushed.gltf", "baked assets/renamed/brushed.gltf"]);
        fs::remove_file(at("knobs/knobs.gltf")).expect("a file");
        assert_eq!(session.settle(folder), ["removed assets/knobs/knobs.gltf"]);
        assert!(!folder.join("out/knobs").exists() && !folder.join("out/brushed").exists());
        assert_as_baked(folder, "in the end");
        let run = session.stop();
        assert_eq!((run.code, run.err.as_str()), (0, ""));
    }
}

#[test]
fn unfinished_files_wait_and_broken_files_are_retried() {
    let scene = scene();
    let folder = scene.path();
    let mut session = Session::start(folder, "--settle 1500");
    session.until("idle");
    let image = folder.join("assets/knobs/knurled grip.png");
    let bytes = fs::read(fixtures().join("brushed/brushed_normal.png")).expect("a file");
    let (half, rest) = bytes.split_at(bytes.len() / 2);
    let mut file = fs::File::create(&image).expect("a file");
    file.write_all(half).expect("bytes");
    file.flush().expect("bytes");
    std::thread::sleep(std::time::Duration::from_millis(100));
    file.write_all(rest).expect("bytes");
    assert_eq!(session.settle(folder), ["baked assets/knobs/knobs.gltf"]);
    let good = hashes(&folder.join("out/knobs"));
    fs::write(&image, half).expect("a file");
    assert_eq!(session.settle(folder), ["failed assets/knobs/knobs.gltf"]);
    assert_eq!(hashes(&folder.join("out/knobs")), good, "good outputs go with one broken save");
    session.assert_as_baked(folder, "broken");
    fs::write(&image, &bytes).expect("a file");
    assert_eq!(session.settle(folder), ["baked assets/knobs/knobs.gltf"]);
    assert_as_baked(folder, "whole again");
    let err = session.stop().err;
    assert!(err.starts_with("error: assets/knobs/knobs.gltf: "), "{err}");
    assert!(err.ends_with("; out/knobs/knobs.gltf stays as it was last baked\n"), "{err}");
}

/// The document is broken, then its asset is removed. An asset that was never baked has no outputs to keep.
#[test]
fn the_last_good_outputs_stay_until_their_source_is_removed() {
    let scene = scene();
    let folder = scene.path();
    fs::write(folder.join("assets/never.gltf"), "{").expect("a file");
    let mut session = Session::start(folder, "");
    let events = session.until("idle");
    let failed = events.iter().find(|event| event["event"] == "failed").expect("an event");
    assert_eq!((failed["input"].as_str(), failed.get("kept")), (Some("assets/never.gltf"), None));
    let good = hashes(&folder.join("out"));
    let document = folder.join("assets/brushed/brushed.gltf");
    let text = fs::read(&document).expect("a file");
    for broken in [&b""[..], &text[..text.len() / 2], b"{]"] {
        fs::write(folder.join("beside"), broken).expect("a file");
        rename(folder, "beside", "assets/brushed/brushed.gltf");
        let events = session.until("idle");
        let failed = events.iter().find(|event| event["event"] == "failed").expect("an event");
        assert_eq!(failed["input"], "assets/brushed/brushed.gltf");
        assert_eq!(failed["kept"], "out/brushed/brushed.gltf");
        assert_eq!(events.last().expect("an event")["failed"], 2);
        assert_eq!(hashes(&folder.join("out")), good);
    }
    fs::remove_file(&document).expect("a file");
    assert_eq!(session.settle(folder), ["removed assets/brushed/brushed.gltf"]);
    assert!(!folder.join("out/brushed").exists());
    assert_as_baked(folder, "in the end");
    assert_eq!(session.stop().code, 0);
}

/// Another asset needs a path of the last good outputs, which are then incomplete and removed.
#[test]
fn an_asset_that_can_be_baked_replaces_last_good_outputs() {
    let scene = scene();
    let folder = scene.path();
    let at = |name: &str| folder.join("assets").join(name);
    // Both assets are in one folder and copy an image with the same name.
    let document = |image: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"images":[{{"uri":"{image}"}},{{"uri":"n.png"}}],
            "textures":[{{"source":1}}],"materials":[{{"normalTexture":{{"index":0}}}}]}}"#
        )
    };
    fs::copy(fixtures().join("maps/line_normal.png"), at("n.png")).expect("a file");
    fs::copy(fixtures().join("brushed/brushed_colour.png"), at("c.png")).expect("a file");
    fs::write(at("one.gltf"), document("c.png")).expect("a file");
    let mut session = Session::start(folder, "");
    session.until("idle");
    fs::write(at("one.gltf"), "{").expect("a file");
    assert_eq!(session.settle(folder), ["failed assets/one.gltf"]);
    assert!(folder.join("out/one.gltf").is_file());
    session.assert_as_baked(folder, "broken");
    // A folder of sources gets the name of the broken asset's folder of textures.
    fs::create_dir(at("one.roughcast")).expect("a folder");
    fs::copy(fixtures().join("brushed/brushed_colour.png"), at("one.roughcast/n.normal.ktx2")).expect("a file");
    fs::write(at("two.gltf"), document("one.roughcast/n.normal.ktx2")).expect("a file");
    let events = session.settle(folder);
    assert_eq!(events, ["baked assets/two.gltf", "removed assets/one.gltf"]);
    assert_as_baked(folder, "in the end");
    assert_eq!(session.stop().code, 0);
}

#[test]
fn outputs_of_earlier_bakes_are_not_baked() {
    let scene = scene();
    let folder = scene.path();
    crate::process::done(folder, "bake assets/waves -o assets/earlier -q");
    let mut session = Session::start(folder, "");
    let events = session.until("idle");
    assert_eq!(events.iter().filter(|event| event["event"] == "baked").count(), 3, "{events:?}");
    crate::process::done(folder, "bake assets/brushed -o assets/later -q --no-config");
    assert_eq!(session.settle(folder), Vec::<String>::new());
    assert_as_baked(folder, "in the end");
    let run = session.stop();
    assert_eq!((run.code, run.err.lines().count()), (0, 1), "{}", run.err);
    assert!(run.err.starts_with("note: left out 1 file(s) that Roughcast has baked, such as assets/earlier/waves.glb"));
}

/// The system queues fewer events than occur. It reports only that some of the last ones were lost.
#[cfg(target_os = "linux")]
#[test]
fn lost_events_change_no_output() {
    let scene = scene();
    let folder = scene.path();
    let limit = fs::read_to_string("/proc/sys/fs/inotify/max_queued_events").expect("Linux has it");
    let limit: usize = limit.trim().parse().expect("a number");
    if limit > 100_000 {
        return skip(&format!("the system keeps {limit} events, too many to lose some"));
    }
    let notes = ["a", "b"].map(|name| folder.join("assets").join(name));
    notes.iter().for_each(|note| fs::write(note, "new").expect("a file"));
    let mut session = Session::start(folder, "");
    session.until("idle");
    session.signal("-STOP");
    // The files alternate, because the system merges equal events.
    for note in notes.iter().cycle().take(limit) {
        fs::write(note, "old").expect("a file");
    }
    // Only the loss of events may show that there are changes, because the document refers to the same files.
    fs::copy(fixtures().join("brushed/brushed_normal.png"), folder.join("assets/knobs/knurled grip.png"))
        .expect("a file");
    fs::create_dir(folder.join("assets/lost")).expect("a folder");
    session.signal("-CONT");
    let events = session.until("idle");
    assert!(
        events.iter().any(|event| event["event"] == "baked" && event["input"] == "assets/knobs/knobs.gltf"),
        "{events:?}"
    );
    // The new folder, whose event was lost, is watched as well.
    copy(&fixtures().join("brushed"), &folder.join("made"));
    rename(folder, "made", "assets/lost/brushed");
    let events = session.until("baked");
    assert_eq!(events.last().expect("an event")["input"], "assets/lost/brushed/brushed.gltf");
    session.until("idle");
    assert_as_baked(folder, "after the loss");
    assert_eq!(session.stop().code, 0);
}

#[test]
fn folders_may_appear_late_and_disappear() {
    let folder = tempdir().expect("a folder");
    let folder = folder.path();
    let mut session = Session::start(folder, "--model none");
    session.until("idle");
    // The folder is made and filled, and then a folder below it.
    copy(&fixtures().join("waves"), &folder.join("assets/waves"));
    session.settle(folder);
    copy(&fixtures().join("brushed"), &folder.join("assets/new/deep/brushed"));
    assert_eq!(session.settle(folder), ["baked assets/new/deep/brushed/brushed.gltf"]);
    let before = hashes(&folder.join("out"));
    // Without the folder, no asset is known to be removed.
    rename(folder, "assets", "away");
    assert_eq!(session.until("failed").len(), 1);
    session.until("idle");
    assert_eq!(hashes(&folder.join("out")), before);
    rename(folder, "away", "assets");
    fs::remove_dir_all(folder.join("assets/new")).expect("a folder");
    assert_eq!(session.settle(folder), ["removed assets/new/deep/brushed/brushed.gltf"]);
    assert_eq!(session.stop().code, 0);
    assert!(files(&folder.join("out")).iter().all(|(name, _)| name.starts_with("waves/") || name == "mark.gltf"));
}

#[test]
fn files_that_watch_did_not_write_stay() {
    let scene = scene();
    let folder = scene.path();
    let foreign =
        ["out/own.txt", "out/knobs/own.txt", "out/knobs/knobs.roughcast/own.ktx2"].map(|name| folder.join(name));
    for path in &foreign {
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, "own").expect("a file");
    }
    let mut session = Session::start(folder, "");
    session.until("idle");
    let edited = folder.join("out/knobs/knobs.bin");
    fs::write(&edited, "by hand").expect("a file");
    fs::remove_dir_all(folder.join("assets/knobs")).expect("a folder");
    session.settle(folder);
    let kept: Vec<_> = files(&folder.join("out/knobs")).into_iter().map(|(name, _)| name).collect();
    assert_eq!(kept, ["knobs.bin", "knobs.roughcast/own.ktx2", "own.txt"]);
    assert!(foreign.iter().all(|path| fs::read(path).is_ok_and(|bytes| bytes == b"own")));
    assert_eq!(session.stop().code, 0);
}

#[cfg(unix)]
#[test]
fn a_command_runs_after_each_change_and_its_failure_is_a_warning() {
    let scene = scene();
    let folder = scene.path();
    let script = "echo noise; echo \"+$ROUGHCAST_OUTPUTS-$ROUGHCAST_REMOVED\" >> hook.txt; exit 3";
    fs::write(folder.join("hook.sh"), script).expect("a file");
    let mut session = Session::start(folder, "--on-change ./hook.sh");
    // The file is not executable, so that the shell itself fails.
    session.until("idle");
    assert!(session.stop().err.contains("warning: expected \"./hook.sh\" to end with exit code 0"));
    let _ = fs::remove_file(folder.join("hook.txt"));
    let mut permissions = fs::metadata(folder.join("hook.sh")).expect("facts").permissions();
    std::os::unix::fs::PermissionsExt::set_mode(&mut permissions, 0o755);
    fs::set_permissions(folder.join("hook.sh"), permissions).expect("permissions");
    let mut session = Session::start(folder, "--on-change ./hook.sh");
    session.until("idle");
    fs::remove_dir_all(folder.join("assets/waves")).expect("a folder");
    session.until("idle");
    let run = session.stop();
    let text = fs::read_to_string(folder.join("hook.txt")).expect("a file");
    let first = "+out/brushed/brushed.gltf\nout/knobs/knobs.gltf\nout/waves/waves.glb-\n+-out/waves/waves.";
    assert!(text.starts_with(first), "{text}");
    assert!(run.err.contains("found exit status: 3") && run.err.contains("noise"), "{}", run.err);
    assert_eq!(run.code, 0);
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_watching_cleanly_at_any_time() {
    for wait_for in ["started", "baked", "idle"] {
        let scene = scene();
        let folder = scene.path();
        let mut session = Session::start(folder, "");
        session.until(wait_for);
        let run = session.stop();
        assert_eq!((run.code, run.err.as_str()), (0, ""), "{wait_for}");
        assert!(files(folder).iter().all(|(name, _)| !name.contains(".roughcast-")), "leftovers: {wait_for}");
        let mut session = Session::start(folder, "");
        session.until("idle");
        assert_eq!(session.stop().code, 0);
        assert_as_baked(folder, wait_for);
    }
}

#[test]
fn a_cache_saves_the_first_bake() {
    let scene = scene();
    let folder = scene.path();
    let bake = || {
        let mut session = Session::start(folder, "--cache assets/.cache");
        let events = session.until("idle");
        assert_eq!(session.stop().code, 0);
        let baked = events.into_iter().filter(|event| event["event"] == "baked");
        baked.map(|event| event["status"].as_str().expect("a status").to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(bake(), ["baked"; 3]);
    assert_eq!(bake(), ["cached"; 3]);
}

#[cfg(target_os = "linux")]
#[test]
fn folders_beyond_the_watch_limit_are_polled() {
    // A user namespace has limits of its own.
    let limit = "echo 3 > /proc/sys/user/max_inotify_watches";
    let probe = Command::new("unshare").args(["-Ur", "sh", "-c", limit]).output();
    if !probe.is_ok_and(|output| output.status.success()) {
        return skip("a limit on watched folders needs user namespaces");
    }
    let scene = scene();
    let folder = scene.path();
    let mut command = Command::new("unshare");
    command.args(["-Ur", "sh", "-c", &format!("{limit}; exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_roughcast")]);
    let mut session = Session::start_by(command, folder, "");
    let events = session.until("idle");
    assert_eq!(events[0]["poll"], 1000, "{events:?}");
    fs::remove_file(folder.join("assets/waves/waves.glb")).expect("a file");
    assert_eq!(session.settle(folder), ["removed assets/waves/waves.glb"]);
    let run = session.stop();
    assert_eq!((run.code, run.err.lines().count()), (0, 1), "{}", run.err);
    assert!(run.err.starts_with("warning: expected to watch every folder, found the system's limit reached"));
}

#[test]
fn contradictory_options_are_refused() {
    let scene = scene();
    let folder = scene.path();
    for (line, code, expected) in [
        ("watch assets/waves/waves.glb -o out", 2, "expected a folder, found a file"),
        ("watch assets", 2, "expected an output folder, found none"),
        ("watch assets -o out --poll=1", 2, "1 is not in 10"),
        ("watch assets -o out --lobe phong", 2, "invalid value 'phong'"),
    ] {
        let run = roughcast_in(folder, line.split(' '));
        assert!(run.code == code && run.err.contains(expected), "{line}: {}: {}", run.code, run.err);
    }
}

#[test]
fn a_wrong_configuration_is_reported_and_outputs_stay() {
    let scene = scene();
    let folder = scene.path();
    let config = folder.join("assets/roughcast.toml");
    fs::write(&config, "modle = 'none'\n").expect("a file");
    let mut session = Session::start(folder, "");
    assert!(session.until("failed").last().expect("an event")["error"].as_str().is_some_and(|e| e.contains("modle")));
    fs::write(&config, "model = 'none'\n").expect("a file");
    session.settle(folder);
    assert_as_baked(folder, "put right");
    let before = hashes(&folder.join("out"));
    fs::write(&config, "modle = 'none'\n").expect("a file");
    fs::remove_dir_all(folder.join("assets/waves")).expect("a folder");
    session.until("failed");
    session.until("idle");
    assert_eq!(hashes(&folder.join("out")), before);
    fs::remove_file(&config).expect("a file");
    fs::write(&config, "model = 'none'\n").expect("a file");
    assert_eq!(session.settle(folder), ["removed assets/waves/waves.glb"]);
    assert_eq!(session.stop().code, 0);
}
