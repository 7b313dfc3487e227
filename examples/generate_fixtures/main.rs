//! Writes `fixtures/`: small assets of our own, for tests, the README and first tries.
//!
//! `cargo run --example generate_fixtures`; `tests/fixtures.rs` asserts that what is committed is what this writes.

mod fixtures;

use std::fs;
use std::io;
use std::path::Path;

fn main() -> io::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    for (path, bytes) in fixtures::all() {
        let path = root.join(path);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::write(&path, bytes)?;
    }
    Ok(())
}
