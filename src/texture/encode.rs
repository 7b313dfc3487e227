//! From rows of values to the bytes of one level.

use fearless_simd::Level;
use half::f16;
use rayon::prelude::*;

use super::uastc::{self, BLOCK_BYTES, Effort, Encoder, Image, Metric, SizeError, Weight};
use super::{Format, Target};
use crate::memory::OutOfMemory;
use crate::simd::dispatch;

/// The metric of textures with occlusion, roughness and metalness in red, green and blue. Lobes depend on roughness, so
/// a difference of the other two counts as one of roughness that is a quarter as large. (On the materials of
/// FlightHelmet roughness gains 5.5 dB, occlusion loses 6 dB and lobe errors fall by up to 0.035.)
pub const ORM: Metric = Metric::Weighted([Weight::Quarter, Weight::Full, Weight::Quarter]);

/// Why a level cannot be encoded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EncodeError {
    /// The `bc` feature is off.
    #[error(
        "target `bc` needs the block encoders of cargo feature `bc`, found a build without it; install with `--features bc`"
    )]
    WithoutBc,
    /// The block encoder refused.
    #[error("the {format:?} encoder failed on a level of {width} x {height}: {reason}; try another target")]
    Encoder {
        /// What was to be written.
        format: Format,
        /// Columns of the level.
        width: u32,
        /// Rows of the level.
        height: u32,
        /// What the encoder said.
        reason: String,
    },
    /// There is no memory for a level.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    /// Values that half floats do not hold.
    #[error(
        "expected values that half floats hold in a level of {width} x {height}, found some beyond +-65504, or NaN; \
         use `--target basis`"
    )]
    NotFinite {
        /// Columns of the level.
        width: u32,
        /// Rows of the level.
        height: u32,
    },
    /// The PNG encoder refused.
    #[error("the PNG of a level of {width} x {height} cannot be written: {reason}; leave it out with `--gltf strict`")]
    Png {
        /// Columns of the level.
        width: u32,
        /// Rows of the level.
        height: u32,
        /// What the encoder said.
        reason: String,
    },
}

/// The texels of one level, produced row by row.
pub struct Texels<'a> {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Writes row `y` (0 is the top) to a slice of `width` texels; unused channels are ignored.
    pub row: &'a (dyn Fn(u32, &mut [[f32; 4]]) + Sync),
}

impl Texels<'_> {
    /// Opaque RGBA8: values are clamped to [0, 1] and rounded to the nearest step, to the even one of two.
    pub fn to_rgba8(&self) -> Vec<u8> {
        self.convert(4, |texels, out: &mut [u8]| {
            dispatch!(Level::new(), _simd => unorm8_row(texels, out));
        })
    }

    fn refused(&self, error: &SizeError) -> EncodeError {
        let (width, height) = (self.width, self.height);
        EncodeError::Encoder { format: Format::UastcRgb, width, height, reason: error.to_string() }
    }

    /// # Errors
    /// [`EncodeError::NotFinite`]: no file of ours holds infinities or NaN.
    fn to_half(&self, channels: usize) -> Result<Vec<u8>, EncodeError> {
        let halves = self.convert(channels, |texels, out: &mut [f16]| {
            for (texel, out) in texels.iter().zip(out.chunks_exact_mut(channels)) {
                for (half, value) in out.iter_mut().zip(texel) {
                    *half = f16::from_f32(*value);
                }
                if let Some(alpha) = out.get_mut(3) {
                    *alpha = f16::ONE;
                }
            }
        });
        if halves.par_iter().any(|half| !half.is_finite()) {
            return Err(EncodeError::NotFinite { width: self.width, height: self.height });
        }
        Ok(halves.iter().flat_map(|h| h.to_le_bytes()).collect())
    }

    fn convert<T: Clone + Default + Send>(
        &self,
        channels: usize,
        quantise: impl Fn(&[[f32; 4]], &mut [T]) + Sync,
    ) -> Vec<T> {
        let width = self.width as usize;
        let mut out = vec![T::default(); width * self.height as usize * channels];
        out.par_chunks_mut(width * channels).enumerate().for_each_init(
            || vec![[0.0; 4]; width],
            |texels, (y, out)| {
                (self.row)(y as u32, texels);
                quantise(texels, out);
            },
        );
        out
    }
}

/// The nearest of 256 steps from 0 to 1, the even one of two; NaN counts as 0.
#[inline(always)]
#[expect(clippy::manual_clamp, reason = "`clamp` keeps NaN")]
fn unorm8(value: f32) -> u8 {
    // From here on floats are whole numbers, which their last bits count. (Casts keep compilers from vectors.)
    const WHOLE: f32 = (1 << 23) as f32;
    (value.max(0.0).min(1.0) * 255.0 + WHOLE).to_bits() as u8
}

/// Texels as opaque RGBA8.
#[inline(always)]
fn unorm8_row(texels: &[[f32; 4]], out: &mut [u8]) {
    for (byte, value) in out.iter_mut().zip(texels.as_flattened()) {
        *byte = unorm8(*value);
    }
    for texel in out.as_chunks_mut::<4>().0 {
        texel[3] = 255;
    }
}

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
        Format::Bc4 | Format::Bc5 | Format::Bc7 => super::bc::encode(texels, format, effort),
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
    use super::*;

    #[test]
    fn bytes_round_to_the_nearest_step_and_clamp() {
        let values = [-0.5, 0.0, 0.4999 / 255.0, 0.5001 / 255.0, 1.0, 7.0, f32::NAN];
        assert_eq!(values.map(unorm8), [0, 0, 0, 1, 255, 255, 0]);
        // 127.5 steps.
        assert_eq!(unorm8(0.5), 128);
        for step in 0..255u8 {
            let at = |fraction: f32| unorm8((f32::from(step) + fraction) / 255.0);
            assert_eq!([at(0.0), at(0.499), at(0.501)], [step, step, step + 1]);
        }
    }

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
