//! JSON that keeps its spelling: every byte that is not edited is written as it was read.
//!
//! A document is kept as its text. Only the objects and arrays that an edit passes through are split into entries, and
//! everything else stays text, so nothing is lost. Values are addressed by JSON Pointers (RFC 6901):
//! `/materials/3/normalTexture/index`, with `~1` for `/` and `~0` for `~` inside a name. The empty pointer is the whole
//! document.
//!
//! ```
//! use roughcast_core::gltf::json::Json;
//!
//! let mut json = Json::parse(br#"{ "asset": {"version":"2.0"}, "odd" : 1.0e+00 }"#)?;
//! json.set("/asset/generator", "roughcast")?;
//! assert_eq!(json.to_string(), r#"{ "asset": {"version":"2.0", "generator":"roughcast"}, "odd" : 1.0e+00 }"#);
//! # Ok::<(), roughcast_core::gltf::json::JsonError>(())
//! ```

mod error;
mod node;
mod scan;
mod style;
#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::fmt;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

pub use error::{JsonError, MAX_DEPTH};

use node::{Node, array_index, decode};
use style::Style;

const BYTE_ORDER_MARK: &str = "\u{feff}";

/// Returns a member's name as a step of a JSON Pointer (RFC 6901).
pub(crate) fn escaped(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

/// A JSON document that is written back byte for byte, except for its edits.
///
/// If an object repeats a key, the last member counts, as for `serde_json`.
#[derive(Debug, Clone)]
pub struct Json {
    /// Byte order mark and white space before the root value.
    before: String,
    root: Node,
    /// White space after the root value.
    after: String,
    style: Style,
}

impl Json {
    /// Reads a document in UTF-8, with or without a byte order mark.
    ///
    /// # Errors
    /// Errors for text that RFC 8259 does not allow, for nesting deeper than [`MAX_DEPTH`], and for escapes of unpaired
    /// surrogates, each with line and column.
    pub fn parse(bytes: &[u8]) -> Result<Json, JsonError> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let (valid, _) = bytes.split_at(error.valid_up_to());
            let (line, column) = scan::position(&String::from_utf8_lossy(valid), valid.len());
            JsonError::NotUtf8 { line, column }
        })?;
        let unmarked = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
        let mark = text.len() - unmarked.len();
        let root_range = scan::document(unmarked)?;
        let slice = |range| text.get(range).unwrap_or_default();
        let root = slice(mark + root_range.start..mark + root_range.end);
        Ok(Json {
            before: slice(0..mark + root_range.start).to_owned(),
            root: Node::Text(root.to_owned()),
            after: slice(mark + root_range.end..text.len()).to_owned(),
            style: Style::of(root)?,
        })
    }

    /// Returns the document in UTF-8. Without edits, these are the bytes that were read.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.to_string().into_bytes()
    }

    /// Returns the value at `pointer` as the document spells it, or `None` if there is no value.
    pub fn text(&self, pointer: &str) -> Option<Cow<'_, str>> {
        let steps = steps(pointer).ok()?;
        let mut node = &self.root;
        let mut rest = steps.as_slice();
        while let (Node::Open(container), [step, deeper @ ..]) = (node, rest) {
            node = &container.entries.get(container.position(step)?)?.value;
            rest = deeper;
        }
        match node {
            Node::Text(text) => within(text, rest).map(Cow::Borrowed),
            Node::Open(_) => {
                let mut text = String::new();
                node.write(&mut text);
                Some(Cow::Owned(text))
            }
        }
    }

    /// Reads the value at `pointer` as a `T`. Returns `None` if there is no value.
    ///
    /// # Errors
    /// [`JsonError::Read`] if the value is not a `T`.
    pub fn read<T: DeserializeOwned>(&self, pointer: &str) -> Result<Option<T>, JsonError> {
        // Derived readers refuse a repeated key, and a tree has one value for it. The value is therefore read as a tree
        // first.
        let read = self.value(pointer)?.map(T::deserialize).transpose();
        read.map_err(|source| JsonError::Read { pointer: pointer.to_owned(), source })
    }

    /// Returns the value at `pointer` as a tree, or `None` if there is no value.
    ///
    /// # Errors
    /// [`JsonError::Read`] if the value has a number beyond the range of `f64`.
    pub fn value(&self, pointer: &str) -> Result<Option<Value>, JsonError> {
        let value = self.text(pointer).map(|text| serde_json::from_str(&text)).transpose();
        value.map_err(|source| JsonError::Read { pointer: pointer.to_owned(), source })
    }

    /// Returns the number of members or elements of the object or array at `pointer`, or `None` if there is none.
    pub fn len(&self, pointer: &str) -> Option<usize> {
        scan::entries(&self.text(pointer)?).ok()?.map(|spans| spans.len())
    }

    /// Writes `value` at `pointer`: over the existing value, or as the last member of its object. Missing objects on
    /// the way are created. Floats are spelled in their shortest form that reads back as the same value. NaN and the
    /// infinities become `null`, as in `serde_json`.
    ///
    /// # Errors
    /// An error for a pointer through a scalar or past the end of an array, for nesting deeper than [`MAX_DEPTH`], and
    /// for a value that is not JSON. The document is then unchanged.
    pub fn set<T: Serialize + ?Sized>(&mut self, pointer: &str, value: &T) -> Result<(), JsonError> {
        let (steps, text) = self.prepare(pointer, value, 0)?;
        let (node, indent) = reach(&mut self.root, &steps, "null", "", &self.style, pointer)?;
        *node = Node::Text(self.style.lay_out(&text, &indent)?);
        Ok(())
    }

    /// Appends `value` to the array at `pointer` and returns its index. A missing array is created, with the objects on
    /// the way to it.
    ///
    /// # Errors
    /// The errors of [`set`](Self::set), and [`JsonError::NotAnArray`].
    pub fn push<T: Serialize + ?Sized>(&mut self, pointer: &str, value: &T) -> Result<usize, JsonError> {
        let (steps, text) = self.prepare(pointer, value, 1)?;
        let (node, indent) = reach(&mut self.root, &steps, "[]", "", &self.style, pointer)?;
        match node.open()? {
            Some(array) if !array.object => array.append(None, &text, &indent, &self.style),
            _ => Err(JsonError::NotAnArray { pointer: pointer.to_owned() }),
        }
    }

    /// Removes the member or element at `pointer` with its comma. Returns `false` if there is none.
    ///
    /// # Errors
    /// [`JsonError::Pointer`] for a pointer that is malformed or empty, since a document must have a root.
    pub fn remove(&mut self, pointer: &str) -> Result<bool, JsonError> {
        let steps = steps(pointer)?;
        let Some((last, parents)) = steps.split_last() else {
            return Err(JsonError::Pointer { pointer: pointer.to_owned() });
        };
        if self.text(pointer).is_none() {
            return Ok(false);
        }
        let (parent, _) = reach(&mut self.root, parents, "{}", "", &self.style, pointer)?;
        Ok(parent.open()?.is_some_and(|container| container.remove_all(last)))
    }

    /// Keeps the elements of the array at `pointer` whose index `keep` accepts. A missing array counts as empty.
    ///
    /// # Errors
    /// [`JsonError::NotAnArray`], and [`JsonError::Pointer`] for a malformed pointer.
    pub fn retain(&mut self, pointer: &str, keep: impl FnMut(usize) -> bool) -> Result<(), JsonError> {
        let steps = steps(pointer)?;
        if self.text(pointer).is_none() {
            return Ok(());
        }
        let (node, _) = reach(&mut self.root, &steps, "[]", "", &self.style, pointer)?;
        let Some(array) = node.open()?.filter(|container| !container.object) else {
            return Err(JsonError::NotAnArray { pointer: pointer.to_owned() });
        };
        array.retain(keep);
        Ok(())
    }

    /// Checks the input of an edit, before the document is changed. `wrapped` is the number of containers around the
    /// value besides those that `pointer` names.
    fn prepare<T: Serialize + ?Sized>(
        &self,
        pointer: &str,
        value: &T,
        wrapped: usize,
    ) -> Result<(Vec<String>, String), JsonError> {
        let steps = steps(pointer)?;
        let text = serde_json::to_string(value).map_err(JsonError::Value)?;
        if !scan::fits(&text, steps.len() + wrapped) {
            return Err(JsonError::EditTooDeep { pointer: pointer.to_owned() });
        }
        Ok((steps, text))
    }
}

impl fmt::Display for Json {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = self.before.clone();
        self.root.write(&mut text);
        text.push_str(&self.after);
        f.write_str(&text)
    }
}

/// Returns the decoded names of a JSON Pointer (RFC 6901 sections 3 and 4).
fn steps(pointer: &str) -> Result<Vec<String>, JsonError> {
    let malformed = || JsonError::Pointer { pointer: pointer.to_owned() };
    let mut parts = pointer.split('/');
    if parts.next() != Some("") {
        return Err(malformed());
    }
    let decode = |part: &str| {
        let without_escapes = part.replace("~0", "").replace("~1", "");
        (!without_escapes.contains('~')).then(|| part.replace("~1", "/").replace("~0", "~"))
    };
    parts.map(|part| decode(part).ok_or_else(malformed)).collect()
}

/// Returns the text of the value to which `steps` lead inside `text`.
fn within<'a>(mut text: &'a str, steps: &[String]) -> Option<&'a str> {
    for step in steps {
        let spans = scan::entries(text).ok()??;
        let span = if text.starts_with('[') {
            spans.get(array_index(step)?)?
        } else {
            let names = |quoted: &str| decode(quoted).is_ok_and(|key| key == *step);
            spans.iter().rfind(|span| span.key.clone().and_then(|key| text.get(key)).is_some_and(names))?
        };
        text = text.get(span.value.clone())?;
    }
    Some(text)
}

/// Returns the node to which `steps` lead, with all containers on the way opened, and the indentation of the node's
/// line. Missing members are created: objects on the way, and `leaf` at the end.
fn reach<'a>(
    node: &'a mut Node,
    steps: &[String],
    leaf: &str,
    indent: &str,
    style: &Style,
    pointer: &str,
) -> Result<(&'a mut Node, String), JsonError> {
    let Some((step, rest)) = steps.split_first() else {
        return Ok((node, indent.to_owned()));
    };
    let blocked = || JsonError::NoSuchPlace { pointer: pointer.to_owned(), step: step.clone() };
    let container = node.open()?.ok_or_else(blocked)?;
    let index = match container.position(step) {
        Some(index) => index,
        None if container.object => {
            let made = if rest.is_empty() { leaf } else { "{}" };
            container.append(Some(step), made, indent, style)?
        }
        None => return Err(blocked()),
    };
    let entry = container.entries.get_mut(index).ok_or_else(blocked)?;
    let indent = entry.indent(indent).to_owned();
    reach(&mut entry.value, rest, leaf, &indent, style, pointer)
}
