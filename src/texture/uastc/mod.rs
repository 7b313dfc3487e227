//! UASTC LDR 4x4 block encoder.
//!
//! UASTC is the one payload that every engine of interest transcodes (to BC7, ASTC, ETC, BC1...).
//! A block of 4x4 texels takes sixteen bytes. Source: "UASTC LDR 4x4 Texture Specification"
//! (BinomialLLC/basis_universal wiki).
//!
//! The maps that this crate writes are normals and a few slowly varying channels. Normals are a
//! two-dimensional family, so beside lines of colours (modes 0, 1, 5, 15, 18) the mode with two
//! weight planes (6) and those with two or three subsets (2, 3, 4) matter: on a wool normal map two
//! planes alone gain 5 dB over one line. Normals are judged by direction ([`Metric`]).

mod blocks;
mod candidate;
mod direction;
mod hints;
mod lanes;
mod line;
mod moments;
mod normals;
mod pack;
mod partition;
mod polish;
mod rate;
mod row;
mod search;
mod tables;
#[cfg(test)]
mod tests;
mod unpack;

use fearless_simd::{Level, Simd};
use hints::{Hints, solid_etc1};
use lanes::Texels;
use pack::pack_solid;
pub use rate::lower_rate;
use rayon::prelude::*;
use row::{Row, groups};

use crate::simd::dispatch;

/// Bytes of one block.
pub const BLOCK_BYTES: usize = 16;

/// How hard the encoder searches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Effort {
    /// Fits the modes that can win by the covariance of the colours: about as near to the source as basis_universal's
    /// level 1 (`docs/performance.md`).
    Fast,
    /// Fits all modes that pay and refines the winner: about as near as its level 2, and nearer by direction.
    Best,
}

/// What makes decoded texels near to their source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Metric {
    /// Red, green and blue; alpha is ignored and decodes as 255.
    Rgb,
    /// As [`Metric::Rgb`] with roughness in green before occlusion and metal beside it, which lobes do not depend on: a
    /// difference of theirs counts as one of roughness that is a quarter as large. (On the materials of FlightHelmet roughness gains
    /// 5.5 dB, occlusion loses 6 dB and lobe errors fall by up to 0.035.)
    Surface,
    /// All four channels.
    Rgba,
    /// The direction of the vector 2 rgb / 255 - 1, a normal; alpha is ignored and decodes as 255. Lengths stay within
    /// 0.015 of 1 in the mean over a level of unit normals.
    Direction,
}

impl Metric {
    /// What a difference of one level counts for in red, green and blue. Powers of two: sums of their multiples are exact.
    fn scale(self) -> [f32; 3] {
        if self == Self::Surface { [0.25, 1.0, 0.25] } else { [1.0; 3] }
    }
}

/// Encodes one mip level to UASTC LDR 4x4 blocks, row by row.
///
/// `texels` holds `width * height` RGBA8 texels, row 0 first. Sizes that are not multiples of 4
/// are padded by repeating the last column and row. The result has 16 bytes for each of
/// `width.div_ceil(4) * height.div_ceil(4)` blocks; it is empty where `texels` does not have the
/// length that the size asks for. The bytes depend on neither machine nor number of threads.
pub fn encode_level(texels: &[u8], width: u32, height: u32, metric: Metric, effort: Effort) -> Vec<u8> {
    encode_level_with(Level::new(), texels, (width, height), metric, effort)
}

fn encode_level_with(
    instructions: Level,
    texels: &[u8],
    (width, height): (u32, u32),
    metric: Metric,
    effort: Effort,
) -> Vec<u8> {
    let bytes = u128::from(width) * u128::from(height) * 4;
    if bytes == 0 || bytes != texels.len() as u128 {
        return Vec::new();
    }
    let (width, height) = (width as usize, height as usize);
    let row_bytes = width.div_ceil(4) * BLOCK_BYTES;
    let mut blocks = vec![0; row_bytes * height.div_ceil(4)];
    blocks.par_chunks_exact_mut(row_bytes).enumerate().for_each(|(row, out)| {
        let lines = std::array::from_fn(|y| {
            let at = (row * 4 + y).min(height - 1) * width * 4;
            &texels[at..at + width * 4]
        });
        encode_lines(instructions, &lines, metric, effort, out);
    });
    blocks
}

/// Encodes four lines of RGBA8 texels to the row of blocks `out`.
pub(super) fn encode_lines(instructions: Level, lines: &[&[u8]; 4], metric: Metric, effort: Effort, out: &mut [u8]) {
    let blocks = out.as_chunks_mut::<BLOCK_BYTES>().0;
    let texels = (0..blocks.len()).map(|column| gather(lines, column * 4)).collect();
    dispatch!(instructions, simd => encode_row(simd, texels, metric, effort, blocks));
}

/// The block at column `left` of four lines of texels, the last texel repeated.
fn gather(lines: &[&[u8]; 4], left: usize) -> Texels {
    let mut texels = Texels::default();
    for (row, line) in texels.as_chunks_mut::<4>().0.iter_mut().zip(lines) {
        let (line, _) = line.as_chunks::<4>();
        match line.get(left..).and_then(<[_]>::first_chunk) {
            Some(four) => *row = *four,
            None => *row = std::array::from_fn(|x| line[(left + x).min(line.len() - 1)]),
        }
    }
    texels
}

/// Encodes a row of blocks. The search is compiled for every instruction set; the order of its operations, and so the
/// bytes, are the same.
#[inline(always)]
fn encode_row<S: Simd>(
    simd: S,
    mut texels: Vec<Texels>,
    metric: Metric,
    effort: Effort,
    out: &mut [[u8; BLOCK_BYTES]],
) {
    let (mut opaque, mut other) = (Vec::with_capacity(out.len()), Vec::new());
    for (k, texels) in texels.iter_mut().enumerate() {
        if metric != Metric::Rgba {
            texels.iter_mut().for_each(|texel| texel[3] = 255);
        }
        if texels.iter().all(|texel| *texel == texels[0]) {
            out[k] = pack_solid(texels[0], solid_etc1(texels[0]));
        } else if texels.iter().all(|texel| texel[3] == 255) {
            opaque.push(k);
        } else {
            other.push(k);
        }
    }
    let mut row = Row::new(texels);
    row.search_opaque(simd, &opaque, metric, effort);
    row.search_rgba(simd, &other, effort);
    opaque.append(&mut other);
    for (group, at) in groups(&opaque) {
        let hints = Hints::of_lanes(simd, at.map(|k| &row.texels[k]), at.map(|k| row.blocks[k].mode));
        for (&k, hints) in group.iter().zip(&hints) {
            out[k] = row.blocks[k].clone().pack(hints);
        }
    }
}
