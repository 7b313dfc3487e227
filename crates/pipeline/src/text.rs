//! Text from files, made safe for terminals and CI logs.

use std::borrow::Cow;
use std::fmt::{Debug, Write};

/// Returns `text` on one line, without characters that a terminal or a CI log acts on. Control characters, line and
/// paragraph separators, and marks that reorder text are escaped as `\u{..}`, as Rust writes them.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_active) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_active(c) {
            // Writing to a string cannot fail.
            let _ = write!(shown, "\\u{{{:x}}}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// Returns `text` with U+FFFD in the place of each character that XML 1.0 has no way to write: most control characters
/// (section 2.2). Markup characters stay as they are.
pub fn xml_text(text: &str) -> String {
    let is_char = |c: char| !matches!(c, '\0'..='\x08' | '\x0b' | '\x0c' | '\x0e'..='\x1f' | '\u{fffe}' | '\u{ffff}');
    text.chars().map(|c| if is_char(c) { c } else { '\u{fffd}' }).collect()
}

/// Returns `text` as content or attribute of an XML or HTML element: as [`xml_text`], with markup characters as
/// entities.
pub fn xml_escaped(text: &str) -> String {
    quick_xml::escape::escape(xml_text(text)).into_owned()
}

/// Returns a number of things in words, such as `1 input` or `2 inputs`.
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Returns the name of a variant, or `unspecified` if there is none.
pub fn name_of<T: Debug>(variant: Option<&T>) -> String {
    variant.map_or_else(|| "unspecified".to_owned(), |variant| format!("{variant:?}"))
}

/// Returns whether a terminal or a log acts on `c` instead of showing it: C0, DEL, C1, line and paragraph separators,
/// and the overrides and isolates of Unicode's bidirectional algorithm (UAX #9).
fn is_active(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests;
