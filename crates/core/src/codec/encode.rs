//! Encodes rows of values to the bytes of one level.

use fearless_simd::Level;
use rayon::prelude::*;

use crate::codec::error::EncodeError;
use crate::codec::format::PayloadFormat;
use crate::codec::quantise::{Texels, unorm8_row};
use crate::codec::uastc;
use crate::codec::uastc::{BLOCK_BYTES, Effort, Encoder, Image, Lobe, Metric, SizeError, Weight};
use crate::simd::dispatch;

/// The metric of textures with occlusion, roughness and metalness in red, green and blue. Lobes depend on roughness, so
/// differences of occlusion have a quarter of the weight: on the materials of FlightHelmet roughness gains 5.5 dB,
/// occlusion loses 6 dB and lobe errors fall by up to 0.035. Differences of metalness have half of the weight. With a
/// quarter, paint beside metal was further from the truth than with plain mips: 0.01 of metalness adds a seventh to the
/// light that a dielectric of base colour 0.6 reflects. With full weight, rusty metal is 1.44 times closer in three.js
/// instead of 1.48 (docs/engines.md, "Under many lights").
pub const ORM: Metric = Metric::Weighted([Weight::Quarter, Weight::Full, Weight::Half]);

/// Returns the UASTC blocks of a level. A row of blocks is quantised and encoded at a time, so that a level is never
/// held as RGBA8.
///
/// # Errors
/// [`EncodeError::Encoder`].
pub(super) fn uastc_blocks(
    texels: &Texels<'_>,
    format: PayloadFormat,
    metric: Metric,
    effort: Effort,
) -> Result<Vec<u8>, EncodeError> {
    let (encoder, instructions) = (Encoder::new(metric, effort), Level::new());
    let width = texels.width as usize;
    let columns = width.div_ceil(4);
    let mut blocks = vec![[0; BLOCK_BYTES]; columns * texels.height.div_ceil(4) as usize];
    let encode_row = |buffers: &mut RowBuffers, block_row: usize, blocks: &mut [[u8; 16]]| {
        let RowBuffers { values, rgba, lobes } = buffers;
        let first = 4 * block_row as u32;
        for (i, line) in rgba.chunks_exact_mut(width).enumerate() {
            // Blocks below the last row repeat it.
            let y = (first + i as u32).min(texels.height - 1);
            (texels.row)(y, values);
            dispatch!(instructions, _simd => unorm8_row(values, format.has_alpha(), line.as_flattened_mut()));
            if let Some(row) = texels.lobes {
                row(y, &mut lobes[width * i..width * (i + 1)]);
            }
        }
        let rows = std::array::from_fn(|i| &rgba[width * i..width * (i + 1)]);
        match texels.lobes {
            None => encoder.encode_rows(rows, blocks),
            Some(_) => {
                let lobes = std::array::from_fn(|i| &lobes[width * i..width * (i + 1)]);
                encoder.encode_rows_with_lobes(rows, lobes, blocks)
            }
        }
    };
    let encoded: Result<(), SizeError> = blocks.par_chunks_mut(columns).enumerate().try_for_each_init(
        || RowBuffers::new(width, texels.lobes.is_some()),
        |buffers, (block_row, blocks)| encode_row(buffers, block_row, blocks),
    );
    encoded.map_err(|e| refused(texels, &e))?;
    Ok(blocks.into_flattened())
}

/// What a row of blocks is encoded from.
struct RowBuffers {
    /// The values of one row of texels.
    values: Vec<[f32; 4]>,
    /// Four rows of texels.
    rgba: Vec<[u8; 4]>,
    /// Four rows of lobes; empty if they are not known.
    lobes: Vec<Lobe>,
}

impl RowBuffers {
    fn new(width: usize, has_lobes: bool) -> Self {
        let lobes = if has_lobes { 4 * width } else { 0 };
        Self { values: vec![[0.0; 4]; width], rgba: vec![[0; 4]; 4 * width], lobes: vec![Lobe::isotropic(1.0); lobes] }
    }
}

/// Returns the error for a level whose size the encoder of UASTC refuses.
fn refused(texels: &Texels<'_>, error: &SizeError) -> EncodeError {
    let &Texels { width, height, .. } = texels;
    EncodeError::Encoder { format: PayloadFormat::UastcRgb, width, height, reason: error.to_string() }
}

/// Returns the first `N` channels of the texels as half floats.
///
/// # Errors
/// [`EncodeError::NotFinite`].
pub(super) fn half<const N: usize>(
    texels: &Texels<'_>,
    _: PayloadFormat,
    _: Metric,
    _: Effort,
) -> Result<Vec<u8>, EncodeError> {
    texels.to_half(N)
}

/// Returns the BC blocks of a level.
///
/// # Errors
/// [`EncodeError::Encoder`] if the encoder fails.
#[cfg(feature = "bc")]
pub(super) fn bc(
    texels: &Texels<'_>,
    format: PayloadFormat,
    _: Metric,
    effort: Effort,
) -> Result<Vec<u8>, EncodeError> {
    crate::codec::bc::encode(texels, format, effort)
}

/// Refuses to encode BC blocks in a build without their encoder.
///
/// # Errors
/// [`EncodeError::WithoutBc`].
#[cfg(not(feature = "bc"))]
pub(super) fn bc(_: &Texels<'_>, _: PayloadFormat, _: Metric, _: Effort) -> Result<Vec<u8>, EncodeError> {
    Err(EncodeError::WithoutBc)
}

/// Rewrites the UASTC `blocks` of `texels` so that zstd makes them smaller, as [`uastc::lower_rate`] does: neither
/// error grows by as much as `loss` dB. Errors of normals are those of directions, also if their lobes are known. The
/// level is held as RGBA8 meanwhile.
///
/// # Errors
/// [`EncodeError::Encoder`] if `blocks` are not those of a level of that size.
pub fn lower_rate(blocks: &mut [u8], texels: &Texels<'_>, metric: Metric, loss: f64) -> Result<(), EncodeError> {
    // Only opaque blocks are rewritten.
    let rgba = texels.to_rgba8(false);
    let image = Image::new(&rgba, texels.width, texels.height).map_err(|e| refused(texels, &e))?;
    let blocks = blocks.as_chunks_mut::<BLOCK_BYTES>().0;
    uastc::lower_rate(blocks, &image, metric, loss).map_err(|e| refused(texels, &e))
}
