use serde_json::json;

use super::*;
use crate::material::notes::JPEG;

fn choice(reason: Reason) -> Choice {
    let choice = json!({
        "finest": 0,
        "candidates": [],
        "chosen": 0,
        "misses": [{ "level": 2, "error": 0.2, "oracle": 0.1, "reason": reason }],
    });
    serde_json::from_value(choice).expect("a choice")
}

#[test]
fn notes_on_the_source_file_are_printed_by_default() {
    assert!(asks_for_action(JPEG, None));
}

#[test]
fn notes_that_only_explain_are_not_printed_by_default() {
    let note = "the map of 61 x 47 texels was resampled to 64 x 48: block formats want multiples of 4";
    assert!(!asks_for_action(note, None));
}

#[test]
fn missed_bounds_are_printed_by_default_where_a_setting_comes_closer() {
    let note = "level 2 misses --max-error 0.1";
    for reason in [Reason::Encoding, Reason::Isotropic, Reason::Fit] {
        assert!(asks_for_action(note, Some(&choice(reason))), "{reason:?}");
    }
    for reason in [Reason::AlphaAboveOne, Reason::TwoPeaked, Reason::Steep, Reason::NoSingleLobe] {
        assert!(!asks_for_action(note, Some(&choice(reason))), "{reason:?}");
    }
}
