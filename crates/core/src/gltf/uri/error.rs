//! Errors of URIs.

/// Longest URI in bytes that is read as a path: the longest path of Linux.
pub const MAX_PATH_URI: usize = 4096;

/// Why a URI is neither data nor a file beside the asset.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UriError {
    /// The URI has another scheme than `data:`.
    #[error("expected a relative path or a data URI, found the scheme \"{scheme}:\"; store the file beside the asset")]
    Scheme {
        /// The scheme, cut to 64 characters.
        scheme: String,
    },
    /// The path begins at the root of a drive or host.
    #[error("expected a path relative to the asset, found \"{uri}\"; store the file beside the asset")]
    Absolute {
        /// The URI, cut to 64 characters if it starts with a drive.
        uri: String,
    },
    /// The path leaves the folder of the asset with `..`.
    #[error("expected a path inside the folder of the asset, found \"{uri}\"; move the file into that folder")]
    Outside {
        /// The URI.
        uri: String,
    },
    /// The path is empty or names a folder.
    #[error("expected the path of a file, found \"{uri}\"; name the file")]
    NotAFile {
        /// The URI.
        uri: String,
    },
    /// The URI has a query or fragment, or a file name is not encoded.
    #[error("expected a path, found '{found}' in \"{uri}\"; if it is part of a name, write %{:02X}", u32::from(*found))]
    Unencoded {
        /// The URI.
        uri: String,
        /// `?` or `#`.
        found: char,
    },
    /// The name is not valid on every system.
    #[error(
        "expected a file name without '/', '\\', ':' and NUL, found {found:?} in \"{uri}\"; separate folders by '/' or \
         rename the file"
    )]
    Name {
        /// The URI.
        uri: String,
        /// The first such character.
        found: char,
    },
    /// The percent-encoded bytes are not UTF-8.
    #[error("expected percent-encoded UTF-8, found other bytes in \"{uri}\"; encode the name as UTF-8")]
    NotUtf8 {
        /// The URI.
        uri: String,
    },
    /// The URI is longer than [`MAX_PATH_URI`].
    #[error(
        "expected a path of at most {MAX_PATH_URI} bytes, found {length}; shorten it, or write \"data:\" if it is data"
    )]
    TooLong {
        /// Length in bytes.
        length: usize,
    },
    /// A data URI has no data.
    #[error("expected ',' between the media type and the data of a data URI, found none; export the asset again")]
    NoComma,
    /// The data is longer than the caller allows.
    #[error("expected at most {limit} bytes in a data URI, found more; store the data in a file")]
    DataTooLarge {
        /// The most bytes allowed.
        limit: usize,
    },
    /// The data of a base64 URI is not base64.
    #[error("expected base64 (RFC 4648 section 4) in a data URI, found: {source}; export the asset again")]
    Base64 {
        /// The position of the error.
        source: base64::DecodeError,
    },
}
