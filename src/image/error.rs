//! Why an image could not be decoded.

use crate::foreign::Foreign;
use crate::image::format::Format;
use crate::memory::OutOfMemory;

/// Why an image could not be decoded. The caller adds the file's name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// The file holds nothing that could be an image.
    #[error("expected PNG, JPEG, TIFF, WebP, HDR, EXR or KTX2, found {found}")]
    Foreign {
        /// What it is.
        found: Foreign,
    },
    /// The first bytes are no known format's.
    #[error(
        "unknown image format (the first bytes are {start:02x?}): expected PNG, JPEG, TIFF, WebP, \
         HDR, EXR or KTX2, or a TGA with the extension .tga"
    )]
    UnknownFormat {
        /// The first bytes, 8 at most.
        start: Vec<u8>,
    },
    /// The file ends before its image does.
    #[error("the {format} file is cut off ({what}): copy or export it again")]
    Truncated {
        /// The file's format.
        format: Format,
        /// What was missing, in the decoder's words.
        what: String,
    },
    /// The bytes break the format's rules.
    #[error("the {format} file is damaged ({what}): export it again")]
    Malformed {
        /// The file's format.
        format: Format,
        /// Which rule, in the decoder's words.
        what: String,
    },
    /// The header claims more texels than allowed, or none.
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
    #[error("there is no layer or channel \"{asked}\": the file has {}", listed(available.iter().map(String::as_str)))]
    MissingLayer {
        /// The layer that was asked for.
        asked: String,
        /// All layers and channels, in the file's order.
        available: Vec<String>,
    },
    /// The file is sound, but of a kind that is not read here.
    #[error("this {format} file is of a kind that is not read ({what}): save it differently")]
    Unsupported {
        /// The file's format.
        format: Format,
        /// Which kind.
        what: String,
    },
    /// There is no memory for the image.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

impl DecodeError {
    pub(super) fn malformed(format: Format, what: impl ToString) -> DecodeError {
        DecodeError::Malformed { format, what: brief(&what.to_string()) }
    }

    pub(super) fn unsupported(format: Format, what: impl ToString) -> DecodeError {
        DecodeError::Unsupported { format, what: brief(&what.to_string()) }
    }

    /// Whether the image may be decoded when there is more memory.
    pub fn is_out_of_memory(&self) -> bool {
        matches!(self, DecodeError::OutOfMemory(_))
    }

    /// A reader's error on an in-memory file: the only kind that tells of the file's length is
    /// the unexpected end.
    pub(super) fn from_io(format: Format, error: &std::io::Error) -> DecodeError {
        let what = brief(&error.to_string());
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => DecodeError::Truncated { format, what },
            _ => DecodeError::Malformed { format, what },
        }
    }
}

/// Longest quotation of a decoder in a message, in characters.
const LONGEST: usize = 300;

/// The words of a decoder as one line. Some decoders write several, and some repeat what the file holds, however long.
fn brief(words: &str) -> String {
    let mut line = words.split_whitespace().collect::<Vec<_>>().join(" ");
    if let Some((end, _)) = line.char_indices().nth(LONGEST) {
        line.truncate(end);
        line += "...";
    }
    line
}

/// The first of `names`, with commas, and how many more there are: at most about half of [`LONGEST`].
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
mod tests {
    use super::*;

    #[test]
    fn words_of_decoders_become_one_short_line() {
        assert_eq!(brief("Unknown marker\n 0xFF12\tfound "), "Unknown marker 0xFF12 found");
        let long = brief(&"ä".repeat(10_000));
        assert_eq!(long, format!("{}...", "ä".repeat(LONGEST)));
    }

    #[test]
    fn long_lists_are_cut() {
        assert_eq!(listed(["R", "G"].into_iter()), "R, G");
        let many = vec!["x"; 60_000];
        let list = listed(many.into_iter());
        assert!(list.starts_with("x, x") && list.ends_with("more") && list.len() < LONGEST, "{list}");
        let long = "long".repeat(10_000);
        assert!(listed([long.as_str(); 2].into_iter()).len() < LONGEST);
    }
}
