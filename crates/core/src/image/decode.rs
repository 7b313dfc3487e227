//! Decodes image files in memory, at the depth at which they are stored.
//!
//! Values are data, not colours: gamma, ICC profiles, EXIF orientation and sRGB tags are ignored. Bytes after the end
//! of the image are ignored, as in other readers.

use std::io::Cursor;
use std::panic;

use image::codecs::{hdr::HdrDecoder, png::PngDecoder, tga::TgaDecoder, webp::WebPDecoder};
use image::{DynamicImage, ImageDecoder, ImageError, Limits};

use crate::foreign::Foreign;
use crate::image::decoded::{Image, Samples};
use crate::image::error::DecodeError;
use crate::image::format::FileFormat;
use crate::image::size::texels;
use crate::image::{exr, jpeg, tiff};
use crate::memory;

/// What to decode, and how much at most.
#[derive(Debug, Clone)]
pub struct DecodeOptions {
    /// The most texels that an image may have. Dimensions are read from the header and compared
    /// with it before anything is allocated for them. Default: 2^28, which is 16384 x 16384.
    pub max_pixels: u64,
    /// For EXR: which layer, or which single channel as `layer.channel`. `None` takes the unnamed
    /// layer or else the first one. Default: `None`. Other formats have no layers and ignore it.
    pub layer: Option<String>,
    /// The file's extension without its dot. It only counts where the bytes have no signature,
    /// which is so for TGA. Default: `None`.
    pub extension: Option<String>,
}

impl Default for DecodeOptions {
    fn default() -> DecodeOptions {
        DecodeOptions { max_pixels: 1 << 28, layer: None, extension: None }
    }
}

/// The memory that the PNG and WebP decoders may use in addition to the image, for metadata and rows. The longest
/// RGBA16 row that fits has 2^23 texels.
const SIDE_MEMORY: u64 = 64 << 20;

/// Decodes a raster: PNG, JPEG, TIFF, TGA, WebP, Radiance HDR or EXR, by their first bytes. KTX2 files are
/// for [`crate::decode::decode`].
///
/// Palettes are looked up and 1, 2 and 4 bits become 8; apart from that each depth stays what it
/// is in the file (half floats become `f32`). A PNG with `tRNS` has alpha.
///
/// # Errors
/// See [`DecodeError`]. A truncated file is an error, not a half-filled picture.
pub fn decode_raster(bytes: &[u8], options: &DecodeOptions) -> Result<Image, DecodeError> {
    if let Some(found) = Foreign::detect(bytes) {
        return Err(DecodeError::Foreign { found });
    }
    let format =
        FileFormat::detect(bytes, options.extension.as_deref()).ok_or_else(|| DecodeError::of_no_format(bytes))?;
    // `exr` 1.74 panics on some hostile B44 blocks; no other decoder did in 10^7 changed files.
    let decoded = panic::catch_unwind(|| decode_as(format, bytes, options));
    decoded.unwrap_or_else(|_| Err(DecodeError::malformed(format, "its decoder panicked")))
}

fn decode_as(format: FileFormat, bytes: &[u8], options: &DecodeOptions) -> Result<Image, DecodeError> {
    let limit = options.max_pixels;
    let failed = |error| from_image(format, limit, error);
    match format {
        FileFormat::Png => {
            // The decoder allocates rows while it reads the header, so the header is checked first.
            if let Some(header) = PngHeader::read(bytes) {
                texels(format, header.width, header.height, limit)?;
                header.check_length(bytes.len() as u64)?;
            }
            let limits = side_limits();
            let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(failed)?;
            raster(format, decoder, limit)
        }
        FileFormat::Tga => {
            let decoder = TgaDecoder::new(Cursor::new(bytes)).map_err(failed)?;
            raster(format, decoder, limit)
        }
        FileFormat::WebP => {
            let decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(failed)?;
            raster(format, decoder, limit)
        }
        FileFormat::Hdr => {
            let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(failed)?;
            raster(format, decoder, limit)
        }
        FileFormat::Jpeg => jpeg::decode(bytes, limit),
        FileFormat::Tiff => tiff::decode(bytes, limit),
        FileFormat::Exr => exr::decode(bytes, limit, options.layer.as_deref()),
        FileFormat::Ktx2 => Err(DecodeError::unsupported(format, "a texture container")),
    }
}

/// The header of a PNG, its first chunk (PNG 3, 11.2.1).
struct PngHeader {
    width: u64,
    height: u64,
    bits_per_texel: u64,
}

impl PngHeader {
    fn read(bytes: &[u8]) -> Option<Self> {
        let side = |at: usize| Some(u32::from_be_bytes(*bytes.get(at..)?.first_chunk()?).into());
        let (depth, color) = (*bytes.get(24)?, *bytes.get(25)?);
        let channels = match color {
            2 => 3,
            4 => 2,
            6 => 4,
            _ => 1,
        };
        Some(Self { width: side(16)?, height: side(20)?, bits_per_texel: u64::from(depth) * channels })
    }

    /// Checks that a file of `length` bytes can hold the texels. One byte of deflate decodes to at most 1032 bytes
    /// (RFC 1951: a match of 258 bytes takes two bits).
    fn check_length(&self, length: u64) -> Result<(), DecodeError> {
        let row = self.width.saturating_mul(self.bits_per_texel).div_ceil(8).saturating_add(1);
        let expected = row.saturating_mul(self.height);
        if expected <= length.saturating_mul(1032) {
            return Ok(());
        }
        let what = format!("{length} bytes cannot hold {} x {} texels", self.width, self.height);
        Err(DecodeError::Truncated { format: FileFormat::Png, what })
    }
}

fn side_limits() -> Limits {
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(SIDE_MEMORY);
    limits
}

fn raster(format: FileFormat, mut decoder: impl ImageDecoder, limit: u64) -> Result<Image, DecodeError> {
    let failed = |error| from_image(format, limit, error);
    let (width, height) = decoder.dimensions();
    texels(format, width.into(), height.into(), limit)?;
    let mut limits = side_limits();
    limits.max_alloc = Some(decoder.total_bytes().saturating_add(SIDE_MEMORY));
    decoder.set_limits(limits).map_err(failed)?;
    // The WebP decoder holds planes or colour codes beside the texels.
    let copies = if format == FileFormat::WebP { 3 } else { 1 };
    memory::check(decoder.total_bytes().saturating_mul(copies))?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(failed)?;
    let channels = decoded.color().channel_count().into();
    let samples = match decoded {
        DynamicImage::ImageLuma8(image) => Samples::U8(image.into_raw()),
        DynamicImage::ImageLumaA8(image) => Samples::U8(image.into_raw()),
        DynamicImage::ImageRgb8(image) => Samples::U8(image.into_raw()),
        DynamicImage::ImageRgba8(image) => Samples::U8(image.into_raw()),
        DynamicImage::ImageLuma16(image) => Samples::U16(image.into_raw()),
        DynamicImage::ImageLumaA16(image) => Samples::U16(image.into_raw()),
        DynamicImage::ImageRgb16(image) => Samples::U16(image.into_raw()),
        DynamicImage::ImageRgba16(image) => Samples::U16(image.into_raw()),
        DynamicImage::ImageRgb32F(image) => Samples::F32(image.into_raw()),
        DynamicImage::ImageRgba32F(image) => Samples::F32(image.into_raw()),
        other => {
            let what = format!("{:?} samples", other.color());
            return Err(DecodeError::unsupported(format, what));
        }
    };
    Ok(Image { width, height, channels, samples })
}

fn from_image(format: FileFormat, limit: u64, error: ImageError) -> DecodeError {
    match error {
        ImageError::IoError(error) => DecodeError::from_io(format, &error),
        ImageError::Unsupported(error) => DecodeError::unsupported(format, error),
        ImageError::Limits(error) => {
            let what = format!("{error}, with {limit} texels allowed");
            DecodeError::unsupported(format, what)
        }
        error => match io_source(&error) {
            Some(error) => DecodeError::from_io(format, error),
            None => DecodeError::malformed(format, error),
        },
    }
}

/// Returns the reader's error that made a decoder fail, if there is one.
fn io_source(error: &ImageError) -> Option<&std::io::Error> {
    let mut source = std::error::Error::source(error);
    while let Some(error) = source {
        if let Some(error) = error.downcast_ref() {
            return Some(error);
        }
        source = error.source();
    }
    None
}

#[cfg(test)]
mod tests;
