//! What a fuzzer found, tried again.

use std::fs;
use std::path::Path;

#[path = "fuzz/entries.rs"]
mod entries;

/// Runs `entry` on the files that once broke it and on those that a fuzzer starts from.
fn replay(name: &str, entry: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz");
    let mut count = 0;
    for files in [folder.join("found").join(name), folder.join("seeds").join(name)] {
        for file in fs::read_dir(files).into_iter().flatten() {
            entry(&fs::read(file.expect("a file").path()).expect("a file"));
            count += 1;
        }
    }
    assert!(count > 0, "no files for {name}");
}

#[test]
fn documents() {
    replay("document", entries::document);
}

#[test]
fn textures() {
    replay("texture", entries::texture);
}

#[test]
fn configurations() {
    replay("configuration", entries::configuration);
}

#[test]
fn images() {
    replay("image", entries::image);
}
