//! Records tests that cannot run here. `tests/zz_skipped.rs`, the last test that Cargo runs, counts and names them.
#![allow(dead_code, reason = "each test crate uses a part")]

use std::collections::BTreeSet;
use std::env;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Mutex;
use std::thread;

/// Skips the calling test because a tool is not installed. Fails in CI (`CI=true`), where every tool must be installed.
///
/// `remedy` says what needs the tool and how to install it.
pub fn missing_tool(remedy: &str) {
    assert!(env::var("CI").as_deref() != Ok("true"), "{remedy}");
    skip(remedy);
}

/// Records that the calling test is skipped and prints why. The caller returns afterwards.
pub fn skip(reason: &str) {
    static RECORDED: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let thread = thread::current();
    let line = format!("{}::{}: {reason}\n", test_crate(), thread.name().unwrap_or("unnamed"));
    if !RECORDED.lock().is_ok_and(|mut recorded| recorded.insert(line.clone())) {
        return;
    }
    // `eprint!` would be captured by the test runner because the test passes.
    let _ = write!(io::stderr(), "skipped: {line}");
    let record = || -> io::Result<()> {
        fs::create_dir_all(folder())?;
        File::options().create(true).append(true).open(file())?.write_all(line.as_bytes())
    };
    record().expect("the folder of build outputs is writable");
}

/// Returns the tests that were skipped since `cargo test` began, as `crate::test: reason`, and forgets them.
pub fn take_skipped() -> Vec<String> {
    let text = fs::read_to_string(file()).unwrap_or_default();
    let _ = fs::remove_dir_all(folder());
    text.lines().map(str::to_owned).collect::<BTreeSet<_>>().into_iter().collect()
}

/// Returns the name of the running test crate: the name of its program without the hash that Cargo appends.
fn test_crate() -> String {
    let program = env::current_exe().expect("a path of this program");
    let name = program.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    name.rsplit_once('-').map(|(name, _)| name.to_owned()).unwrap_or(name)
}

/// Returns the folder of records, beside the folder that holds the test programs.
fn folder() -> PathBuf {
    let program = env::current_exe().expect("a path of this program");
    program.parent().expect("a folder").with_file_name("skipped-tests")
}

/// Returns the file of this run. All test programs of a run have the same parent process, `cargo test`, so that an
/// interrupted run leaves no records to a later one.
fn file() -> PathBuf {
    #[cfg(unix)]
    let run = std::os::unix::process::parent_id();
    #[cfg(not(unix))]
    let run = 0;
    folder().join(format!("{run}.txt"))
}
