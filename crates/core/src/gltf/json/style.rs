//! The layout of a document, so that additions look like the rest.

use super::JsonError;
use super::scan::{entries, is_blank};

/// Layout of new text, taken from the root's first member and from the first array of scalars.
#[derive(Debug, Clone)]
pub(super) struct Style {
    /// Line break, or `None` for a document on one line.
    newline: Option<&'static str>,
    /// One level of indentation.
    unit: String,
    /// The colon of a member with the white space around it.
    colon: String,
    /// The white space after a comma inside a line.
    gap: &'static str,
    /// Whether arrays of scalars have one line for each element.
    wrap_scalars: bool,
}

impl Style {
    /// Returns the style of the document whose root value is `root`.
    pub fn of(root: &str) -> Result<Style, JsonError> {
        let spans = entries(root)?.unwrap_or_default();
        let first = spans.first();
        let head = first.and_then(|span| root.get(span.start..span.value.start)).unwrap_or_default();
        let lead = leading_blank(head);
        let colon = if first.is_some_and(|span| span.key.is_some()) { colon(head) } else { ":" };
        let newline = match lead {
            _ if lead.contains("\r\n") => Some("\r\n"),
            _ if lead.contains('\n') => Some("\n"),
            _ => None,
        };
        let spaced = newline.is_some() || colon.ends_with(' ');
        Ok(Style {
            newline,
            unit: line_indent(lead).unwrap_or_default().to_owned(),
            colon: colon.to_owned(),
            gap: if spaced { " " } else { "" },
            wrap_scalars: wraps_scalars(root),
        })
    }

    /// Returns whether the entries of a container have their own lines.
    pub fn wraps(&self, object: bool, scalars: bool) -> bool {
        self.newline.is_some() && (object || !scalars || self.wrap_scalars)
    }

    /// Returns the line break before such an entry, in a container on a line indented by `indent`.
    pub fn entry_break(&self, indent: &str) -> String {
        self.newline.map_or_else(String::new, |nl| format!("{nl}{indent}{}", self.unit))
    }

    /// Returns the line break before the closing bracket of such a container.
    pub fn closing_break(&self, indent: &str) -> String {
        self.newline.map_or_else(String::new, |nl| format!("{nl}{indent}"))
    }

    pub fn colon(&self) -> &str {
        &self.colon
    }

    pub fn gap(&self) -> &str {
        self.gap
    }

    /// Lays out the compact JSON text `value` for a line that is indented by `indent`.
    pub fn lay_out(&self, value: &str, indent: &str) -> Result<String, JsonError> {
        let mut out = String::new();
        self.write(value, indent, &mut out)?;
        Ok(out)
    }

    fn write(&self, value: &str, indent: &str, out: &mut String) -> Result<(), JsonError> {
        let spans = entries(value)?.unwrap_or_default();
        if spans.is_empty() {
            out.push_str(value);
            return Ok(());
        }
        let object = value.starts_with('{');
        let slice = |range| value.get(range).unwrap_or_default();
        let scalars = spans.iter().all(|span| is_scalar(slice(span.value.clone())));
        let wrap = self.wraps(object, scalars);
        let inner = format!("{indent}{}", self.unit);
        out.push(if object { '{' } else { '[' });
        for (i, span) in spans.iter().enumerate() {
            if i > 0 {
                out.push(',');
            }
            if wrap {
                out.push_str(&self.entry_break(indent));
            } else if i > 0 {
                out.push_str(self.gap);
            }
            if let Some(key) = span.key.clone() {
                out.push_str(slice(key));
                out.push_str(&self.colon);
            }
            self.write(slice(span.value.clone()), &inner, out)?;
        }
        if wrap {
            out.push_str(&self.closing_break(indent));
        }
        out.push(if object { '}' } else { ']' });
        Ok(())
    }
}

/// Returns whether `value` spells neither an object nor an array.
pub(super) fn is_scalar(value: &str) -> bool {
    !value.starts_with(['{', '['])
}

/// Returns the white space at the start of `text`.
pub(super) fn leading_blank(text: &str) -> &str {
    text.split_once(|c| !is_blank(c)).map_or(text, |(blank, _)| blank)
}

/// Returns the indentation of the line that ends in `blank`, or `None` if no line begins there.
pub(super) fn line_indent(blank: &str) -> Option<&str> {
    blank.rsplit_once('\n').map(|(_, indent)| indent)
}

/// Returns the colon of a member's head with its white space: everything after the quoted key.
pub(super) fn colon(head: &str) -> &str {
    head.rsplit_once('"').map_or(":", |(_, colon)| colon)
}

/// Returns whether the first array that begins with a scalar has this scalar on its own line.
fn wraps_scalars(text: &str) -> bool {
    let mut rest = text;
    while let Some(at) = rest.find(['"', '[']) {
        let (_, found) = rest.split_at(at);
        let mut chars = found.chars();
        if chars.next() == Some('[') {
            rest = chars.as_str();
            let lead = leading_blank(rest);
            if !rest.trim_start_matches(is_blank).starts_with(['{', '[', ']']) {
                return lead.contains('\n');
            }
        } else {
            let mut escaped = false;
            let end = chars.find(|&c| {
                let closing = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                closing
            });
            if end.is_none() {
                return true;
            }
            rest = chars.as_str();
        }
    }
    true
}
