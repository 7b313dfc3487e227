//! Tests that programs of `--on-change` end with the tool, and that its variables hold one path per line.

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::{TempDir, tempdir};

use crate::process::fixtures;
use crate::watch::session::Session;

/// Writes `assets` with a waves.glb for each of `names`, and `hook.sh` with `script`.
fn scene(names: &[&str], script: &str) -> TempDir {
    let folder = tempdir().expect("a folder");
    fs::create_dir(folder.path().join("assets")).expect("a folder");
    for name in names {
        fs::copy(fixtures().join("waves/waves.glb"), folder.path().join("assets").join(name)).expect("a file");
    }
    fs::write(folder.path().join("hook.sh"), script).expect("a file");
    folder
}

/// Waits until `is_so` returns true, and fails after a time that no machine needs.
fn wait_until(what: &str, is_so: &dyn Fn() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(100), "{what}");
        sleep(Duration::from_millis(5));
    }
}

/// Returns whether a process runs. A process that has ended but was not waited for does not run.
fn is_running(id: &str) -> bool {
    let state = fs::read_to_string(format!("/proc/{id}/stat"));
    state.is_ok_and(|state| state.rsplit(") ").next().is_some_and(|rest| !rest.starts_with('Z')))
}

#[test]
fn an_interrupt_ends_all_that_the_hook_started() {
    for script in [
        "exec > /dev/null 2>&1\nsleep 300 & echo $! > pids.new\necho $$ >> pids.new\nmv pids.new pids\nsleep 300\n",
        // Programs that ignore the signal are killed.
        "exec > /dev/null 2>&1\ntrap '' TERM INT\n(trap '' TERM INT; while :; do sleep 1; done) & echo $! > pids.new\nmv pids.new pids\nwait\n",
    ] {
        let folder = scene(&["waves.glb"], script);
        let session = Session::start(folder.path(), "--model=none --on-change sh${IFS}hook.sh");
        let pids = folder.path().join("pids");
        wait_until("the hook is not run", &|| pids.is_file());
        let pids = fs::read_to_string(pids).expect("a file");
        assert!(pids.lines().all(is_running), "{pids}");
        let run = session.stop();
        assert_eq!((run.code, run.err.as_str()), (0, ""));
        wait_until(&format!("one of {pids} is left"), &|| !pids.lines().any(is_running));
    }
}

#[test]
fn a_path_of_two_lines_is_left_out_with_a_warning() {
    let folder = scene(&["a\nb.glb", "c.glb"], "printf '%s\\n' \"$ROUGHCAST_OUTPUTS\" > list.new\nmv list.new list\n");
    let mut session = Session::start(folder.path(), "--model=none --on-change sh${IFS}hook.sh");
    session.until("idle");
    assert_eq!(fs::read_to_string(folder.path().join("list")).expect("a file"), "out/c.glb\n");
    let run = session.stop();
    assert_eq!(run.code, 0);
    let expected = "warning: out/a\\u{a}b.glb: expected a path of one line, found a line break in it; ROUGHCAST_OUTPUTS \
                    leaves it out, --json lists it\n";
    assert_eq!(run.err, expected);
}
