//! How far decoded texels may lie from those that were encoded: what a format itself explains.
//!
//! Values are shares of the range that texels of 0 and 1 stand for. An error has two parts. *Rounding*: block encoders take
//! levels of 8 bits (half a step: 1/510), and a block's endpoints are the nearest of as many levels as its mode has (half of
//! their distance). *Residual*: a texel takes the nearest of the colours between the endpoints, which are as many as weights
//! have values; what is rounded to steps of s is off by s / sqrt 12, root mean square. Channels that share a weight lie on a
//! line, and an encoder takes the line along which they vary most, so that at most (n - 1) / n of the variance of n channels
//! lies beside it. Texels are taken to lie anywhere between the extremes of their block, d apart: their variance is
//! d^2 / 12. An encoder takes the best of a format's modes, and is no worse than the one that is reckoned with:
//!
//! - UASTC (Basis Universal, "UASTC LDR 4x4 Texture Specification", mode 6): two planes of four weights. One or two channels
//!   have each a plane of their own: s = d / 3. Of three, the one that varies most has a plane, and the others share one.
//! - BC4 and BC5 (Khronos Data Format 1.3, chapter 20): eight weights for every channel: s = d / 7.
//! - BC7: three channels share one weight.
//! - Half floats have 11 bits: they are off by 2^-11 of the value at most, and small ones by 2^-25. Formats of whole numbers
//!   without blocks are off by half a step.
//!
//! Blocks that were rewritten to be smaller (`--rdo`) lose as many dB as was asked for at most, which is a factor.

use ktx2::{ColorModel, Format};

use crate::image::{Image, Rgba, Samples};
use crate::ktx2::{Ktx2, ReadError, provenance};
use crate::mip::Rows;

/// Rounding to 8 bits.
const BYTE: f64 = 0.5 / 255.0;

/// Half of the least step of half floats.
const HALF_STEP: f64 = 1.0 / (1 << 25) as f64;

/// Most that `--rdo` may lose, in dB: what is reckoned with where no provenance tells.
const MOST_LOSS: f64 = 6.0;

/// How payloads are made.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Uastc,
    Bc7,
    /// BC4 and BC5.
    Apart,
    /// Blocks that this tool does not write, with endpoints of 5 bits at worst: BC1 to BC3 and ETC1S.
    Other,
    /// Steps of the same size.
    Steps,
    /// A share of the value.
    Float,
}

/// A decoded level, and how far its texels may be off.
pub struct Storage {
    image: Image,
    kind: Kind,
    /// Largest rounding of every block, or of all texels where there are no blocks.
    roundings: Vec<f64>,
    /// What `--rdo` multiplies errors by.
    loss: f64,
}

impl Storage {
    /// Decodes a level of `file`.
    ///
    /// # Errors
    /// Those of [`Ktx2::decode_level`].
    pub fn of(file: &Ktx2<'_>, level: u32) -> Result<Self, ReadError> {
        let image = file.decode_level(level)?;
        let kind = kind(file, &image);
        let per_block = |levels: fn(&[u8; 16]) -> f64| -> Result<Vec<f64>, ReadError> {
            let payload = file.level_bytes(level)?;
            Ok(payload.as_chunks::<16>().0.iter().map(|block| BYTE + 0.5 / (levels(block) - 1.0)).collect())
        };
        let roundings = match (kind, &image.samples) {
            (Kind::Uastc, _) => per_block(uastc_levels)?,
            (Kind::Bc7, _) => per_block(bc7_levels)?,
            (Kind::Apart, _) => vec![BYTE + BYTE],
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

    /// The decoded level.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Whether the texels of a block lie on lines, planes or single colours between endpoints.
    pub fn has_shared_weights(&self) -> bool {
        matches!(self.kind, Kind::Uastc | Kind::Bc7 | Kind::Other)
    }

    /// Calls `visit` with the first `N` channels of the texels of each block, or of each texel where there are no blocks, and
    /// with the largest rounding of each of these channels.
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

    /// The root mean square of what is left of texels whose channels lie `extents` apart, all channels together.
    pub fn residual<const N: usize>(&self, extents: [f64; N]) -> f64 {
        let squares = extents.map(|d| d * d);
        let (sum, most) = (squares.iter().sum::<f64>(), squares.iter().copied().fold(0.0, f64::max));
        let square = match (self.kind, N) {
            (Kind::Steps | Kind::Float, _) => 0.0,
            (Kind::Apart, _) => sum / (12.0 * 49.0),
            (Kind::Uastc, 1 | 2) => sum / (12.0 * 9.0),
            (Kind::Uastc, _) => most / (12.0 * 9.0) + (sum - most) / (12.0 * 2.0),
            (Kind::Bc7 | Kind::Other, _) => sum * (N as f64 - 1.0).max(1.0) / (12.0 * N as f64),
        };
        self.loss * square.sqrt()
    }
}

fn kind(file: &Ktx2<'_>, image: &Image) -> Kind {
    let model = || file.descriptor().and_then(|basic| basic.color_model);
    match file.header().format {
        None if model() == Some(ColorModel::UASTC) => Kind::Uastc,
        Some(Format::BC7_UNORM_BLOCK | Format::BC7_SRGB_BLOCK) => Kind::Bc7,
        Some(Format::BC4_UNORM_BLOCK | Format::BC5_UNORM_BLOCK) => Kind::Apart,
        _ if file.descriptor().is_some_and(|basic| basic.texel_block_dimensions[0].get() > 1) => Kind::Other,
        _ if matches!(image.samples, Samples::F32(_)) => Kind::Float,
        _ => Kind::Steps,
    }
}

/// Levels of the endpoints of a UASTC block: by its mode, which a prefix code of two to seven bits tells. All bits of blocks of
/// one colour are exact.
fn uastc_levels(block: &[u8; 16]) -> f64 {
    /// Codes, their lengths in bits and levels, in the order of the modes (specification, "Block modes").
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

/// Levels of the endpoints of a BC7 block: by its mode, the number of zeros before the first one (Khronos Data Format 1.3,
/// table 117; bits of the colours and the bit that endpoints share).
fn bc7_levels(block: &[u8; 16]) -> f64 {
    const BITS: [u32; 8] = [5, 7, 5, 8, 5, 7, 8, 6];
    let bits = BITS.get(block[0].trailing_zeros() as usize).copied().unwrap_or(5);
    f64::from(1_u32 << bits)
}
