//! What can be wrong with a JSON text or with an edit of one.

/// Deepest nesting of objects and arrays that is read: what `serde_json` reads, so that every
/// document that scans can also be deserialised.
pub const MAX_DEPTH: usize = 127;

/// Why a text is not JSON, or why an edit cannot be made. Lines and columns count from 1; columns
/// count characters.
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
    /// The grammar of RFC 8259 wants something else here.
    #[error("line {line}, column {column}: expected {expected}, found {found}")]
    Syntax {
        /// Line of what was found.
        line: usize,
        /// Column of what was found.
        column: usize,
        /// What the grammar allows.
        expected: &'static str,
        /// The character that is there, or the end.
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
    #[error("line {line}, column {column}: expected at most {MAX_DEPTH} nested objects and arrays, found more")]
    TooDeep {
        /// Line of the first bracket too deep.
        line: usize,
        /// Column of the first bracket too deep.
        column: usize,
    },
    /// The edit would nest deeper than [`MAX_DEPTH`].
    #[error("cannot write at \"{pointer}\": it would nest more than {MAX_DEPTH} objects and arrays")]
    EditTooDeep {
        /// Where the value was to go.
        pointer: String,
    },
    /// Not a JSON Pointer, or the empty one where the root cannot be meant.
    #[error("expected a JSON Pointer such as \"/materials/0/name\", found \"{pointer}\"")]
    Pointer {
        /// What was given.
        pointer: String,
    },
    /// The pointer leads through a scalar or past the end of an array.
    #[error("nothing at \"{pointer}\": \"{step}\" is neither a member of an object nor an index within an array")]
    NoSuchPlace {
        /// Where the edit was to go.
        pointer: String,
        /// The step that leads nowhere.
        step: String,
    },
    /// An array is wanted where something else stands.
    #[error("expected an array at \"{pointer}\", found another value")]
    NotAnArray {
        /// Where the array should be.
        pointer: String,
    },
    /// A value is not what its reader wants.
    #[error("\"{pointer}\": {source}")]
    Read {
        /// Place of the value.
        pointer: String,
        /// What was expected and found.
        source: serde_json::Error,
    },
    /// A value cannot be spelled in JSON.
    #[error("not a JSON value: {0}")]
    Value(#[source] serde_json::Error),
}
