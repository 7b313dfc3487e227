//! A value of a document: its text, split into entries only if an edit reaches inside.

use super::JsonError;
use super::scan::entries;
use super::style::{Style, colon, is_scalar, leading_blank, line_indent};

/// A value as it is spelled.
#[derive(Debug, Clone)]
pub(super) enum Node {
    Text(String),
    Open(Container),
}

/// An object or array as entries. Its text is the entries with commas between them.
#[derive(Debug, Clone)]
pub(super) struct Container {
    pub object: bool,
    pub entries: Vec<Entry>,
    /// White space between the brackets if there are no entries.
    blank: String,
}

/// One member or element.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    /// The decoded name of a member.
    key: Option<String>,
    /// Text before the value: white space and, for a member, its key and colon.
    head: String,
    pub value: Node,
    /// White space between the value and the comma or bracket.
    tail: String,
}

impl Entry {
    /// Returns the indentation of the value's line, inside a line that is indented by `outer`.
    pub fn indent<'a>(&'a self, outer: &'a str) -> &'a str {
        line_indent(leading_blank(&self.head)).unwrap_or(outer)
    }
}

impl Node {
    /// Appends the value's text to `out`.
    pub fn write(&self, out: &mut String) {
        let container = match self {
            Node::Text(text) => return out.push_str(text),
            Node::Open(container) => container,
        };
        out.push(if container.object { '{' } else { '[' });
        if container.entries.is_empty() {
            out.push_str(&container.blank);
        }
        for (i, entry) in container.entries.iter().enumerate() {
            if i > 0 {
                out.push(',');
            }
            out.push_str(&entry.head);
            entry.value.write(out);
            out.push_str(&entry.tail);
        }
        out.push(if container.object { '}' } else { ']' });
    }

    /// Opens the value if it is a container. Returns `None` for a scalar.
    pub fn open(&mut self) -> Result<Option<&mut Container>, JsonError> {
        if let Node::Text(text) = self
            && let Some(container) = Container::read(text)?
        {
            *self = Node::Open(container);
        }
        Ok(match self {
            Node::Text(_) => None,
            Node::Open(container) => Some(container),
        })
    }
}

impl Container {
    fn read(text: &str) -> Result<Option<Container>, JsonError> {
        let Some(spans) = entries(text)? else {
            return Ok(None);
        };
        let slice = |range| text.get(range).unwrap_or_default();
        let mut list = Vec::with_capacity(spans.len());
        for span in spans {
            list.push(Entry {
                key: span.key.map(|key| decode(slice(key))).transpose()?,
                head: slice(span.start..span.value.start).to_owned(),
                value: Node::Text(slice(span.value.clone()).to_owned()),
                tail: slice(span.value.end..span.end).to_owned(),
            });
        }
        let blank = if list.is_empty() { slice(1..text.len() - 1) } else { "" };
        Ok(Some(Container { object: text.starts_with('{'), entries: list, blank: blank.to_owned() }))
    }

    /// Returns the index of the entry that a step of a pointer names.
    pub fn position(&self, step: &str) -> Option<usize> {
        if self.object {
            self.entries.iter().rposition(|entry| entry.key.as_deref() == Some(step))
        } else {
            array_index(step).filter(|&i| i < self.entries.len())
        }
    }

    /// Appends an entry, laid out like the other entries, and returns its index. `indent` is the indentation of the
    /// container's line. The existing text is not changed.
    pub fn append(&mut self, key: Option<&str>, value: &str, indent: &str, style: &Style) -> Result<usize, JsonError> {
        let (lead, colon, tail) = match self.entries.as_mut_slice() {
            [] if style.wraps(self.object, is_scalar(value)) => {
                (style.entry_break(indent), style.colon().to_owned(), style.closing_break(indent))
            }
            [] => (String::new(), style.colon().to_owned(), String::new()),
            [.., last] => {
                let lead = leading_blank(&last.head).to_owned();
                (lead, colon(&last.head).to_owned(), std::mem::take(&mut last.tail))
            }
        };
        // The blank after an opening bracket may differ from the blank after a comma.
        let lead = if self.entries.len() == 1 && !lead.contains('\n') { style.gap().to_owned() } else { lead };
        let inner = line_indent(&lead).unwrap_or(indent).to_owned();
        let mut head = lead;
        if let Some(key) = key {
            head.push_str(&encode(key)?);
            head.push_str(&colon);
        }
        let value = Node::Text(style.lay_out(value, &inner)?);
        self.entries.push(Entry { key: key.map(str::to_owned), head, value, tail });
        Ok(self.entries.len() - 1)
    }

    /// Removes one entry with its comma. The white space beside the brackets stays.
    pub fn remove(&mut self, index: usize) {
        if index >= self.entries.len() {
            return;
        }
        let removed = self.entries.remove(index);
        if index == 0
            && let Some(first) = self.entries.first_mut()
        {
            let lead = leading_blank(&first.head).len();
            first.head.replace_range(..lead, leading_blank(&removed.head));
        }
        if index == self.entries.len()
            && let Some(last) = self.entries.last_mut()
        {
            last.tail = removed.tail;
        }
    }

    /// Keeps the entries whose index `keep` accepts, with the same layout as after single calls of [`Self::remove`].
    pub fn retain(&mut self, mut keep: impl FnMut(usize) -> bool) {
        let Some(first) = self.entries.first() else { return };
        let lead = leading_blank(&first.head).to_owned();
        let is_kept: Vec<bool> = (0..self.entries.len()).map(&mut keep).collect();
        let tail = self.entries.last_mut().map(|last| std::mem::take(&mut last.tail)).unwrap_or_default();
        let mut index = 0;
        self.entries.retain(|_| {
            index += 1;
            is_kept[index - 1]
        });
        if let Some(first) = self.entries.first_mut() {
            let own = leading_blank(&first.head).len();
            first.head.replace_range(..own, &lead);
        }
        if let Some(last) = self.entries.last_mut() {
            last.tail = tail;
        }
    }

    /// Removes the entries that a step of a pointer names: an element, or all members of this name.
    pub fn remove_all(&mut self, step: &str) -> bool {
        let before = self.entries.len();
        while let Some(index) = self.position(step) {
            self.remove(index);
            if !self.object {
                break;
            }
        }
        self.entries.len() < before
    }
}

/// Returns the index that a step of a pointer spells: decimal, without sign or leading zeros (RFC 6901 section 4).
pub(super) fn array_index(step: &str) -> Option<usize> {
    let is_index = step == "0" || (!step.starts_with('0') && step.bytes().all(|b| b.is_ascii_digit()));
    if is_index { step.parse().ok() } else { None }
}

/// Returns the string that a quoted and checked JSON string spells.
pub(super) fn decode(quoted: &str) -> Result<String, JsonError> {
    serde_json::from_str(quoted).map_err(JsonError::Value)
}

fn encode(key: &str) -> Result<String, JsonError> {
    serde_json::to_string(key).map_err(JsonError::Value)
}
