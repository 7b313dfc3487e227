//! JPEG, baseline and progressive, grey and colour.

mod bits;
mod damage;
mod frame;
mod scan_codes;
mod scans;
#[cfg(test)]
mod tests;

use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;

use crate::image::decoded::{Image, Samples};
use crate::image::error::DecodeError;
use crate::image::format::FileFormat;
use crate::image::jpeg::damage::Damage;
use crate::image::size::texels;
use crate::memory;

const FORMAT: FileFormat = FileFormat::Jpeg;

pub(super) fn decode(bytes: &[u8], limit: u64) -> Result<Image, DecodeError> {
    // The crate's SIMD features are off in Cargo.toml: its scalar path is as fast (287 ms against 312 ms for 4096^2).
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX));
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(failed)?;
    let (width, height) = decoder
        .info()
        .map(|info| (info.width, info.height))
        .ok_or_else(|| DecodeError::malformed(FORMAT, "no frame header"))?;
    let texels = texels(FORMAT, width.into(), height.into(), limit)?;
    let (colors, channels) = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => (ColorSpace::Luma, 1),
        Some(ColorSpace::YCbCr | ColorSpace::RGB) => (ColorSpace::RGB, 3),
        other => {
            let what = format!("{other:?} instead of grey or RGB");
            return Err(DecodeError::unsupported(FORMAT, what));
        }
    };
    decoder.set_options(options.jpeg_set_out_colorspace(colors));
    // The decoder would fill missing blocks with grey without an error.
    let coefficients = scans::check(bytes).map_err(damaged)?;
    memory::check(coefficients + texels as u64 * u64::from(channels))?;
    let mut samples = vec![0; texels * channels as usize];
    if decoder.output_buffer_size() != Some(samples.len()) {
        let what = format!("{:?} samples for {width} x {height}", decoder.output_buffer_size());
        return Err(DecodeError::malformed(FORMAT, what));
    }
    decoder.decode_into(&mut samples).map_err(failed)?;
    Ok(Image { width: width.into(), height: height.into(), channels, samples: Samples::U8(samples) })
}

fn damaged(damage: Damage) -> DecodeError {
    match damage {
        Damage::OutOfMemory(error) => error.into(),
        damage if damage.is_cut() => DecodeError::Truncated { format: FORMAT, what: damage.to_string() },
        damage => DecodeError::malformed(FORMAT, damage),
    }
}

fn failed(error: DecodeErrors) -> DecodeError {
    match error {
        DecodeErrors::Unsupported(what) => DecodeError::unsupported(FORMAT, format!("{what:?}")),
        error => DecodeError::malformed(FORMAT, error),
    }
}
