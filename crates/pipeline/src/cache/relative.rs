//! Relative paths that stay inside the folder that they are joined to.

use std::path::{Component, Path};

use serde::{Deserialize, Serialize};

/// One or more file names in UTF-8 with `/` between them, without root, drive, `.`, `..` or NUL on any system that
/// reads it.
///
/// No other text can be read into it, so a path from an untrusted entry cannot leave the output folder.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String")]
pub struct RelativePath(String);

/// A path that leaves its folder, or that not every system understands.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected a relative path of names in UTF-8 without `..`, found {found:?}")]
pub struct NotRelative {
    /// The beginning of the path.
    pub found: String,
}

impl RelativePath {
    /// Returns the path.
    pub fn as_path(&self) -> &Path {
        Path::new(&self.0)
    }
}

impl TryFrom<String> for RelativePath {
    type Error = NotRelative;

    fn try_from(text: String) -> Result<Self, NotRelative> {
        if text.split('/').all(is_name) { Ok(Self(text)) } else { Err(refused(&text)) }
    }
}

impl TryFrom<&Path> for RelativePath {
    type Error = NotRelative;

    fn try_from(path: &Path) -> Result<Self, NotRelative> {
        let name = |part| match part {
            Component::Normal(name) => name.to_str(),
            _ => None,
        };
        let names: Option<Vec<&str>> = path.components().map(name).collect();
        names.ok_or_else(|| refused(&path.to_string_lossy()))?.join("/").try_into()
    }
}

/// Returns whether `name` is a valid file name on this system.
fn is_name(name: &str) -> bool {
    // Windows splits names at `\`, reads `C:` as a drive and `a:b` as a stream, and drops dots and spaces at the end.
    let is_portable = !name.contains(['\\', ':']) && !name.ends_with(['.', ' ']);
    !matches!(name, "" | "." | "..") && !name.contains('\0') && (is_portable || !cfg!(windows))
}

fn refused(found: &str) -> NotRelative {
    NotRelative { found: found.chars().take(80).collect() }
}

#[cfg(test)]
mod tests;
