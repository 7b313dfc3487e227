//! Runs the tests of `plugins/three`, in which engines in Chromium load and shade baked assets.

use std::path::Path;
use std::process::Command;

#[path = "common/skip.rs"]
mod skip;

use skip::missing_tool;

const REMEDY: &str = "tests of engines need Node 20, `npm ci` in plugins/three and Chromium";

#[test]
fn engines_load_and_shade_what_is_baked() {
    let plugin = Path::new(env!("CARGO_MANIFEST_DIR")).join("plugins/three");
    let chromium = std::env::var("CHROMIUM").unwrap_or_else(|_| "/usr/bin/chromium".into());
    let is_installed = plugin.join("node_modules/three").is_dir() && Path::new(&chromium).exists();
    if !is_installed {
        return missing_tool(REMEDY);
    }
    let mut node = Command::new("node");
    // What `npm test` runs there. Without npm in between, this process waits for Node itself.
    node.current_dir(&plugin).args(["--test", "plugin/test/", "test/"]);
    let Ok(output) = node.env("ROUGHCAST", env!("CARGO_BIN_EXE_roughcast")).output() else {
        return missing_tool(REMEDY);
    };
    let report = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{report}{}", String::from_utf8_lossy(&output.stderr));
    assert!(report.contains("# skipped 0"), "{report}");
}
