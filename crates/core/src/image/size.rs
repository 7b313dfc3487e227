//! The bound on the size of an image, which is checked before anything is allocated.

use crate::image::error::DecodeError;
use crate::image::format::FileFormat;

/// Returns the number of texels of an image whose dimensions are allowed.
///
/// # Errors
/// Returns [`DecodeError::Malformed`] for an image without texels, and [`DecodeError::TooLarge`] for an image of more
/// than `limit` texels.
pub(super) fn texels(format: FileFormat, width: u64, height: u64, limit: u64) -> Result<usize, DecodeError> {
    if width == 0 || height == 0 {
        let what = format!("{width} x {height} texels");
        return Err(DecodeError::malformed(format, what));
    }
    let too_large = DecodeError::TooLarge { width, height, limit };
    let texels = width.checked_mul(height).filter(|&t| t <= limit);
    texels.and_then(|t| usize::try_from(t).ok()).ok_or(too_large)
}
