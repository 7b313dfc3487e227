//! Names on file systems that ignore case.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Returns `path` in lower case: paths with the same result are one file on Windows and macOS. Letters that are
/// composed in different ways (NFC and NFD) stay different. A name that is not UTF-8 stays unchanged.
pub fn case_folded(path: &Path) -> PathBuf {
    let lowered = |name: &OsStr| name.to_str().map_or_else(|| name.to_owned(), |name| name.to_lowercase().into());
    path.components().map(|part| -> OsString { lowered(part.as_os_str()) }).collect()
}
