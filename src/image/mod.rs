//! Decoded images, and the decoders of rasters from PNG to OpenEXR. This module knows nothing of glTF.

mod decode;
mod decoded;
mod error;
mod exr;
mod format;
mod jpeg;
mod size;
mod texels;
mod tiff;

pub use decode::{DecodeOptions, decode_raster};
pub use error::DecodeError;
pub use format::Format;

pub use decoded::{Image, Samples};

pub use texels::Rgba;

/// Why an image cannot serve as the map that it is meant to be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MapError {
    /// Too few channels.
    #[error(
        "expected {expected}, found an image of {found} channel(s); use a map that has them, or read it as heights"
    )]
    Channels {
        /// What the map needs.
        expected: &'static str,
        /// Channels of the image.
        found: u32,
    },
    /// NaN or infinity.
    #[error(
        "expected finite values, found NaN or infinity in {count} texel(s), the first at column {x}, row {y}; repair the map or export it again"
    )]
    NotFinite {
        /// How many texels.
        count: u64,
        /// Column of the first.
        x: u32,
        /// Row of the first.
        y: u32,
    },
}

#[cfg(test)]
mod decode_tests;
#[cfg(test)]
mod exr_tests;
#[cfg(test)]
mod hostile_tests;
#[cfg(test)]
mod test_files;

pub(crate) use texels::each;
