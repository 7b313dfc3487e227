//! From rows of values to the bytes of one level.

use fearless_simd::Level;
use rayon::prelude::*;

use crate::codec::format::{Format, Target};
use crate::codec::texels::{EncodeError, Texels, unorm8_row};
use crate::codec::uastc;
use crate::codec::uastc::{BLOCK_BYTES, Effort, Encoder, Image, Metric, SizeError, Weight};
use crate::simd::dispatch;

/// The metric of textures with occlusion, roughness and metalness in red, green and blue. Lobes depend on roughness, so
/// a difference of the other two counts as one of roughness that is a quarter as large. (On the materials of
/// FlightHelmet roughness gains 5.5 dB, occlusion loses 6 dB and lobe errors fall by up to 0.035.)
pub const ORM: Metric = Metric::Weighted([Weight::Quarter, Weight::Full, Weight::Quarter]);

/// The bytes of one level, not supercompressed. UASTC is fitted by `metric`, which other encoders do not know.
///
/// # Errors
/// [`EncodeError`] for block formats whose encoder is missing or fails, and for values that half floats do not hold.
pub fn encode(texels: &Texels<'_>, format: Format, metric: Metric, effort: Effort) -> Result<Vec<u8>, EncodeError> {
    match format {
        Format::UastcRgb => encode_uastc(texels, metric, effort).map_err(|e| texels.refused(&e)),
        Format::R16Float => texels.to_half(1),
        Format::Rg16Float => texels.to_half(2),
        Format::Rgba16Float => texels.to_half(4),
        #[cfg(feature = "bc")]
        Format::Bc4 | Format::Bc5 | Format::Bc7 => crate::codec::bc::encode(texels, format, effort),
        #[cfg(not(feature = "bc"))]
        Format::Bc4 | Format::Bc5 | Format::Bc7 => Err(EncodeError::WithoutBc),
    }
}

/// Quantises and encodes row of blocks by row of blocks, so that a level is never held as RGBA8.
fn encode_uastc(texels: &Texels<'_>, metric: Metric, effort: Effort) -> Result<Vec<u8>, SizeError> {
    let (encoder, instructions) = (Encoder::new(metric, effort), Level::new());
    let width = texels.width as usize;
    let columns = width.div_ceil(4);
    let mut blocks = vec![[0; BLOCK_BYTES]; columns * texels.height.div_ceil(4) as usize];
    blocks.par_chunks_mut(columns).enumerate().try_for_each_init(
        || (vec![[0.0; 4]; width], vec![[0; 4]; 4 * width]),
        |(values, rgba), (block_row, blocks)| {
            let first = 4 * block_row as u32;
            for (y, line) in rgba.chunks_exact_mut(width).enumerate() {
                // The last row is repeated.
                (texels.row)((first + y as u32).min(texels.height - 1), values);
                dispatch!(instructions, _simd => unorm8_row(values, line.as_flattened_mut()));
            }
            encoder.encode_rows(std::array::from_fn(|y| &rgba[width * y..width * (y + 1)]), blocks)
        },
    )?;
    Ok(blocks.into_flattened())
}

/// Makes the UASTC `blocks` of `texels` smaller after zstd, as [`uastc::lower_rate`] does: neither error grows by as
/// much as `loss` dB. The level is held as RGBA8 meanwhile.
///
/// # Errors
/// [`EncodeError::Encoder`] if `blocks` are not those of a level of that size.
pub fn lower_rate(blocks: &mut [u8], texels: &Texels<'_>, metric: Metric, loss: f64) -> Result<(), EncodeError> {
    let rgba = texels.to_rgba8();
    let image = Image::new(&rgba, texels.width, texels.height).map_err(|e| texels.refused(&e))?;
    let blocks = blocks.as_chunks_mut::<BLOCK_BYTES>().0;
    uastc::lower_rate(blocks, &image, metric, loss).map_err(|e| texels.refused(&e))
}

impl Target {
    /// Whether this build can encode the target.
    ///
    /// # Errors
    /// [`EncodeError::WithoutBc`] for `bc` without the feature.
    pub fn check_available(self) -> Result<(), EncodeError> {
        if self == Self::Bc && !cfg!(feature = "bc") { Err(EncodeError::WithoutBc) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use half::f16;

    use super::*;

    #[test]
    fn halves_keep_the_sign_and_fill_alpha() {
        let texels = Texels { width: 1, height: 1, row: &|_, out| out[0] = [-1.5, 2.0, 0.25, 9.0] };
        let bytes = encode(&texels, Format::Rgba16Float, Metric::Rgb, Effort::Fast).unwrap();
        let halves: Vec<f32> = bytes.chunks(2).map(|b| f16::from_le_bytes([b[0], b[1]]).to_f32()).collect();
        assert_eq!(halves, [-1.5, 2.0, 0.25, 1.0]);
        assert_eq!(encode(&texels, Format::Rg16Float, Metric::Rgb, Effort::Fast).unwrap(), bytes[..4]);
        assert_eq!(encode(&texels, Format::R16Float, Metric::Rgb, Effort::Fast).unwrap(), bytes[..2]);
    }

    #[test]
    fn halves_are_finite_or_an_error() {
        for value in [f32::NAN, f32::INFINITY, -1e5] {
            let texels = Texels { width: 1, height: 1, row: &|_, out| out[0] = [0.0, value, 0.0, 0.0] };
            let found = encode(&texels, Format::Rg16Float, Metric::Rgb, Effort::Fast);
            assert_eq!(found, Err(EncodeError::NotFinite { width: 1, height: 1 }));
            assert!(encode(&texels, Format::R16Float, Metric::Rgb, Effort::Fast).is_ok());
        }
    }

    #[test]
    fn every_format_fills_its_blocks() {
        let texels = Texels { width: 5, height: 3, row: &|y, out| out.fill([0.1 * y as f32; 4]) };
        for target in [Target::Basis, Target::Bc, Target::Float] {
            for channels in 1..=3 {
                let format = target.format(channels);
                match encode(&texels, format, Metric::Rgb, Effort::Fast) {
                    Ok(bytes) => assert_eq!(bytes.len(), format.level_bytes(5, 3), "{format:?}"),
                    Err(e) => assert!(!cfg!(feature = "bc") && e == EncodeError::WithoutBc, "{e}"),
                }
            }
        }
    }
}
