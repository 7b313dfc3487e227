//! Text from files, as a terminal or a CI log may show it.

use std::borrow::Cow;
use std::fmt::Write;

/// Returns `text` on one line and without characters that a terminal or a CI log acts on: control characters, line and
/// paragraph separators and marks that reorder text are written as `\u{..}`, as Rust writes them.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_active) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_active(c) {
            // A string takes whatever is written to it.
            let _ = write!(shown, "\\u{{{:x}}}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// Tells whether a terminal or a log does something else with `c` than to show it: C0, DEL and C1, separators of lines, and
/// the overrides and isolates of Unicode's bidirectional algorithm (UAX #9).
fn is_active(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_only_shows_stays_as_it_is() {
        let text = "brick (2) \u{e9}\u{65e5}\u{672c} \\u{1b} ::error::";
        assert!(matches!(printable(text), Cow::Borrowed(same) if same == text));
    }

    #[test]
    fn what_acts_is_escaped() {
        assert_eq!(printable("\u{1b}]0;x\u{7}"), "\\u{1b}]0;x\\u{7}");
        assert_eq!(printable("a\n::error::\r\t\u{7f}"), "a\\u{a}::error::\\u{d}\\u{9}\\u{7f}");
        assert_eq!(printable("\u{9b}\u{2028}\u{202e}\u{2069}"), "\\u{9b}\\u{2028}\\u{202e}\\u{2069}");
    }
}
