//! Texture values at sample points as an engine reads them. Only the blocks at these points are encoded.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use crate::codec::uastc::Lobe;
use crate::codec::{EncodeError, Texels, encode};
use crate::ktx2::decode_payload;
use crate::material::{EDGE, Encoding, LevelRows, THOROUGH_LEVEL};
use crate::mip::{Wrap, neighbours};

/// A texel of a level.
#[derive(Clone, Copy)]
pub struct LevelTexel {
    /// The level.
    pub level: usize,
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
}

/// A sampler of a texture that need not be encoded yet.
pub struct TextureSampler<'a> {
    /// Sizes of its levels, level 0 first.
    pub sizes: &'a [(u32, u32)],
    /// The finest level that it has.
    pub first: usize,
    /// How it is encoded; `None` reads the values themselves.
    pub encoding: Option<Encoding>,
    /// The texels of the texture.
    pub rows: LevelRows<'a>,
    /// The sampler's mode, across and down.
    pub wrap: [Wrap; 2],
}

impl TextureSampler<'_> {
    /// Returns the values at the centres of `points`, which are texels of a mip chain of the sizes `grid`. Each value
    /// is read from the level whose texels have the size of the point's texel, with linear filtering. A level that the
    /// texture lacks is magnified from its first level.
    ///
    /// # Errors
    /// [`EncodeError`] if the blocks cannot be encoded.
    pub fn at(&self, grid: &[(u32, u32)], points: &[LevelTexel]) -> Result<Vec<[f32; 4]>, EncodeError> {
        let taps: Vec<(usize, [Tap; 4])> = points.iter().map(|point| self.taps(grid, *point)).collect();
        let mut blocks = BTreeSet::new();
        for (level, taps) in &taps {
            blocks.extend(taps.iter().filter(|t| t.weight > 0.0).map(|t| (*level, t.y / EDGE, t.x / EDGE)));
        }
        let texels = self.decoded(&blocks)?;
        let texel = |level: usize, tap: &Tap| {
            let block = texels.get(&(level, tap.y / EDGE, tap.x / EDGE));
            block.map_or([0.0; 4], |block| block[(tap.y % EDGE * EDGE + tap.x % EDGE) as usize])
        };
        let value = |(level, taps): &(usize, [Tap; 4])| {
            let mut sum = [0.0; 4];
            for tap in taps.iter().filter(|t| t.weight > 0.0) {
                for (s, v) in sum.iter_mut().zip(texel(*level, tap)) {
                    *s += tap.weight * v;
                }
            }
            sum
        };
        Ok(taps.iter().map(value).collect())
    }

    fn taps(&self, grid: &[(u32, u32)], LevelTexel { level, x, y }: LevelTexel) -> (usize, [Tap; 4]) {
        let size = grid[level];
        // A texture that is smaller or larger than the grid is sampled at a finer or coarser level.
        let offset = log2(grid[0]) - log2(self.sizes[0]);
        let sampled = (level as i64 - offset).clamp(self.first as i64, self.sizes.len() as i64 - 1) as usize;
        let (width, height) = self.sizes[sampled];
        let across = neighbours(width, size.0, x, self.wrap[0]);
        let down = neighbours(height, size.1, y, self.wrap[1]);
        let tap = |i: usize| {
            let (across, down) = (across[i % 2], down[i / 2]);
            Tap { x: across.0, y: down.0, weight: across.1 * down.1 }
        };
        (sampled, [0, 1, 2, 3].map(tap))
    }

    /// Returns the texels of `blocks` as they are decoded.
    fn decoded(&self, blocks: &BTreeSet<Block>) -> Result<BTreeMap<Block, [[f32; 4]; 16]>, EncodeError> {
        let mut rows: BTreeMap<(usize, u32), Vec<u32>> = BTreeMap::new();
        for &(level, row, column) in blocks {
            rows.entry((level, row)).or_default().push(column);
        }
        let rows: Vec<_> = rows.into_iter().collect();
        let values: Vec<Vec<[[f32; 4]; 16]>> = rows
            .par_iter()
            .map(|((level, row), columns)| self.blocks_of_row(*level, *row, columns, self.rows.values, [0.0; 4]))
            .collect();
        let mut values: Vec<[[f32; 4]; 16]> = values.into_iter().flatten().collect();
        if let Some(encoding) = self.encoding {
            let lobes = self.rows.lobes.map(|row_of_lobes| {
                let of_row = |((level, row), columns): &((usize, u32), Vec<u32>)| {
                    self.blocks_of_row(*level, *row, columns, row_of_lobes, Lobe::isotropic(1.0))
                };
                let lobes: Vec<Vec<[Lobe; 16]>> = rows.par_iter().map(of_row).collect();
                lobes.concat()
            });
            let near = blocks.iter().take_while(|(level, ..)| *level < THOROUGH_LEVEL).count();
            let lobes = lobes.as_deref().map(|lobes| lobes.split_at(near));
            let (near, far) = values.split_at_mut(near);
            encode_and_decode(encoding, near, lobes.map(|(near, _)| near))?;
            encode_and_decode(encoding.at(THOROUGH_LEVEL), far, lobes.map(|(_, far)| far))?;
        }
        Ok(blocks.iter().copied().zip(values).collect())
    }

    /// Returns what `row_of` writes for the blocks `columns` of a row of blocks.
    fn blocks_of_row<T: Copy>(
        &self,
        level: usize,
        row: u32,
        columns: &[u32],
        row_of: &(dyn Fn(usize, u32, &mut [T]) + Sync),
        empty: T,
    ) -> Vec<[T; 16]> {
        let (width, height) = self.sizes[level];
        let mut blocks = vec![[empty; 16]; columns.len()];
        let mut line = vec![empty; width as usize];
        for dy in 0..EDGE {
            // Encoders repeat the last row and column.
            row_of(level, (row * EDGE + dy).min(height - 1), &mut line);
            for (block, column) in blocks.iter_mut().zip(columns) {
                for dx in 0..EDGE {
                    let x = (column * EDGE + dx).min(width - 1);
                    block[(dy * EDGE + dx) as usize] = line[x as usize];
                }
            }
        }
        blocks
    }
}

/// A block of a level: level, row, column.
type Block = (usize, u32, u32);

/// A texel that a value is interpolated from.
#[derive(Clone, Copy)]
struct Tap {
    x: u32,
    y: u32,
    weight: f32,
}

/// Encodes and decodes blocks as a texture of one row of blocks. Every encoder treats its blocks one by one.
fn encode_and_decode(
    encoding: Encoding,
    blocks: &mut [[[f32; 4]; 16]],
    lobes: Option<&[[Lobe; 16]]>,
) -> Result<(), EncodeError> {
    let width = blocks.len() as u32 * EDGE;
    if width == 0 {
        return Ok(());
    }
    let format = encoding.format;
    let bytes = {
        let row = |y: u32, out: &mut [[f32; 4]]| write_row(blocks, y, out);
        let lobe_row = lobes.map(|lobes| move |y: u32, out: &mut [Lobe]| write_row(lobes, y, out));
        let lobes = lobe_row.as_ref().map(|row| row as &(dyn Fn(u32, &mut [Lobe]) + Sync));
        encode(&Texels { width, height: EDGE, row: &row, lobes }, format, encoding.metric, encoding.effort)?
    };
    let failed =
        || EncodeError::Encoder { format, width, height: EDGE, reason: "its blocks cannot be decoded".to_owned() };
    let image = decode_payload(&bytes, format, (width, EDGE)).ok_or_else(failed)?;
    for (i, block) in blocks.iter_mut().enumerate() {
        for (j, texel) in block.iter_mut().enumerate() {
            let (x, y) = (i as u32 * EDGE + j as u32 % EDGE, j as u32 / EDGE);
            for (c, value) in texel.iter_mut().enumerate() {
                *value = image.sample(x, y, c as u32).unwrap_or(0.0);
            }
        }
    }
    Ok(())
}

/// Writes row `y` of a row of `blocks`.
fn write_row<T: Copy>(blocks: &[[T; 16]], y: u32, out: &mut [T]) {
    let from = (y * EDGE) as usize;
    for (out, block) in out.chunks_exact_mut(EDGE as usize).zip(blocks) {
        out.copy_from_slice(&block[from..from + EDGE as usize]);
    }
}

/// Returns the binary logarithm of the longer side, rounded down.
fn log2((width, height): (u32, u32)) -> i64 {
    i64::from(width.max(height).ilog2())
}

#[cfg(test)]
mod tests;
