//! Bounds of the error that a texture format itself adds between encoded and decoded texels.
//!
//! Values are shares of the range between texels of 0 and 1. An error has two parts.
//!
//! *Rounding*: block encoders read channels of 8 bits (half a step is 1/510), and the endpoints of a block have a
//! number of levels (half of the distance between two levels).
//!
//! *Residual*: a texel takes the nearest of the colours between the endpoints; there are as many colours as weights
//! have values. Rounding to steps of s has a root mean square error of s / sqrt 12. Channels that share a weight lie on
//! a line. An encoder takes the line along which the channels vary most, so that at most (n - 1) / n of the variance of
//! n channels remains as error. Texels are assumed to be uniform between the extremes of their block; with extremes d
//! apart, their variance is d^2 / 12. An encoder takes the best mode of a format, which is at least as good as the mode
//! assumed here:
//!
//! - Two planes of weights with k steps (UASTC): with one or two channels each channel has its own plane: s = d / k.
//!   With three channels, the channel that varies most has a plane, and the other two share the second plane.
//! - Weights with k steps for every channel (BC4 and BC5): s = d / k.
//! - One weight for all channels (BC7): the bound above for n channels.
//!
//! Half floats have 11 bits: their error is at most 2^-11 of the value, or 2^-25 for small values. Integer formats
//! without blocks have an error of half a step. The table of `codec` names the endpoints and the weights of each format
//! that Roughcast writes.
//!
//! Blocks that `--rdo` has rewritten lose at most the requested number of dB, which multiplies the error.

use crate::codec::{Codec, Endpoints, Rounding, Weights};
use crate::image::{Image, Rgba, Samples};
use crate::ktx2::{Ktx2, ReadError, provenance};
use crate::mip::TexelRows;

/// Largest rounding error of 8 bits.
const BYTE: f64 = 0.5 / 255.0;

/// Half of the smallest step of half floats.
const HALF_STEP: f64 = 1.0 / (1 << 25) as f64;

/// Largest loss that `--rdo` accepts, in dB. Assumed for textures without provenance.
const MOST_LOSS: f64 = 6.0;

/// Blocks that Roughcast does not write, with endpoints of 5 bits at worst: BC1 to BC3 and ETC1S.
const OTHER_BLOCKS: Rounding = Rounding::Blocks { endpoints: Endpoints::Levels(32.0), weights: Weights::Shared };

/// A decoded level and the bounds of its storage error.
pub struct Storage {
    image: Image,
    rounding: Rounding,
    /// Largest rounding of each block, or one value for all texels if the format has no blocks.
    roundings: Vec<f64>,
    /// Factor by which `--rdo` multiplies errors.
    loss: f64,
}

impl Storage {
    /// Decodes a level of `file`.
    ///
    /// # Errors
    /// Those of [`Ktx2::decode_level`].
    pub fn decode(file: &Ktx2<'_>, level: u32) -> Result<Self, ReadError> {
        let image = file.decode_level(level)?;
        let codec = Codec::of_file(file.header().format, file.descriptor().and_then(|basic| basic.color_model));
        let rounding = codec.map_or_else(|| other_rounding(file, &image), |codec| codec.rounding);
        let of_endpoints = |levels: f64| BYTE + 0.5 / (levels - 1.0);
        let roundings = match (rounding, &image.samples) {
            (Rounding::Blocks { endpoints: Endpoints::ByMode(levels), .. }, _) => {
                let payload = file.level_bytes(level)?;
                payload.as_chunks::<16>().0.iter().map(|block| of_endpoints(levels(block))).collect()
            }
            (Rounding::Blocks { endpoints: Endpoints::Levels(levels), .. }, _) => vec![of_endpoints(levels)],
            (Rounding::Integers, Samples::U16(_)) => vec![0.5 / 65535.0],
            (Rounding::Integers, _) => vec![BYTE],
            (Rounding::Floats, _) => vec![1.0 / 2048.0],
        };
        let loss = match provenance(file) {
            Some(found) => found.settings["rdo"].as_f64().unwrap_or(0.0).clamp(0.0, MOST_LOSS),
            None => MOST_LOSS,
        };
        let is_rewritten = codec.is_some_and(|codec| codec.lower_rate.is_some());
        let loss = if is_rewritten { 10_f64.powf(loss / 20.0) } else { 1.0 };
        Ok(Self { image, rounding, roundings, loss })
    }

    /// Returns the decoded level.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Returns whether channels of a block share weights.
    pub fn has_shared_weights(&self) -> bool {
        matches!(self.rounding, Rounding::Blocks { weights: Weights::TwoPlanes { .. } | Weights::Shared, .. })
    }

    /// Calls `visit` for each block, or for each texel if the format has no blocks. The arguments are the first `N`
    /// channels of the texels, and the largest rounding of each of these channels.
    pub fn visit<const N: usize>(&self, mut visit: impl FnMut(&[[f64; N]], [f64; N])) {
        let (width, height) = (self.image.width as usize, self.image.height);
        let edge = if matches!(self.rounding, Rounding::Blocks { .. }) { 4 } else { 1 };
        let source = Rgba(&self.image);
        let mut rows = vec![vec![[0.0; 4]; width]; edge];
        let mut texels: Vec<[f64; N]> = Vec::with_capacity(edge * edge);
        let columns = width.div_ceil(edge);
        for (down, first) in (0..height).step_by(edge).enumerate() {
            let count = edge.min((height - first) as usize);
            rows.iter_mut().take(count).zip(first..).for_each(|(row, y)| source.row(y, row));
            for across in 0..columns {
                texels.clear();
                for row in &rows[..count] {
                    let part = row[across * edge..].iter().take(edge);
                    texels.extend(part.map(|texel| std::array::from_fn(|c| f64::from(texel[c]))));
                }
                let rounding = self.roundings.get(down * columns + across).or(self.roundings.first());
                let rounding = self.loss * rounding.copied().unwrap_or(BYTE);
                let of_channel = |c: usize| match self.rounding {
                    Rounding::Floats => {
                        texels.iter().fold(HALF_STEP, |most: f64, texel| most.max(rounding * texel[c].abs()))
                    }
                    _ => rounding,
                };
                visit(&texels, std::array::from_fn(of_channel));
            }
        }
    }

    /// Returns the root mean square residual of all channels together, for a block with these `extents`.
    pub fn residual<const N: usize>(&self, extents: [f64; N]) -> f64 {
        let squares = extents.map(|d| d * d);
        let (sum, most) = (squares.iter().sum::<f64>(), squares.iter().copied().fold(0.0, f64::max));
        let Rounding::Blocks { weights, .. } = self.rounding else { return 0.0 };
        let square = match (weights, N) {
            (Weights::Separate { steps }, _) | (Weights::TwoPlanes { steps }, 1 | 2) => sum / (12.0 * steps * steps),
            (Weights::TwoPlanes { steps }, _) => most / (12.0 * steps * steps) + (sum - most) / (12.0 * 2.0),
            (Weights::Shared, _) => sum * (N as f64 - 1.0).max(1.0) / (12.0 * N as f64),
        };
        self.loss * square.sqrt()
    }
}

/// Returns the rounding of a format that Roughcast does not write, by its blocks and values.
fn other_rounding(file: &Ktx2<'_>, image: &Image) -> Rounding {
    let has_blocks = file.descriptor().is_some_and(|basic| basic.texel_block_dimensions[0].get() > 1);
    match &image.samples {
        _ if has_blocks => OTHER_BLOCKS,
        Samples::F32(_) => Rounding::Floats,
        _ => Rounding::Integers,
    }
}
