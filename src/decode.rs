//! Decoding image files of every format that is read: rasters by [`crate::image`], textures by [`crate::ktx2`].

use crate::image::{self, DecodeOptions, Format, Image};
use crate::ktx2::{Ktx2, ReadError};

/// Why an image could not be decoded. The caller adds the file's name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// A raster, or no image at all.
    #[error(transparent)]
    Raster(#[from] image::DecodeError),
    /// A KTX2 file.
    #[error(transparent)]
    Ktx2(#[from] ReadError),
}

impl DecodeError {
    /// Returns whether the image may be decoded when there is more memory.
    pub fn is_out_of_memory(&self) -> bool {
        match self {
            Self::Raster(error) => error.is_out_of_memory(),
            Self::Ktx2(error) => matches!(error, ReadError::OutOfMemory(_)),
        }
    }
}

/// Decodes an image file: PNG, JPEG, TIFF, TGA, WebP, Radiance HDR, EXR, or KTX2 (its level 0), told apart by their first bytes.
///
/// # Errors
/// [`DecodeError`]. A truncated file is an error, not a half-filled picture.
pub fn decode(bytes: &[u8], options: &DecodeOptions) -> Result<Image, DecodeError> {
    if Format::detect(bytes, options.extension.as_deref()) == Some(Format::Ktx2) {
        return Ok(Ktx2::parse(bytes)?.with_max_texels(options.max_pixels).decode_level(0)?);
    }
    Ok(image::decode_raster(bytes, options)?)
}

/// Decodes an image whose channels are colours or packed values, not a vector.
///
/// # Errors
/// Those of [`decode`].
pub fn decode_colours(bytes: &[u8], options: &DecodeOptions) -> Result<Image, DecodeError> {
    let image = decode(bytes, options)?;
    let is_red_green = matches!(Format::detect(bytes, None), Some(Format::Ktx2 | Format::Exr));
    Ok(if is_red_green { image } else { image.with_grey_as_colour() })
}
