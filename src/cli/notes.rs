//! Which notes are printed by default: those that ask the user for something. `--verbose` prints all of them, and the
//! report always has them all.

use crate::report::{Choice, Reason};

/// Parts of the notes that ask for something. docs/stability.md explains each note.
const ACTIONABLE: [&str; 6] = [
    // Another source file is better.
    "the bump map is a JPEG",
    "the depth of the bump map is too small",
    "point along the surface or below it",
    // The document or the command line does not fit the purpose.
    "minFilter never reads mips",
    "every level counts as seen",
    "other texture coordinates or another KHR_texture_transform",
];

/// A part of the note on a missed bound.
const MISSED_BOUND: [&str; 1] = ["--max-error"];

/// Returns whether `note` is printed by default. `choice` is what was chosen for the layer of the note.
pub fn asks_for_action(note: &str, choice: Option<&Choice>) -> bool {
    let has = |parts: &[&str]| parts.iter().any(|part| note.contains(part));
    if has(&MISSED_BOUND) {
        // For the other reasons no setting comes closer: the best lobe misses the bound, too, or no engine shows it.
        let is_curable = |reason: Reason| matches!(reason, Reason::Encoding | Reason::Isotropic | Reason::Fit);
        return choice.is_none_or(|choice| choice.misses.iter().any(|miss| is_curable(miss.reason)));
    }
    has(&ACTIONABLE)
}

#[cfg(test)]
mod tests;
