//! glTF URIs (glTF 2.0 section 2.8): data that are part of the text, or a file beside the asset.
//!
//! A build step reads no network and nothing outside the folder it was given, so of RFC 3986 only
//! relative paths that stay inside that folder remain. Choices where the standards leave one:
//! - Names are percent-decoded once, segment by segment. What exporters forget to encode is read as
//!   it stands: spaces, non-ASCII letters, and a `%` that no two hexadecimal digits follow.
//! - An unencoded `?` or `#` is refused: browsers cut the name there, native loaders do not.
//! - A name must be one on every system: no `\`, `:` or NUL in it, encoded or not.
//! - `a/../b.png` is `b.png`; a `..` that leaves the folder is refused, even if it comes back.

mod data;
mod error;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};

pub use data::DataUri;
pub use error::UriError;

/// Longest URI, in bytes, that is read as a path: the longest path of Linux.
pub const MAX_PATH_URI: usize = 4096;

/// RFC 3986 section 2.3: only unreserved characters stand for themselves in any part of any URI.
const ENCODED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~').remove(b'/');

/// What the `uri` of a buffer or an image refers to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Uri<'a> {
    /// The data themselves.
    Data(DataUri<'a>),
    /// A file, as a path relative to the folder of the asset, without `.` and `..`.
    Path(PathBuf),
}

impl<'a> Uri<'a> {
    /// Tells the two kinds apart and checks the URI. Data are not decoded yet.
    ///
    /// # Errors
    /// [`UriError`] for whatever is neither; see the module for what is refused.
    pub fn parse(uri: &'a str) -> Result<Uri<'a>, UriError> {
        match scheme(uri) {
            Some((scheme, rest)) if scheme.eq_ignore_ascii_case("data") => Ok(Uri::Data(DataUri::parse(rest)?)),
            _ => relative_path(uri).map(Uri::Path),
        }
    }
}

/// The path that `uri` names, relative to the folder of the asset: normalised, percent-decoded, and
/// inside that folder (links on the disk aside).
///
/// # Errors
/// [`UriError`] for anything but such a path, data URIs included.
pub fn relative_path(uri: &str) -> Result<PathBuf, UriError> {
    if let Some((scheme, _)) = scheme(uri) {
        return Err(match scheme.len() {
            1 => UriError::Absolute { uri: shortened(uri) },
            _ => UriError::Scheme { scheme: shortened(scheme) },
        });
    }
    if uri.len() > MAX_PATH_URI {
        return Err(UriError::TooLong { length: uri.len() });
    }
    if uri.starts_with('/') {
        return Err(UriError::Absolute { uri: uri.to_owned() });
    }
    if let Some(found) = uri.chars().find(|c| matches!(c, '?' | '#')) {
        return Err(UriError::Unencoded { uri: uri.to_owned(), found });
    }
    let mut names = Vec::new();
    // Whether the last segment names an entry of the folder it is in, and not a folder by itself.
    let mut file = false;
    for segment in uri.split('/') {
        let name = percent_decode_str(segment).decode_utf8();
        let name = name.map_err(|_| UriError::NotUtf8 { uri: uri.to_owned() })?;
        file = !matches!(&*name, "" | "." | "..");
        match &*name {
            "" | "." => {}
            ".." => {
                names.pop().ok_or_else(|| UriError::Outside { uri: uri.to_owned() })?;
            }
            _ => match name.chars().find(|c| matches!(c, '/' | '\\' | ':' | '\0')) {
                Some(found) => {
                    return Err(UriError::Name { uri: uri.to_owned(), found });
                }
                None => names.push(name),
            },
        }
    }
    if !file {
        return Err(UriError::NotAFile { uri: uri.to_owned() });
    }
    Ok(names.iter().map(|name| &**name).collect())
}

/// The URI of a relative path with `/` between its names; [`relative_path`] reads it back. Everything
/// that RFC 3986 does not call unreserved is percent-encoded.
pub fn encode_path(path: &str) -> String {
    utf8_percent_encode(path, ENCODED).to_string()
}

/// The scheme of an absolute URI (RFC 3986 section 3.1) and what follows its colon.
fn scheme(uri: &str) -> Option<(&str, &str)> {
    let (scheme, rest) = uri.split_once(':')?;
    let legal = |c: char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.');
    let is_scheme = scheme.starts_with(|c: char| c.is_ascii_alphabetic()) && scheme.chars().all(legal);
    is_scheme.then_some((scheme, rest))
}

/// Enough of a text of any length to recognise it by.
fn shortened(text: &str) -> String {
    text.chars().take(64).collect()
}
