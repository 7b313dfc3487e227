//! Errors of reading KTX2 files.

use crate::foreign::Foreign;
use crate::memory::OutOfMemory;

/// Why a KTX2 file could not be read. The caller adds the name of the file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file does not begin with the identifier of KTX 2.
    #[error("not a KTX2 file: the identifier is missing")]
    NotKtx2,
    /// The file cannot be a texture at all.
    #[error("expected a KTX2 file, found {found}")]
    Foreign {
        /// What the file is.
        found: Foreign,
    },
    /// A section lies outside the file.
    #[error("the KTX2 file is cut off: a section ends after the {length} bytes of the file; copy or export it again")]
    Truncated {
        /// The file's length in bytes.
        length: u64,
    },
    /// A rule of the KTX 2.0 specification is broken.
    #[error("the KTX2 file is damaged ({what}): export it again")]
    Malformed {
        /// The rule, as what is wrong.
        what: &'static str,
    },
    /// The key/value data has more entries than any reader needs.
    #[error("the KTX2 file has more than {limit} keys: write it again without the keys that no reader needs")]
    TooManyKeys {
        /// Most entries that are read.
        limit: usize,
    },
    /// A level's length differs from what its size and format need.
    #[error(
        "level {level} of the KTX2 file: expected {expected} bytes by its size and format, found {found}; export it again"
    )]
    LevelLength {
        /// Index of the level, 0 is the largest.
        level: u32,
        /// Bytes that its size and format need.
        expected: u64,
        /// Bytes by the level index or by the compressed data.
        found: u64,
    },
    /// A level's compressed data is damaged.
    #[error("level {level} of the KTX2 file cannot be decompressed ({what}): export it again")]
    Compression {
        /// Index of the level, 0 is the largest.
        level: u32,
        /// The decoder's message.
        what: String,
    },
    /// The header claims more texels than the limit.
    #[error(
        "the KTX2 file has {width} x {height} texels in {images} images a level: expected at most {limit} texels in all; \
         scale the images down or raise the limit"
    )]
    TooLarge {
        /// Claimed width of the level in texels.
        width: u32,
        /// Claimed height of the level in texels.
        height: u32,
        /// Claimed number of images: layers times faces times slices.
        images: u64,
        /// The limit, see [`Ktx2::with_max_texels`](crate::ktx2::read::Ktx2::with_max_texels).
        limit: u64,
    },
    /// There is not enough memory for a level.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    /// The file has no level of this index.
    #[error(
        "expected a level below {count} of the KTX2 file, found level {asked} requested; request one of its levels"
    )]
    NoLevel {
        /// Index of the level.
        asked: u32,
        /// Number of levels.
        count: u32,
    },
    /// The texture is not a single 2D image for each level.
    #[error("the KTX2 file holds {kind}, and only a plain 2D texture can be decoded: export its images one by one")]
    NotPlain2d {
        /// What the file holds.
        kind: &'static str,
    },
    /// The file is valid, but its format or supercompression is not decoded here.
    #[error("{what} in KTX2 cannot be decoded: convert it to an uncompressed, BC, UASTC or ETC1S format")]
    Unsupported {
        /// The format or supercompression scheme.
        what: String,
    },
}
