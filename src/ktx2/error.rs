//! Why a KTX2 file could not be read.

use crate::memory::OutOfMemory;

/// Why a KTX2 file could not be read. The caller adds the file's name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The identifier of KTX 2 is not there.
    #[error("not a KTX2 file: the identifier is missing")]
    NotKtx2,
    /// A section lies outside the file.
    #[error("the KTX2 file is cut off: a section ends past the {length} bytes there are; copy or export it again")]
    Truncated {
        /// The file's length in bytes.
        length: u64,
    },
    /// A rule of the KTX 2.0 specification is broken.
    #[error("the KTX2 file is damaged ({what}): export it again")]
    Malformed {
        /// Which rule.
        what: &'static str,
    },
    /// The key/value data has more entries than anybody needs.
    #[error("the KTX2 file has more than {limit} keys: write it again without those that no reader asks for")]
    TooManyKeys {
        /// Most entries that are read.
        limit: usize,
    },
    /// A level's length is not what its size and format make it.
    #[error("level {level} of the KTX2 file has {found} bytes, its size and format make {expected}: export it again")]
    LevelLength {
        /// Index of the level, 0 is the largest.
        level: u32,
        /// Bytes that its size and format make.
        expected: u64,
        /// Bytes that the level index, or the compressed data, has.
        found: u64,
    },
    /// A level's compressed data is broken.
    #[error("level {level} of the KTX2 file cannot be decompressed ({what}): export it again")]
    Compression {
        /// Index of the level, 0 is the largest.
        level: u32,
        /// What was wrong with it, in the decoder's words.
        what: String,
    },
    /// The header claims more texels than allowed.
    #[error(
        "the KTX2 file claims {width} x {height} texels in {images} images a level, and the limit is {limit} in all: scale it down or raise the limit"
    )]
    TooLarge {
        /// Claimed width of the level in texels.
        width: u32,
        /// Claimed height of the level in texels.
        height: u32,
        /// Claimed layers times faces times slices.
        images: u64,
        /// See [`Ktx2::with_max_texels`](crate::ktx2::read::Ktx2::with_max_texels).
        limit: u64,
    },
    /// There is no memory for a level.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    /// There is no such level.
    #[error("the KTX2 file has {count} levels, and level {asked} was asked for")]
    NoLevel {
        /// Index that was asked for.
        asked: u32,
        /// Number of levels.
        count: u32,
    },
    /// The texture is not one 2D image a level.
    #[error("the KTX2 file holds {kind}, and only a plain 2D texture can be decoded: export its images one by one")]
    NotPlain2d {
        /// What it holds.
        kind: &'static str,
    },
    /// The file is sound, but its format or compression is not decoded here.
    #[error("{what} in KTX2 cannot be decoded: convert it to an uncompressed, BC, UASTC or ETC1S format")]
    Unsupported {
        /// The format or supercompression scheme.
        what: String,
    },
}
