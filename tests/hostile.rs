//! Runs the entry points of the fuzzer on inputs that once broke them, and on every truncation of their seeds.

use std::fs;
use std::path::Path;

#[path = "fuzz/entries.rs"]
mod entries;

/// Runs `entry` on the files in `found`, which once broke it, and on every truncation of `start`.
fn replay(name: &str, entry: fn(&[u8]), start: &[u8]) {
    let found = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/found").join(name);
    for file in fs::read_dir(found).into_iter().flatten() {
        entry(&fs::read(file.expect("a file").path()).expect("a file"));
    }
    for length in (0..start.len()).step_by(start.len().div_ceil(100)) {
        entry(&start[..length]);
    }
    entry(start);
}

#[test]
fn documents() {
    replay("document", entries::document, include_bytes!("../fixtures/brushed/brushed.gltf"));
    replay("document", entries::document, include_bytes!("../fixtures/waves/waves.glb"));
}

#[test]
fn textures() {
    replay("texture", entries::texture, b"\xABKTX 20\xBB\r\n\x1A\n\0\0\0\0\x01\0\0\0");
}

#[test]
fn configurations() {
    replay("configuration", entries::configuration, include_bytes!("../crates/pipeline/src/project/template.toml"));
}

#[test]
fn images() {
    let mut named = vec![6];
    named.extend(include_bytes!("../fixtures/maps/dunes_height.exr"));
    replay("image", entries::image, &named);
}
