//! Formats of files that change bumps more than rounding to 8 bits does.

use std::io::Cursor;

use image_webp::WebPDecoder;
use ktx2::SupercompressionScheme;

use crate::image::FileFormat;
use crate::ktx2::Ktx2;

/// Returns what a file of a bump map is, with its article, if its compression changes the bumps: JPEG, lossy WebP, and
/// KTX2 with blocks whose endpoints have 5 or 6 bits. UASTC, BC5 and BC7 are finer.
pub fn lossy_format(file: &[u8]) -> Option<&'static str> {
    match FileFormat::detect(file, None)? {
        FileFormat::Jpeg => Some("a JPEG"),
        FileFormat::WebP => {
            let is_lossy = WebPDecoder::new(Cursor::new(file)).is_ok_and(|mut decoder| decoder.is_lossy());
            is_lossy.then_some("a lossy WebP")
        }
        FileFormat::Ktx2 => {
            let file = Ktx2::parse(file).ok()?;
            if file.header().supercompression_scheme == Some(SupercompressionScheme::BasisLZ) {
                return Some("an ETC1S KTX2");
            }
            let format = file.format_name();
            ["BC1_", "BC2_", "BC3_"].iter().any(|coarse| format.starts_with(coarse)).then_some("a BC1, BC2 or BC3 KTX2")
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests;
