//! Why a level cannot be encoded.

use crate::codec::format::{PayloadFormat, Target};
use crate::memory::OutOfMemory;

/// Why a level cannot be encoded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// The `bc` feature is off.
    #[error(
        "target `bc` needs the block encoders of cargo feature `bc`, found a build without it; install with `--features bc`"
    )]
    WithoutBc,
    /// The target has no format for sRGB colours.
    #[error("expected a target that holds sRGB colours, found `{}`; use `--target basis`", target.name())]
    WithoutColours {
        /// The target.
        target: Target,
    },
    /// The block encoder failed.
    #[error("the {format:?} encoder failed on a level of {width} x {height}: {reason}; try another target")]
    Encoder {
        /// The format of the blocks.
        format: PayloadFormat,
        /// Columns of the level.
        width: u32,
        /// Rows of the level.
        height: u32,
        /// The message of the encoder.
        reason: String,
    },
    /// There is no memory for a level.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    /// A value cannot be represented by a half float.
    #[error(
        "expected values that half floats hold in a level of {width} x {height}, found some beyond +-65504, or NaN; \
         use `--target basis`"
    )]
    NotFinite {
        /// Columns of the level.
        width: u32,
        /// Rows of the level.
        height: u32,
    },
    /// The PNG encoder failed.
    #[error("the PNG of a level of {width} x {height} cannot be written: {reason}; leave it out with `--gltf strict`")]
    Png {
        /// Columns of the level.
        width: u32,
        /// Rows of the level.
        height: u32,
        /// The message of the encoder.
        reason: String,
    },
}
