//! glTF URIs (glTF 2.0 section 2.8): data in the URI itself, or a file beside the asset.
//!
//! A build step reads no network and nothing outside its folder. From RFC 3986, only relative paths inside that folder
//! are therefore allowed. Where the standards leave a choice, the rules are:
//! - Names are percent-decoded once, segment by segment. Characters that exporters forget to encode are read as they
//!   are: spaces, non-ASCII letters, and a `%` without two hexadecimal digits after it.
//! - An unencoded `?` or `#` is refused, because browsers cut the name there and native loaders do not.
//! - A name must be valid on every system: no `\`, `:` or NUL in it, encoded or not.
//! - `a/../b.png` is `b.png`. A `..` that leaves the folder is refused, even if the path comes back.

mod data;
mod error;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};

pub use data::DataUri;
pub use error::{MAX_PATH_URI, UriError};

/// Characters that are percent-encoded: all but `/` and those that RFC 3986 section 2.3 calls unreserved.
const ENCODED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~').remove(b'/');

/// The target of the `uri` of a buffer or an image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Uri<'a> {
    /// Data in the URI itself.
    Data(DataUri<'a>),
    /// A file, as a path relative to the folder of the asset, without `.` and `..`.
    Path(PathBuf),
}

impl<'a> Uri<'a> {
    /// Checks the URI and returns its kind. Data is not decoded yet.
    ///
    /// # Errors
    /// [`UriError`] for a URI of neither kind. The module documentation lists what is refused.
    pub fn parse(uri: &'a str) -> Result<Uri<'a>, UriError> {
        match scheme(uri) {
            Some((scheme, rest)) if scheme.eq_ignore_ascii_case("data") => Ok(Uri::Data(DataUri::parse(rest)?)),
            _ => relative_path(uri).map(Uri::Path),
        }
    }
}

/// Returns the path that `uri` names, relative to the folder of the asset. The path is normalised, percent-decoded and
/// inside that folder, apart from links on the disk.
///
/// # Errors
/// [`UriError`] for anything but such a path, including data URIs.
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
    // Whether the last segment can name a file.
    let mut is_file = false;
    for segment in uri.split('/') {
        let name = percent_decode_str(segment).decode_utf8();
        let name = name.map_err(|_| UriError::NotUtf8 { uri: uri.to_owned() })?;
        is_file = !matches!(&*name, "" | "." | "..");
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
    if !is_file {
        return Err(UriError::NotAFile { uri: uri.to_owned() });
    }
    Ok(names.iter().map(|name| &**name).collect())
}

/// Returns the URI of a relative path with `/` between its names. [`relative_path`] reads it back. Every character that
/// RFC 3986 does not call unreserved is percent-encoded.
pub fn encode_path(path: &str) -> String {
    utf8_percent_encode(path, ENCODED).to_string()
}

/// Returns the scheme of an absolute URI (RFC 3986 section 3.1) and the text after its colon.
fn scheme(uri: &str) -> Option<(&str, &str)> {
    let (scheme, rest) = uri.split_once(':')?;
    let legal = |c: char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.');
    let is_scheme = scheme.starts_with(|c: char| c.is_ascii_alphabetic()) && scheme.chars().all(legal);
    is_scheme.then_some((scheme, rest))
}

/// Returns the beginning of a text, long enough to recognise the text.
fn shortened(text: &str) -> String {
    text.chars().take(64).collect()
}
