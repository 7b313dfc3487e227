//! Bounds of the error that a texture format itself adds between encoded and decoded texels.
//!
//! Values are shares of the range between texels of 0 and 1. An error has two parts.
//!
//! *Rounding*: block encoders read channels of 8 bits (half a step is 1/510), and each mode of a block has a number of
//! levels for its endpoints (half of the distance between two levels).
//!
//! *Residual*: a texel takes the nearest of the colours between the endpoints; there are as many colours as weights
//! have values. Rounding to steps of s has a root mean square error of s / sqrt 12. Channels that share a weight lie on
//! a line. An encoder takes the line along which the channels vary most, so that at most (n - 1) / n of the variance of
//! n channels remains as error. Texels are assumed to be uniform between the extremes of their block; with extremes d
//! apart, their variance is d^2 / 12. An encoder takes the best mode of a format, which is at least as good as the mode
//! assumed here:
//!
//! - UASTC (Basis Universal, "UASTC LDR 4x4 Texture Specification", mode 6): two planes of four weights. With one or
//!   two channels each channel has its own plane: s = d / 3. With three channels, the channel that varies most has a
//!   plane, and the other two share the second plane.
//! - BC4 and BC5 (Khronos Data Format 1.3, chapter 20): eight weights for every channel: s = d / 7.
//! - BC7: three channels share one weight.
//! - Half floats have 11 bits: their error is at most 2^-11 of the value, or 2^-25 for small values. Integer formats
//!   without blocks have an error of half a step.
//!
//! Blocks that `--rdo` has rewritten lose at most the requested number of dB, which multiplies the error.

use ktx2::Format;

use crate::codec::{Codec, Rounding};
use crate::image::{Image, Rgba, Samples};
use crate::ktx2::{Ktx2, ReadError, provenance};
use crate::mip::TexelRows;

/// Largest rounding error of 8 bits.
const BYTE: f64 = 0.5 / 255.0;

/// Half of the smallest step of half floats.
const HALF_STEP: f64 = 1.0 / (1 << 25) as f64;

/// Largest loss that `--rdo` accepts, in dB. Assumed for textures without provenance.
const MOST_LOSS: f64 = 6.0;

/// Kinds of payloads, by how their errors arise.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Uastc,
    Bc7,
    /// BC4 and BC5.
    SeparateChannels,
    /// Blocks that this tool does not write, with endpoints of 5 bits at worst: BC1 to BC3 and ETC1S.
    Other,
    /// Integers: the error is a share of the range.
    Steps,
    /// Floats: the error is a share of the value.
    Float,
}

/// A decoded level and the bounds of its storage error.
pub struct Storage {
    image: Image,
    kind: Kind,
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
        let kind = kind(file, &image);
        let per_block = |levels: fn(&[u8; 16]) -> f64| -> Result<Vec<f64>, ReadError> {
            let payload = file.level_bytes(level)?;
            Ok(payload.as_chunks::<16>().0.iter().map(|block| BYTE + 0.5 / (levels(block) - 1.0)).collect())
        };
        let roundings = match (kind, &image.samples) {
            (Kind::Uastc, _) => per_block(uastc_levels)?,
            (Kind::Bc7, _) => per_block(bc7_levels)?,
            (Kind::SeparateChannels, _) => vec![BYTE + BYTE],
            (Kind::Other, _) => vec![BYTE + 0.5 / 31.0],
            (Kind::Steps, Samples::U16(_)) => vec![0.5 / 65535.0],
            (Kind::Steps, _) => vec![BYTE],
            (Kind::Float, _) => vec![1.0 / 2048.0],
        };
        let loss = match provenance(file) {
            Some(found) => found.settings["rdo"].as_f64().unwrap_or(0.0).clamp(0.0, MOST_LOSS),
            None => MOST_LOSS,
        };
        let loss = if kind == Kind::Uastc { 10_f64.powf(loss / 20.0) } else { 1.0 };
        Ok(Self { image, kind, roundings, loss })
    }

    /// Returns the decoded level.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Returns whether channels of a block share weights.
    pub fn has_shared_weights(&self) -> bool {
        matches!(self.kind, Kind::Uastc | Kind::Bc7 | Kind::Other)
    }

    /// Calls `visit` for each block, or for each texel if the format has no blocks. The arguments are the first `N`
    /// channels of the texels, and the largest rounding of each of these channels.
    pub fn visit<const N: usize>(&self, mut visit: impl FnMut(&[[f64; N]], [f64; N])) {
        let (width, height) = (self.image.width as usize, self.image.height);
        let edge = if matches!(self.kind, Kind::Steps | Kind::Float) { 1 } else { 4 };
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
                let of_channel = |c: usize| match self.kind {
                    Kind::Float => {
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
        let square = match (self.kind, N) {
            (Kind::Steps | Kind::Float, _) => 0.0,
            (Kind::SeparateChannels, _) => sum / (12.0 * 49.0),
            (Kind::Uastc, 1 | 2) => sum / (12.0 * 9.0),
            (Kind::Uastc, _) => most / (12.0 * 9.0) + (sum - most) / (12.0 * 2.0),
            (Kind::Bc7 | Kind::Other, _) => sum * (N as f64 - 1.0).max(1.0) / (12.0 * N as f64),
        };
        self.loss * square.sqrt()
    }
}

/// Returns the kind of a format that Roughcast writes, and of other formats by their blocks and values.
fn kind(file: &Ktx2<'_>, image: &Image) -> Kind {
    let model = file.descriptor().and_then(|basic| basic.color_model);
    let format = match file.header().format {
        // Colours are not linearised: what holds for the one holds for the other.
        Some(Format::BC7_SRGB_BLOCK) => Some(Format::BC7_UNORM_BLOCK),
        format => format,
    };
    match Codec::of_file(format, model).map(|codec| codec.rounding) {
        Some(Rounding::Uastc) => Kind::Uastc,
        Some(Rounding::Bc7) => Kind::Bc7,
        Some(Rounding::SeparateChannels) => Kind::SeparateChannels,
        Some(Rounding::Float) => Kind::Float,
        None if file.descriptor().is_some_and(|basic| basic.texel_block_dimensions[0].get() > 1) => Kind::Other,
        None if matches!(image.samples, Samples::F32(_)) => Kind::Float,
        None => Kind::Steps,
    }
}

/// Returns the number of endpoint levels of a UASTC block. A prefix code of two to seven bits gives the block's mode.
/// Blocks of one colour store that colour with 8 bits.
fn uastc_levels(block: &[u8; 16]) -> f64 {
    /// Code, its length in bits, and levels of each mode, in the order of the modes (specification, "Block modes").
    const MODES: [(u8, u32, u32); 19] = [
        (0x01, 4, 192),
        (0x35, 6, 256),
        (0x1d, 5, 16),
        (0x03, 5, 12),
        (0x13, 5, 40),
        (0x0b, 5, 256),
        (0x1b, 5, 160),
        (0x07, 5, 12),
        (0x17, 5, 256),
        (0x0f, 5, 16),
        (0x02, 3, 48),
        (0x00, 2, 48),
        (0x06, 3, 192),
        (0x1f, 5, 256),
        (0x0d, 5, 256),
        (0x05, 7, 256),
        (0x15, 6, 256),
        (0x25, 6, 256),
        (0x09, 4, 32),
    ];
    let mode = MODES.iter().find(|(code, length, _)| block[0] & ((1 << length) - 1) as u8 == *code);
    f64::from(mode.map_or(12, |(.., levels)| *levels))
}

/// Returns the number of endpoint levels of a BC7 block. Its mode is the number of zero bits before the first one bit
/// (Khronos Data Format 1.3, table 117; the bits of the colours plus the bit that endpoints share).
fn bc7_levels(block: &[u8; 16]) -> f64 {
    const BITS: [u32; 8] = [5, 7, 5, 8, 5, 7, 8, 6];
    let bits = BITS.get(block[0].trailing_zeros() as usize).copied().unwrap_or(5);
    f64::from(1_u32 << bits)
}
