//! Compares the outputs of many bakes with golden files, and says what changed in each texture and document.
//!
//! `tests/goldens.txt` lists the digest and the path of every output. `tests/goldens` holds those of up to
//! [`store::MAX_BYTES`], named by their digests. `ROUGHCAST_BLESS=1` writes both anew.

mod difference;
mod matrix;
mod store;

use std::collections::{BTreeMap, BTreeSet};

use store::digest;

/// Most changed files that a failure describes.
const MAX_DESCRIBED: usize = 40;

#[test]
fn outputs_equal_their_golden_files() {
    let outputs = matrix::outputs();
    if std::env::var("ROUGHCAST_BLESS").as_deref() == Ok("1") {
        let has_bc = cfg!(feature = "bc");
        assert!(has_bc, "golden files of the target bc need the feature `bc`");
        store::bless(&outputs);
    }
    let mut expected = store::read();
    expected.retain(|path, _| cfg!(feature = "bc") || !matrix::is_bc(path));
    let found: BTreeMap<&str, String> = outputs.iter().map(|(path, bytes)| (path.as_str(), digest(bytes))).collect();

    let paths: BTreeSet<&str> = expected.keys().map(String::as_str).chain(found.keys().copied()).collect();
    // Equal textures of several cases are described once.
    let mut changes: BTreeMap<(Option<&str>, Option<&str>), Vec<&str>> = BTreeMap::new();
    for path in paths {
        let (old, new) = (expected.get(path).map(String::as_str), found.get(path).map(String::as_str));
        if old != new && !is_alike(path, old, outputs.get(path)) {
            changes.entry((old, new)).or_default().push(path);
        }
    }
    let count: usize = changes.values().map(Vec::len).sum();
    let mut text = String::new();
    for ((old, _), paths) in changes.iter().take(MAX_DESCRIBED) {
        let others = if paths.len() > 1 { format!(" and {} more", paths.len() - 1) } else { String::new() };
        text += &format!("\n{}{others}\n", paths[0]);
        text += &match (old, outputs.get(paths[0])) {
            (None, _) => "  new\n".to_owned(),
            (_, None) => "  no longer written\n".to_owned(),
            (Some(old), Some(new)) => match store::stored(paths[0], old) {
                Some(old) => difference::describe(paths[0], &old, new),
                None => format!("  {} bytes; its golden file is too large to be stored\n", new.len()),
            },
        };
    }
    assert!(
        changes.is_empty(),
        "{count} outputs differ from their golden files, {} of them in different ways (at most {MAX_DESCRIBED} are \
         described):\n{text}\nIf this is intended, run `ROUGHCAST_BLESS=1 cargo test --test cli golden` and add it to \
         CHANGELOG.md.",
        changes.len()
    );
}

/// Returns whether a BC texture differs from its golden file by rounding only. The BC encoder takes the instructions
/// of the processor, which round differently. Every other output must be equal.
fn is_alike(path: &str, old: Option<&str>, new: Option<&Vec<u8>>) -> bool {
    let (Some(old), Some(new)) = (old.and_then(|old| store::stored(path, old)), new) else { return false };
    matrix::is_bc(path) && difference::is_within(path, &old, new, BC_MEAN, BC_WORST)
}

/// Largest mean difference of a level of a BC texture between processors: half a step of 8 bits.
const BC_MEAN: f64 = 0.5 / 255.0;
/// Largest difference of one of its texels.
const BC_WORST: f64 = 8.0 / 255.0;
