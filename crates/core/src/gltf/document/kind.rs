//! Distinguishing glTF documents from other files, and from documents of other versions.

use serde_json::Value;

use super::DocumentError;
use crate::foreign::Foreign;
use crate::image::FileFormat;

/// Checks that `bytes`, which are not a GLB, may be a JSON object.
///
/// # Errors
/// [`DocumentError::Foreign`], [`DocumentError::Image`] and [`DocumentError::NotGltf`], which name what the file is
/// instead.
pub(super) fn check_text(bytes: &[u8]) -> Result<(), DocumentError> {
    if let Some(found) = Foreign::detect(bytes) {
        return Err(DocumentError::Foreign { found });
    }
    if let Some(format) = FileFormat::detect(bytes, None) {
        return Err(DocumentError::Image { format });
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    // The JSON reader reports errors in a text that begins as an object does.
    if text.starts_with(b"{") {
        return Ok(());
    }
    let found = if bytes.starts_with(b"<?xml") {
        "an XML file".to_owned()
    } else {
        format!("a file that starts with \"{}\"", bytes[..bytes.len().min(8)].escape_ascii())
    };
    Err(DocumentError::NotGltf { found })
}

/// Checks that `root`, a document's JSON, declares glTF 2.0 or a version that readers of 2.0 may read (glTF 2.0 section
/// 5.9).
///
/// # Errors
/// [`DocumentError::NoVersion`] and [`DocumentError::OtherVersion`].
pub fn check_version(root: &Value) -> Result<(), DocumentError> {
    let asset = root.get("asset");
    let version = asset.and_then(|asset| asset.get("version"));
    let Some(found) = version.and_then(Value::as_str) else {
        let found = match (root.is_object(), asset, version) {
            (false, ..) => "JSON that is no object".to_owned(),
            (_, None, _) => "no \"asset\"".to_owned(),
            (.., None) => "an \"asset\" without \"version\"".to_owned(),
            (.., Some(version)) => format!("the version {}", shortened(version)),
        };
        return Err(DocumentError::NoVersion { found });
    };
    let other = |member, found: &Value| Err(DocumentError::OtherVersion { member, found: shortened(found) });
    if numbers(found).is_none_or(|(major, _)| major != 2) {
        return other("version", &Value::from(found));
    }
    match asset.and_then(|asset| asset.get("minVersion")) {
        Some(least) if least.as_str().and_then(numbers).is_none_or(|least| least > (2, 0)) => {
            other("minVersion", least)
        }
        _ => Ok(()),
    }
}

/// Returns major and minor version of a text such as `2.0`.
fn numbers(version: &str) -> Option<(u32, u32)> {
    let (major, minor) = version.split_once('.')?;
    let number = |digits: &str| digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse().ok())?;
    Some((number(major)?, number(minor)?))
}

/// Returns the beginning of a value, long enough to recognise the value.
fn shortened(value: &Value) -> String {
    value.to_string().chars().take(32).collect()
}
