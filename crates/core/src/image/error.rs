//! Why an image could not be decoded.

use crate::foreign::Foreign;
use crate::image::format::{FileFormat, signed_formats, unsigned_formats};
use crate::memory::OutOfMemory;

/// Why an image could not be decoded. The caller adds the file's name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// The file is of another kind than an image.
    #[error("expected {}, found {found}", signed_formats())]
    Foreign {
        /// The kind of the file.
        found: Foreign,
    },
    /// The file is a glTF asset, which has images.
    #[error("expected {}, found a glTF asset; name one of its images, or bake the asset itself", signed_formats())]
    Asset,
    /// The first bytes are not those of a known format.
    #[error(
        "unknown image format (the first bytes are {start:02x?}): expected {}{}",
        signed_formats(),
        unsigned_formats()
    )]
    UnknownFormat {
        /// The first bytes, 8 at most.
        start: Vec<u8>,
    },
    /// The file ends before its image does.
    #[error("the {format} file is cut off ({what}): copy or export it again")]
    Truncated {
        /// The file's format.
        format: FileFormat,
        /// What was missing, in the decoder's words.
        what: String,
    },
    /// The bytes break the format's rules.
    #[error("the {format} file is damaged ({what}): export it again")]
    Malformed {
        /// The file's format.
        format: FileFormat,
        /// Which rule, in the decoder's words.
        what: String,
    },
    /// The header claims more texels than allowed.
    #[error(
        "the image claims {width} x {height} texels, and the limit is {limit} in all: scale it down or raise the limit"
    )]
    TooLarge {
        /// Claimed width in texels.
        width: u64,
        /// Claimed height in texels.
        height: u64,
        /// [`DecodeOptions::max_pixels`](crate::image::DecodeOptions::max_pixels).
        limit: u64,
    },
    /// The EXR file has no such layer or channel.
    #[error(
        "there is no layer or channel \"{asked}\": the file has {}; name one of them",
        listed(available.iter().map(String::as_str))
    )]
    MissingLayer {
        /// The layer that was asked for.
        asked: String,
        /// All layers and channels, in the file's order.
        available: Vec<String>,
    },
    /// The file is valid, but uses a variant of the format that is not supported.
    #[error("this {format} file is of a kind that is not read ({what}): save it differently")]
    Unsupported {
        /// The file's format.
        format: FileFormat,
        /// The variant.
        what: String,
    },
    /// There is no memory for the image.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

impl DecodeError {
    /// Returns the error for a file in no format of images.
    pub(super) fn of_no_format(bytes: &[u8]) -> Self {
        // A .glb file has this signature, and a .gltf file is a JSON object.
        if bytes.starts_with(b"glTF") || bytes.trim_ascii_start().starts_with(b"{") {
            return Self::Asset;
        }
        Self::UnknownFormat { start: bytes.iter().take(8).copied().collect() }
    }

    pub(super) fn malformed(format: FileFormat, what: impl ToString) -> DecodeError {
        DecodeError::Malformed { format, what: brief(&what.to_string()) }
    }

    pub(super) fn unsupported(format: FileFormat, what: impl ToString) -> DecodeError {
        DecodeError::Unsupported { format, what: brief(&what.to_string()) }
    }

    /// Returns whether the image could be decoded with more memory.
    pub fn is_out_of_memory(&self) -> bool {
        matches!(self, DecodeError::OutOfMemory(_))
    }

    /// Converts a reader's error on a file in memory. An unexpected end is the only error that means a truncated file.
    pub(super) fn from_io(format: FileFormat, error: &std::io::Error) -> DecodeError {
        let what = brief(&error.to_string());
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => DecodeError::Truncated { format, what },
            _ => DecodeError::Malformed { format, what },
        }
    }
}

/// The longest quotation of a decoder in a message, in characters.
const LONGEST: usize = 300;

/// Shortens the message of a decoder to one line. Some decoders write several lines, and some quote long parts of the
/// file.
fn brief(words: &str) -> String {
    let mut line = words.split_whitespace().collect::<Vec<_>>().join(" ");
    if let Some((end, _)) = line.char_indices().nth(LONGEST) {
        line.truncate(end);
        line += "...";
    }
    line
}

/// Lists the first of `names`, separated by commas, and the number of further names. The list has at most about half of
/// [`LONGEST`] characters.
pub(super) fn listed<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> String {
    let mut more = names.len();
    let mut list = String::new();
    for name in names {
        if list.len() > LONGEST / 2 {
            return format!("{list} and {more} more");
        }
        let separator = if list.is_empty() { "" } else { ", " };
        list += &format!("{separator}{}", brief(name).chars().take(LONGEST / 4).collect::<String>());
        more -= 1;
    }
    list
}

#[cfg(test)]
mod tests;
