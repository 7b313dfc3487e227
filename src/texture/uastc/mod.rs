//! UASTC LDR 4x4 block encoder.
//!
//! UASTC is the one payload that every engine of interest transcodes (to BC7, ASTC, ETC, BC1...).
//! A block of 4x4 texels takes sixteen bytes. Source: "UASTC LDR 4x4 Texture Specification"
//! (BinomialLLC/basis_universal wiki).
//!
//! The maps that this crate writes are normals and a few slowly varying channels. Normals are a
//! two-dimensional family, so beside lines of colours (modes 0, 1, 5, 18) the mode with two
//! weight planes (6) and those with two or three subsets (2, 3, 4) matter: on a wool normal map two
//! planes alone gain 5 dB over one line. Normals are judged by direction ([`Metric`]).

mod candidate;
mod direction;
mod hints;
mod line;
mod moments;
mod normals;
mod pack;
mod partition;
mod polish;
mod search;
mod tables;
#[cfg(test)]
mod tests;

use fearless_simd::{Level, Simd};
use hints::{Hints, solid_etc1};
use pack::{Block, pack_solid};
use rayon::prelude::*;

use crate::simd::dispatch;

/// Bytes of one block.
pub const BLOCK_BYTES: usize = 16;

/// How hard the encoder searches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Effort {
    /// Fits the modes that can win by the covariance of the colours. On eighteen real maps as near
    /// to the source as basis_universal's level 1, in a twentieth of its time.
    Fast,
    /// Fits all modes that pay and refines the winner: nearer than basis_universal's level 2 on
    /// each of those maps, in a quarter of the time of its level 1.
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

/// Encodes one mip level to UASTC LDR 4x4 blocks, row by row.
///
/// `texels` holds `width * height` RGBA8 texels, row 0 first. Sizes that are not multiples of 4
/// are padded by repeating the last column and row. The result has 16 bytes for each of
/// `width.div_ceil(4) * height.div_ceil(4)` blocks; it is empty where `texels` does not have the
/// length that the size asks for. The bytes depend on neither machine nor number of threads.
pub fn encode_level(texels: &[u8], width: u32, height: u32, metric: Metric, effort: Effort) -> Vec<u8> {
    let bytes = u128::from(width) * u128::from(height) * 4;
    if bytes == 0 || bytes != texels.len() as u128 {
        return Vec::new();
    }
    let (width, height) = (width as usize, height as usize);
    let row_bytes = width.div_ceil(4) * BLOCK_BYTES;
    let mut blocks = vec![0; row_bytes * height.div_ceil(4)];
    let instructions = Level::new();
    blocks.par_chunks_exact_mut(row_bytes).enumerate().for_each(|(row, out)| {
        let lines: [&[u8]; 4] = std::array::from_fn(|y| {
            let at = (row * 4 + y).min(height - 1) * width * 4;
            &texels[at..at + width * 4]
        });
        dispatch!(instructions, simd => {
            for (column, out) in out.as_chunks_mut::<BLOCK_BYTES>().0.iter_mut().enumerate() {
                *out = encode_with(simd, &gather(&lines, column * 4), metric, effort);
            }
        });
    });
    blocks
}

/// The block at column `left` of four lines of texels, the last texel repeated.
fn gather(lines: &[&[u8]; 4], left: usize) -> [[u8; 4]; 16] {
    std::array::from_fn(|i| {
        let (line, _) = lines[i / 4].as_chunks::<4>();
        line[(left + i % 4).min(line.len() - 1)]
    })
}

/// Encodes one block of 4x4 RGBA8 texels, row 0 first. The encoder's loops over sixteen texels are compiled for every instruction set; their order of operations, and so
/// the bytes, are the same.
#[inline(always)]
fn encode_with<S: Simd>(simd: S, texels: &[[u8; 4]; 16], metric: Metric, effort: Effort) -> [u8; BLOCK_BYTES] {
    let opaque = match metric {
        Metric::Rgb | Metric::Surface | Metric::Direction => true,
        Metric::Rgba => texels.iter().all(|t| t[3] == 255),
    };
    let texels = &texels.map(|[r, g, b, a]| [r, g, b, if opaque { 255 } else { a }]);
    if let Some(block) = solid(texels) {
        return block;
    }
    let block = search(simd, texels, metric, opaque, effort);
    let hints = Hints::of(texels, block.mode);
    block.pack(&hints)
}

fn solid(texels: &[[u8; 4]; 16]) -> Option<[u8; BLOCK_BYTES]> {
    texels.iter().all(|t| *t == texels[0]).then(|| pack_solid(texels[0], solid_etc1(texels[0])))
}

#[inline(always)]
fn search<S: Simd>(simd: S, texels: &[[u8; 4]; 16], metric: Metric, opaque: bool, effort: Effort) -> Block {
    // Shifts of whole texels, because loads of single bytes do not vectorise.
    let channel = |c: usize| {
        let mut lane = [0.0; 16];
        for (value, texel) in lane.iter_mut().zip(texels) {
            *value = (u32::from_le_bytes(*texel) >> (8 * c) & 255) as i32 as f32;
        }
        lane
    };
    let rgb = [channel(0), channel(1), channel(2)];
    // Powers of two keep sums exact.
    let scale: [f32; 3] = if metric == Metric::Surface { [0.25, 1.0, 0.25] } else { [1.0; 3] };
    let scaled = || std::array::from_fn(|c| rgb[c].map(|level| level * scale[c]));
    match (metric, opaque, effort) {
        (Metric::Direction, _, Effort::Fast) => normals::fast(simd, &rgb),
        (Metric::Direction, _, Effort::Best) => normals::best(simd, &rgb),
        (_, true, Effort::Fast) => search::fast_rgb(simd, &scaled(), &scale),
        (_, true, Effort::Best) => search::best_rgb(simd, &scaled(), &scale),
        (_, false, effort) => {
            let [r, g, b] = rgb;
            search::rgba(simd, &[r, g, b, channel(3)], effort == Effort::Best)
        }
    }
}
