//! Errors of JSON texts and of edits to them.

/// Deepest nesting of objects and arrays that is read. It is the limit of `serde_json`, so every document that is read
/// here can also be deserialised.
pub const MAX_DEPTH: usize = 127;

/// Why a text is not JSON, or why an edit cannot be made. Lines and columns count from 1, and columns count characters.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JsonError {
    /// The bytes are not UTF-8.
    #[error("line {line}, column {column}: expected UTF-8, found other bytes; save the file as UTF-8")]
    NotUtf8 {
        /// Line of the first wrong byte.
        line: usize,
        /// Column of the first wrong byte.
        column: usize,
    },
    /// The text breaks the grammar of RFC 8259.
    #[error("line {line}, column {column}: expected {expected}, found {found}; fix the text there, or export it again")]
    Syntax {
        /// Line of the found character.
        line: usize,
        /// Column of the found character.
        column: usize,
        /// What the grammar allows.
        expected: &'static str,
        /// The character, or the end of the text.
        found: String,
    },
    /// A `\u` escape of half a surrogate pair, which no UTF-8 string can hold.
    #[error("line {line}, column {column}: expected a pair of \\u surrogates, found half of one; remove it")]
    Surrogate {
        /// Line of the escape.
        line: usize,
        /// Column of the escape.
        column: usize,
    },
    /// Objects and arrays nest deeper than [`MAX_DEPTH`].
    #[error(
        "line {line}, column {column}: expected at most {MAX_DEPTH} nested objects and arrays, found more; nest fewer of \
         them"
    )]
    TooDeep {
        /// Line of the first bracket too deep.
        line: usize,
        /// Column of the first bracket too deep.
        column: usize,
    },
    /// The edit would nest deeper than [`MAX_DEPTH`].
    #[error("cannot write at \"{pointer}\": it would nest more than {MAX_DEPTH} objects and arrays")]
    EditTooDeep {
        /// The pointer of the edit.
        pointer: String,
    },
    /// A text is not a JSON Pointer, or the pointer is empty although the root cannot be meant.
    #[error("expected a JSON Pointer such as \"/materials/0/name\", found \"{pointer}\"")]
    Pointer {
        /// The given text.
        pointer: String,
    },
    /// A pointer leads through a scalar or past the end of an array.
    #[error("nothing at \"{pointer}\": \"{step}\" is neither a member of an object nor an index within an array")]
    NoSuchPlace {
        /// The pointer of the edit.
        pointer: String,
        /// The step that cannot be followed.
        step: String,
    },
    /// A value is not an array.
    #[error("expected an array at \"{pointer}\", found another value")]
    NotAnArray {
        /// The pointer of the value.
        pointer: String,
    },
    /// A value does not have the type that its reader expects.
    #[error("\"{pointer}\": {source}")]
    Read {
        /// The pointer of the value.
        pointer: String,
        /// What the reader expected and found.
        source: serde_json::Error,
    },
    /// A value cannot be written as JSON.
    #[error("not a JSON value: {0}")]
    Value(#[source] serde_json::Error),
}
