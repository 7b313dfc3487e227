//! A scanner of the strict RFC 8259 grammar, which returns where values are in a text and builds no tree.

use std::ops::Range;

use super::error::{JsonError, MAX_DEPTH};

/// One member of an object, or one element of an array. `start..value.start` is white space and, in an object, the key
/// and the colon. `value.end..end` is the white space before the comma or bracket.
pub(super) struct Span {
    pub key: Option<Range<usize>>,
    pub start: usize,
    pub value: Range<usize>,
    pub end: usize,
}

/// Checks a whole document. Returns the range of its root value.
pub(super) fn document(text: &str) -> Result<Range<usize>, JsonError> {
    let mut scanner = Scanner { text, at: 0 };
    scanner.blank();
    let start = scanner.at;
    scanner.value(0, None)?;
    let root = start..scanner.at;
    scanner.blank();
    match scanner.peek() {
        None => Ok(root),
        Some(_) => Err(scanner.expected("the end of the document")),
    }
}

/// Returns the entries of the object or array that `text` spells, or `None` if `text` spells a scalar.
pub(super) fn entries(text: &str) -> Result<Option<Vec<Span>>, JsonError> {
    if !text.starts_with(['{', '[']) {
        return Ok(None);
    }
    let mut spans = Vec::new();
    Scanner { text, at: 0 }.value(0, Some(&mut spans))?;
    Ok(Some(spans))
}

/// Returns whether the value that `text` spells may be inside `depth` objects and arrays.
pub(super) fn fits(text: &str, depth: usize) -> bool {
    depth <= MAX_DEPTH && Scanner { text, at: 0 }.value(depth, None).is_ok()
}

/// Returns whether `c` is one of JSON's four white space characters.
pub(super) fn is_blank(c: char) -> bool {
    matches!(c, ' ' | '\t' | '\n' | '\r')
}

struct Scanner<'a> {
    text: &'a str,
    at: usize,
}

impl Scanner<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn eat(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    fn blank(&mut self) {
        while let Some(b' ' | b'\t' | b'\n' | b'\r') = self.peek() {
            self.at += 1;
        }
    }

    /// Scans one value inside `depth` containers. If the value is a container, its entries are added to `spans`.
    fn value(&mut self, depth: usize, spans: Option<&mut Vec<Span>>) -> Result<(), JsonError> {
        match self.peek() {
            Some(b'{') => self.container(depth, true, spans),
            Some(b'[') => self.container(depth, false, spans),
            Some(b'"') => self.string(),
            Some(b'-' | b'0'..=b'9') => self.number(),
            Some(b't') => self.literal("true"),
            Some(b'f') => self.literal("false"),
            Some(b'n') => self.literal("null"),
            _ => Err(self.expected("a value")),
        }
    }

    fn container(&mut self, depth: usize, object: bool, mut spans: Option<&mut Vec<Span>>) -> Result<(), JsonError> {
        if depth >= MAX_DEPTH {
            let (line, column) = position(self.text, self.at);
            return Err(JsonError::TooDeep { line, column });
        }
        let close = if object { b'}' } else { b']' };
        self.at += 1;
        let mut start = self.at;
        self.blank();
        if self.eat(close) {
            return Ok(());
        }
        loop {
            let key = if object { Some(self.key()?) } else { None };
            let from = self.at;
            self.value(depth + 1, None)?;
            let value = from..self.at;
            self.blank();
            if let Some(spans) = spans.as_deref_mut() {
                let end = self.at;
                spans.push(Span { key, start, value, end });
            }
            if self.eat(close) {
                return Ok(());
            }
            if !self.eat(b',') {
                return Err(self.expected(if object { "',' or '}'" } else { "',' or ']'" }));
            }
            start = self.at;
            self.blank();
        }
    }

    /// Scans a member's name, its colon and the white space after it. Returns the range of the name.
    fn key(&mut self) -> Result<Range<usize>, JsonError> {
        let start = self.at;
        if self.peek() != Some(b'"') {
            return Err(self.expected("a member name in double quotes"));
        }
        self.string()?;
        let key = start..self.at;
        self.blank();
        if !self.eat(b':') {
            return Err(self.expected("':' after the member name"));
        }
        self.blank();
        Ok(key)
    }

    fn string(&mut self) -> Result<(), JsonError> {
        self.at += 1;
        loop {
            match self.peek() {
                Some(b'"') => {
                    self.at += 1;
                    return Ok(());
                }
                Some(b'\\') => self.escape()?,
                Some(0x20..) => self.at += 1,
                _ => return Err(self.expected("a string character or a closing '\"'")),
            }
        }
    }

    fn escape(&mut self) -> Result<(), JsonError> {
        let start = self.at;
        self.at += 1;
        match self.peek() {
            Some(b'"' | b'\\' | b'/' | b'b' | b'f' | b'n' | b'r' | b't') => self.at += 1,
            Some(b'u') => {
                let first = self.hex4()?;
                // RFC 8259 section 8.2 leaves an unpaired surrogate undefined. UTF-8 cannot represent one, so the text
                // is refused here rather than by each later reader.
                let paired = match first {
                    0xD800..=0xDBFF => {
                        self.eat(b'\\') && self.peek() == Some(b'u') && matches!(self.hex4()?, 0xDC00..=0xDFFF)
                    }
                    0xDC00..=0xDFFF => false,
                    _ => true,
                };
                if !paired {
                    let (line, column) = position(self.text, start);
                    return Err(JsonError::Surrogate { line, column });
                }
            }
            _ => return Err(self.expected("one of \"\\/bfnrtu after a backslash")),
        }
        Ok(())
    }

    /// Scans the four digits after the `u` at which the scanner is.
    fn hex4(&mut self) -> Result<u32, JsonError> {
        self.at += 1;
        let mut code = 0;
        for _ in 0..4 {
            let digit = self.peek().and_then(|b| char::from(b).to_digit(16));
            code = code * 16 + digit.ok_or_else(|| self.expected("a hexadecimal digit"))?;
            self.at += 1;
        }
        Ok(code)
    }

    fn number(&mut self) -> Result<(), JsonError> {
        self.eat(b'-');
        // After a leading zero the number ends. The caller refuses a digit that follows.
        if !self.eat(b'0') {
            self.digits()?;
        }
        if self.eat(b'.') {
            self.digits()?;
        }
        if self.eat(b'e') || self.eat(b'E') {
            let _ = self.eat(b'+') || self.eat(b'-');
            self.digits()?;
        }
        Ok(())
    }

    fn digits(&mut self) -> Result<(), JsonError> {
        let start = self.at;
        while let Some(b'0'..=b'9') = self.peek() {
            self.at += 1;
        }
        if self.at == start { Err(self.expected("a digit")) } else { Ok(()) }
    }

    fn literal(&mut self, word: &'static str) -> Result<(), JsonError> {
        let rest = self.text.as_bytes().get(self.at..).unwrap_or_default();
        if !rest.starts_with(word.as_bytes()) {
            return Err(self.expected(word));
        }
        self.at += word.len();
        Ok(())
    }

    fn expected(&self, expected: &'static str) -> JsonError {
        let (line, column) = position(self.text, self.at);
        let found = match self.text.get(self.at..).and_then(|rest| rest.chars().next()) {
            None => "the end of the text".to_owned(),
            Some(c) if c.is_control() => format!("U+{:04X}", u32::from(c)),
            Some(c) => format!("'{c}'"),
        };
        JsonError::Syntax { line, column, expected, found }
    }
}

/// Returns line and column, both from 1, of a byte offset. Columns count characters.
pub(super) fn position(text: &str, at: usize) -> (usize, usize) {
    let before = text.get(..at).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    (line, column)
}
