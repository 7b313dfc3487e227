//! Engines on what the tool bakes: the tests of `examples/three`, which drive Chromium.

use std::io::Write;
use std::path::Path;
use std::process::Command;

#[test]
fn engines_load_and_shade_what_is_baked() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/three");
    let chromium = std::env::var("CHROMIUM").unwrap_or_else(|_| "/usr/bin/chromium".into());
    let is_installed = example.join("node_modules/three").is_dir() && Path::new(&chromium).exists();
    if !is_installed {
        return skip();
    }
    let mut node = Command::new("node");
    // As `npm test` there, without npm between this process and the one that it waits for.
    node.current_dir(&example).args(["--test", "plugin/test/", "test/"]);
    let Ok(output) = node.env("ROUGHCAST", env!("CARGO_BIN_EXE_roughcast")).output() else { return skip() };
    let report = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{report}{}", String::from_utf8_lossy(&output.stderr));
    assert!(report.contains("# skipped 0"), "{report}");
}

/// Tells a person what was not tested; fails where everything must be.
fn skip() {
    let missing = "tests of engines need Node 20, `npm ci` in examples/three and Chromium";
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
    let _ = writeln!(std::io::stderr(), "skipped: {missing}");
}
