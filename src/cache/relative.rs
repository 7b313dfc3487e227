//! A path that stays inside the folder that it is joined to.

use std::path::{Component, Path};

use serde::{Deserialize, Serialize};

/// One or more names with `/` between them, in UTF-8: no root, drive, `.`, `..` or NUL, on any system that reads it.
///
/// Nothing else can be read into it, so that a path from an entry of somebody else's cache cannot leave the output folder.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String")]
pub struct RelativePath(String);

/// A path that leads elsewhere, or that not every reader understands.
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

/// Whether `name` is the name of a file in a folder, on the system that this runs on.
fn is_name(name: &str) -> bool {
    // Windows splits names at `\`, takes `C:` for a drive and `a:b` for a stream, and cuts dots and spaces at the end.
    let is_portable = !name.contains(['\\', ':']) && !name.ends_with(['.', ' ']);
    !matches!(name, "" | "." | "..") && !name.contains('\0') && (is_portable || !cfg!(windows))
}

fn refused(found: &str) -> NotRelative {
    NotRelative { found: found.chars().take(80).collect() }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn names_below_a_folder_are_relative_paths() {
        for text in ["a", "a.gltf", "a.roughcast/b c.ktx2", "..a/b..", "ä/ö", "..."] {
            let path = RelativePath::try_from(text.to_owned()).expect(text);
            assert_eq!((path.as_path(), RelativePath::try_from(Path::new(text))), (Path::new(text), Ok(path.clone())));
            let json = serde_json::to_value(&path).expect("JSON");
            assert_eq!((json.as_str(), serde_json::from_value(json.clone()).ok()), (Some(text), Some(path)));
        }
    }

    #[test]
    fn what_leads_out_of_the_folder_is_refused() {
        for text in ["", ".", "..", "/", "/a", "a/", "a//b", "./a", "a/./b", "../a", "a/..", "a/../../b", "a\0b"] {
            assert!(RelativePath::try_from(text.to_owned()).is_err(), "{text:?}");
            assert!(serde_json::from_value::<RelativePath>(text.into()).is_err(), "{text:?}");
        }
        for text in ["", ".", "..", "/a", "../a", "a/../b"] {
            assert!(RelativePath::try_from(Path::new(text)).is_err(), "{text:?}");
        }
        for text in ["C:a", "C:\\a", "\\\\host\\a", "a\\..\\..\\b", "a:b", ".. "] {
            assert_eq!(RelativePath::try_from(text.to_owned()).is_err(), cfg!(windows), "{text:?}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_name_that_is_not_utf_8_is_refused() {
        use std::os::unix::ffi::OsStrExt;
        let path = Path::new(std::ffi::OsStr::from_bytes(b"a/\xff"));
        assert!(RelativePath::try_from(path).is_err());
    }

    proptest! {
        #[test]
        fn what_is_accepted_stays_below_the_folder(text in "[a./\\\\: \\PC]{0,12}") {
            if let Ok(path) = RelativePath::try_from(text.clone()) {
                let parts: Vec<Component> = path.as_path().components().collect();
                prop_assert!(!parts.is_empty() && parts.iter().all(|part| matches!(part, Component::Normal(_))));
                prop_assert!(Path::new("folder").join(path.as_path()).starts_with("folder"));
            }
        }
    }
}
