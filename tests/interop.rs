//! Runs the tests of `tools/interop`: what commands of other tools keep of baked assets.

use std::path::Path;
use std::process::Command;

#[path = "common/skip.rs"]
mod skip;

use skip::{missing_tool, skip};

const REMEDY: &str = "tests of other tools need Node 20 and `npm ci` in tools/interop";

/// Files that some of the tests need besides, and how to get them. CI has no native gltfpack.
const OPTIONAL: [(&str, &str); 2] = [
    ("tools/interop/venv/bin/python", "the test of Blender needs `bash tools/interop/install-blender`"),
    ("target/sizes/bin/gltfpack", "the test of the native gltfpack needs `bash benches/sizes/install`"),
];

#[test]
fn other_tools_keep_what_the_page_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = root.join("tools/interop");
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
    let missing: Vec<_> = OPTIONAL.iter().filter(|(file, _)| !root.join(file).is_file()).collect();
    assert!(report.contains(&format!("# skipped {}\n", missing.len())), "{report}");
    for (_, remedy) in missing {
        skip(remedy);
    }
}
