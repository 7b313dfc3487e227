//! Writes `fixtures/`: small generated assets for tests, the README and first tries.
//!
//! Run with `cargo run -p studies --bin generate_fixtures`. `tests/cli/fixtures.rs` asserts that the committed files
//! are equal to what this program writes.

mod fixtures;

use std::fs;
use std::io;
use std::path::Path;

fn main() -> io::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
    for (path, bytes) in fixtures::all() {
        let path = root.join(path);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::write(&path, bytes)?;
    }
    Ok(())
}
