//! The texels of one level as rows of values, and their quantisation.

use fearless_simd::Level;
use half::f16;
use rayon::prelude::*;

use crate::codec::error::EncodeError;
use crate::codec::uastc::Lobe;
use crate::simd::dispatch;

/// Writes the lobes about the normals of row y of a level: `(y, out)`.
pub type RowOfLobes<'a> = dyn Fn(u32, &mut [Lobe]) + Sync + 'a;

/// The texels of one level, produced row by row.
pub struct Texels<'a> {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Writes row `y` (0 is the top) to a slice of `width` texels; unused channels are ignored.
    pub row: &'a (dyn Fn(u32, &mut [[f32; 4]]) + Sync),
    /// Writes the lobes about the normals of row `y` to a slice of `width` lobes; `None` if the texels are no normals,
    /// or if their lobes are not known. The encoder of UASTC chooses blocks of normals by what they do to these lobes.
    pub lobes: Option<&'a RowOfLobes<'a>>,
}

impl Texels<'_> {
    /// Returns the texels as RGBA8, which is opaque unless they have alpha. Values are clamped to [0, 1] and rounded to
    /// the nearest step, ties to even.
    pub fn to_rgba8(&self, has_alpha: bool) -> Vec<u8> {
        self.convert(4, |texels, out: &mut [u8]| {
            dispatch!(Level::new(), _simd => unorm8_row(texels, has_alpha, out));
        })
    }

    /// Returns the first `channels` channels as half floats. A fourth channel is 1.
    ///
    /// # Errors
    /// [`EncodeError::NotFinite`]: Roughcast writes neither infinities nor NaN.
    pub(super) fn to_half(&self, channels: usize) -> Result<Vec<u8>, EncodeError> {
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

/// Returns the nearest of 256 steps from 0 to 1, ties to even. NaN counts as 0.
#[inline(always)]
#[expect(clippy::manual_clamp, reason = "`clamp` keeps NaN")]
fn unorm8(value: f32) -> u8 {
    // Floats from 2^23 on are whole numbers, so the sum is rounded and its last bits are the step. A cast would do the
    // same, but compilers do not vectorise it.
    const WHOLE: f32 = (1 << 23) as f32;
    (value.max(0.0).min(1.0) * 255.0 + WHOLE).to_bits() as u8
}

/// Writes texels as RGBA8, which is opaque unless they have alpha.
#[inline(always)]
pub(super) fn unorm8_row(texels: &[[f32; 4]], has_alpha: bool, out: &mut [u8]) {
    for (byte, value) in out.iter_mut().zip(texels.as_flattened()) {
        *byte = unorm8(*value);
    }
    if !has_alpha {
        for texel in out.as_chunks_mut::<4>().0 {
            texel[3] = 255;
        }
    }
}

#[cfg(test)]
mod tests;
