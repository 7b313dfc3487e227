//! Encodes PNG files of 8 bits: fallbacks and the sheets of `render`.

use std::io::Write;

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, Filter};

use crate::codec::error::EncodeError;
use crate::codec::quantise::Texels;
use crate::codec::uastc::Effort;

/// Number of rows that are made at a time, in parallel. For a map of 16384^2 texels they take 50 MB, with the values
/// that they are made from.
const BAND: u32 = 64;

/// Number of bytes of a chunk of the file.
const CHUNK: usize = 1 << 20;

/// Encodes a level as a PNG, which is opaque unless the level has alpha. The rows of the level are never all held at
/// once.
///
/// # Errors
/// [`EncodeError::Png`].
pub fn fallback(texels: &Texels<'_>, has_alpha: bool, effort: Effort) -> Result<Vec<u8>, EncodeError> {
    let &Texels { width, height, row, .. } = texels;
    let bands = (0..height).step_by(BAND as usize).map(|first| {
        let row = |y: u32, out: &mut [[f32; 4]]| row(first + y, out);
        Texels { width, height: BAND.min(height - first), row: &row, lobes: None }.to_rgba8(has_alpha)
    });
    encode(bands, (width, height), has_alpha, effort).map_err(|error| EncodeError::Png {
        width,
        height,
        reason: error.to_string(),
    })
}

/// Encodes opaque RGBA8 texels as a PNG.
///
/// # Errors
/// The message of the encoder.
pub fn encode_png(rgba: &[u8], width: u32, height: u32, effort: Effort) -> Result<Vec<u8>, String> {
    encode([rgba], (width, height), false, effort).map_err(|error| error.to_string())
}

/// Encodes bands of RGBA8 texels, as RGB unless they have alpha. For a 4096^2 normal and roughness map zlib's default
/// effort takes 7.8 CPU seconds, about as long as the rest of the bake; its fast effort takes 1.1 s, and files are an
/// eighth larger.
fn encode(
    bands: impl IntoIterator<Item = impl AsRef<[u8]>>,
    (width, height): (u32, u32),
    has_alpha: bool,
    effort: Effort,
) -> Result<Vec<u8>, EncodingError> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_color(if has_alpha { ColorType::Rgba } else { ColorType::Rgb });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(match effort {
        Effort::Fast => Compression::Fast,
        Effort::Best => Compression::Balanced,
    });
    encoder.set_filter(Filter::Adaptive);
    let mut encoder = encoder.write_header()?;
    let mut writer = encoder.stream_writer_with_size(CHUNK)?;
    for band in bands {
        if has_alpha {
            writer.write_all(band.as_ref())?;
            continue;
        }
        let rgb: Vec<u8> = band.as_ref().as_chunks::<4>().0.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        writer.write_all(&rgb)?;
    }
    writer.finish()?;
    encoder.finish()?;
    Ok(file)
}
