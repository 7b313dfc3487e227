//! Decoded images, and the decoders of raster formats from PNG to OpenEXR. This module does not know glTF.

mod channel_sum;
mod decode;
mod decoded;
mod error;
mod exr;
mod format;
mod jpeg;
mod rgba;
mod size;
mod srgb;
mod tiff;

pub use channel_sum::ChannelSum;
pub use decode::{DecodeOptions, decode_raster};
pub use error::DecodeError;
pub use format::FileFormat;

pub use decoded::{Image, Samples};

pub use rgba::Rgba;
pub use srgb::{linear_to_srgb, srgb_to_linear};

/// Why an image cannot be used as a map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The image has too few channels.
    #[error(
        "expected {expected}, found an image of {found} channel(s); use a map that has them, or read it as heights"
    )]
    Channels {
        /// What the map needs.
        expected: &'static str,
        /// Channels of the image.
        found: u32,
    },
    /// The image contains NaN or infinity.
    #[error(
        "expected finite values, found NaN or infinity in {count} texel(s), the first at column {x}, row {y}; repair the map or export it again"
    )]
    NotFinite {
        /// Number of texels with NaN or infinity.
        count: u64,
        /// Column of the first such texel.
        x: u32,
        /// Row of the first such texel.
        y: u32,
    },
}

#[cfg(test)]
mod test_files;
#[cfg(test)]
mod tests;

pub(crate) use rgba::each;
