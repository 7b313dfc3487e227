//! Why an image could not be decoded.

use super::Format;
use crate::texture::ktx2::ReadError;

/// Why an image could not be decoded. The caller adds the file's name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecodeError {
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
        /// [`DecodeOptions::max_pixels`](super::DecodeOptions::max_pixels).
        limit: u64,
    },
    /// The EXR file has no such layer or channel.
    #[error("there is no layer or channel \"{asked}\": the file has {}", available.join(", "))]
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
    /// A KTX2 file was refused.
    #[error(transparent)]
    Ktx2(#[from] ReadError),
}

impl DecodeError {
    pub(super) fn malformed(format: Format, what: impl ToString) -> DecodeError {
        let what = what.to_string();
        DecodeError::Malformed { format, what }
    }

    pub(super) fn unsupported(format: Format, what: impl ToString) -> DecodeError {
        let what = what.to_string();
        DecodeError::Unsupported { format, what }
    }

    /// A reader's error on an in-memory file: the only kind that tells of the file's length is
    /// the unexpected end.
    pub(super) fn from_io(format: Format, error: &std::io::Error) -> DecodeError {
        let what = error.to_string();
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => DecodeError::Truncated { format, what },
            _ => DecodeError::Malformed { format, what },
        }
    }
}
