//! TIFF: 8- and 16-bit integers, 16-, 32- and 64-bit floats, in strips or tiles, planar or not.

use std::io::Cursor;

use ::tiff::decoder::{Decoder, DecodingResult, Limits};
use ::tiff::{ColorType, TiffError};

use crate::image::decoded::{Image, Samples};
use crate::image::error::DecodeError;
use crate::image::format::FileFormat;
use crate::image::size::texels;
use crate::memory;

const FORMAT: FileFormat = FileFormat::Tiff;

pub(super) fn decode(bytes: &[u8], limit: u64) -> Result<Image, DecodeError> {
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(failed)?;
    let (width, height) = decoder.dimensions().map_err(failed)?;
    let texels = texels(FORMAT, width.into(), height.into(), limit)?;
    let color = decoder.colortype().map_err(failed)?;
    let channels = match color {
        ColorType::Gray(8 | 16 | 32 | 64) => 1,
        ColorType::GrayA(8 | 16 | 32 | 64) => 2,
        ColorType::RGB(8 | 16 | 32 | 64) => 3,
        ColorType::RGBA(8 | 16 | 32 | 64) => 4,
        ColorType::Multiband { bit_depth: 8 | 16 | 32 | 64, num_samples: channels @ 1..=4 } => usize::from(channels),
        other => return Err(DecodeError::unsupported(FORMAT, format!("{other:?}"))),
    };
    let mut limits = Limits::default();
    // 8 bytes is the widest sample that is read.
    limits.decoding_buffer_size = texels.saturating_mul(channels * 8);
    limits.intermediate_buffer_size = limits.decoding_buffer_size.max(1 << 20);
    let mut decoder = decoder.with_limits(limits);
    let samples = texels as u64 * channels as u64;
    memory::check(samples * u64::from(color.bit_depth() / 8))?;
    let mut values = DecodingResult::U8(Vec::new());
    let layout = decoder.read_image_to_buffer(&mut values).map_err(failed)?;
    let planar = layout.planes > 1;
    // Conversion and interleaving hold the samples twice for a while.
    match values {
        DecodingResult::F16(_) | DecodingResult::F64(_) => memory::check(4 * samples)?,
        _ if planar => memory::check(samples * u64::from(color.bit_depth() / 8))?,
        _ => {}
    }
    let samples = match values {
        DecodingResult::U8(values) => interleave(values, channels, planar).map(Samples::U8),
        DecodingResult::U16(values) => interleave(values, channels, planar).map(Samples::U16),
        DecodingResult::F16(values) => {
            let values = values.iter().map(|v| v.to_f32()).collect();
            interleave(values, channels, planar).map(Samples::F32)
        }
        DecodingResult::F32(values) => interleave(values, channels, planar).map(Samples::F32),
        DecodingResult::F64(values) => {
            let values = values.iter().map(|&v| v as f32).collect();
            interleave(values, channels, planar).map(Samples::F32)
        }
        _ => {
            let what = format!("{color:?} as signed or 32-bit integers");
            return Err(DecodeError::unsupported(FORMAT, what));
        }
    };
    samples
        .filter(|samples| samples.len() == texels * channels)
        .map(|samples| Image { width, height, channels: channels as u32, samples })
        .ok_or_else(|| DecodeError::malformed(FORMAT, "strips or tiles do not fill the image"))
}

/// Interleaves the channels of planar images.
fn interleave<T: Copy>(values: Vec<T>, channels: usize, planar: bool) -> Option<Vec<T>> {
    if !planar {
        return Some(values);
    }
    let texels = values.len() / channels;
    let at = |index: usize| values.get((index % channels) * texels + index / channels);
    (0..texels * channels).map(|i| at(i).copied()).collect()
}

fn failed(error: TiffError) -> DecodeError {
    match error {
        TiffError::IoError(error) => DecodeError::from_io(FORMAT, &error),
        TiffError::UnsupportedError(error) => DecodeError::unsupported(FORMAT, error),
        error => DecodeError::malformed(FORMAT, error),
    }
}
