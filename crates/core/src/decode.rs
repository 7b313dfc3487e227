//! Decoding of image files: raster formats by [`crate::image`], KTX2 by [`crate::ktx2`].

use crate::image::{self, DecodeOptions, FileFormat, Image};
use crate::ktx2::{Ktx2, ReadError};

/// Why an image could not be decoded. The caller adds the name of the file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// A raster file, or a file that is not an image.
    #[error(transparent)]
    Raster(#[from] image::DecodeError),
    /// The file is a KTX2 file that cannot be decoded.
    #[error(transparent)]
    Ktx2(#[from] ReadError),
}

impl DecodeError {
    /// Returns whether decoding may succeed when there is more memory.
    pub fn is_out_of_memory(&self) -> bool {
        match self {
            Self::Raster(error) => error.is_out_of_memory(),
            Self::Ktx2(error) => matches!(error, ReadError::OutOfMemory(_)),
        }
    }
}

/// Decodes an image file: PNG, JPEG, TIFF, TGA, WebP, Radiance HDR, EXR, or level 0 of KTX2. The first bytes of the
/// file decide on the format.
///
/// # Errors
/// [`DecodeError`]. A truncated file is an error, not a half-filled image.
pub fn decode(bytes: &[u8], options: &DecodeOptions) -> Result<Image, DecodeError> {
    if FileFormat::detect(bytes, options.extension.as_deref()) == Some(FileFormat::Ktx2) {
        return Ok(Ktx2::parse(bytes)?.with_max_texels(options.max_pixels).decode_level(0)?);
    }
    Ok(image::decode_raster(bytes, options)?)
}

/// Decodes an image whose channels are colours or packed values, not a vector. Grey rasters become colours; the two
/// channels of KTX2 and EXR files are red and green.
///
/// # Errors
/// Those of [`decode`].
pub fn decode_colours(bytes: &[u8], options: &DecodeOptions) -> Result<Image, DecodeError> {
    let image = decode(bytes, options)?;
    let has_red_and_green = FileFormat::detect(bytes, None).is_some_and(FileFormat::has_red_and_green);
    Ok(if has_red_and_green { image } else { image.with_grey_as_colour() })
}
