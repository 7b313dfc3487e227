//! Counts and names the tests that were skipped.
//!
//! Cargo runs the test programs of a package in the order of their names, so that this one comes last.

use std::io::{self, Write};

#[path = "common/skip.rs"]
mod skip;

#[test]
fn skipped_tests_are_listed() {
    let skipped = skip::take_skipped();
    let mut text = format!("\n{} skipped test(s){}\n", skipped.len(), if skipped.is_empty() { "" } else { ":" });
    for test in &skipped {
        text += &format!("  {test}\n");
    }
    // `eprint!` would be captured by the test runner because the test passes.
    let _ = io::stderr().write_all(text.as_bytes());
}
