//! Format versions of the JSON files that Roughcast writes and reads again.

use serde::Deserialize;

/// A JSON file of another format than this version of the tool reads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected a {kind} of formatVersion {expected}, found {}; {remedy}", described(*found))]
pub struct FormatError {
    /// What the file should be.
    pub kind: &'static str,
    /// The format version that this version of the tool reads.
    pub expected: u32,
    /// The format version of the file; `None` where the file names none.
    pub found: Option<u64>,
    /// What the user can do.
    pub remedy: &'static str,
}

fn described(found: Option<u64>) -> String {
    found.map_or_else(|| "none".to_owned(), |found| found.to_string())
}

/// Checks that the JSON object in `json`, a file of `kind`, has the `formatVersion` `expected`.
///
/// Bytes that are no JSON object pass: the reader of the whole file says better what is wrong with them.
///
/// # Errors
/// [`FormatError`] where the format version is another one or missing.
pub fn check_format(json: &[u8], kind: &'static str, expected: u32, remedy: &'static str) -> Result<(), FormatError> {
    #[derive(Deserialize)]
    #[serde(rename_all = "camelCase")]
    struct Head {
        #[serde(default)]
        format_version: Option<u64>,
    }
    match serde_json::from_slice(json) {
        Ok(Head { format_version }) if format_version != Some(u64::from(expected)) => {
            Err(FormatError { kind, expected, found: format_version, remedy })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
