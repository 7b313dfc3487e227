//! Runs the tests of `tools/interop`: what commands of other tools keep of baked assets.

use std::path::Path;
use std::process::Command;

#[path = "common/skip.rs"]
mod skip;

use skip::{missing_tool, skip};

const REMEDY: &str = "tests of other tools need Node 20 and `npm ci` in tools/interop";

#[test]
fn other_tools_keep_what_the_page_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/interop");
    if !folder.join("node_modules/gltfpack").is_dir() {
        return missing_tool(REMEDY);
    }
    let mut node = Command::new("node");
    // What `npm test` runs there. Without npm in between, this process waits for Node itself.
    node.current_dir(&folder).args(["--test", "test/"]);
    let Ok(output) = node.env("ROUGHCAST", env!("CARGO_BIN_EXE_roughcast")).output() else {
        return missing_tool(REMEDY);
    };
    let report = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{report}{}", String::from_utf8_lossy(&output.stderr));
    if !folder.join("venv/bin/python").is_file() {
        assert!(report.contains("# skipped 1"), "{report}");
        skip("the test of Blender needs `bash tools/interop/install-blender`");
    }
}
