//! Encodes texels to blocks.

use fearless_simd::{Level, Simd};
use rayon::prelude::*;
use texel_simd::dispatch;

use crate::BLOCK_BYTES;
use crate::hints::{Hints, solid_etc1};
use crate::image::{Image, SizeError};
use crate::lanes::Texels;
use crate::lobe::Lobe;
use crate::metric::{Effort, Metric};
use crate::pack::pack_solid;
use crate::row::{Row, groups};

/// Encodes RGB or RGBA with given settings. Alpha is ignored and decodes as 255, unless the metric is
/// [`Metric::Rgba`].
///
/// The encoded bytes do not depend on the machine, its instruction set or the number of threads.
#[derive(Clone, Copy, Debug)]
pub struct Encoder {
    metric: Metric,
    effort: Effort,
    pub(crate) instructions: Level,
}

impl Encoder {
    /// Creates an encoder that uses the best instruction set of this machine's processor.
    pub fn new(metric: Metric, effort: Effort) -> Self {
        Self { metric, effort, instructions: Level::new() }
    }

    /// Encodes `image`. Rows of blocks are encoded in parallel on the current rayon pool.
    ///
    /// Returns `height.div_ceil(4)` rows of `width.div_ceil(4)` blocks, row by row. Blocks that reach beyond the image
    /// repeat its last column and row.
    pub fn encode(&self, image: &Image<'_>) -> Vec<[u8; BLOCK_BYTES]> {
        let columns = image.columns();
        let mut blocks = vec![[0; BLOCK_BYTES]; columns * image.rows()];
        blocks.par_chunks_exact_mut(columns).enumerate().for_each(|(row, blocks)| {
            let lobes = image.has_lobes().then(|| std::array::from_fn(|y| image.lobes(4 * row + y)));
            self.encode_row(std::array::from_fn(|y| image.line(4 * row + y)), lobes, blocks);
        });
        blocks
    }

    /// Encodes four rows of RGBA8 texels to one row of blocks on the calling thread. Use this method for images that
    /// are not held in memory as a whole.
    ///
    /// The last texel of a row is repeated if the length is not a multiple of 4. If the height of the image is not a
    /// multiple of 4, pass its last row repeatedly.
    ///
    /// # Errors
    /// Returns [`SizeError::Rows`] if the rows are empty or differ in length. Returns [`SizeError::Blocks`] if `blocks`
    /// does not have one block for every four texels of a row, rounded up.
    pub fn encode_rows(&self, rows: [&[[u8; 4]]; 4], blocks: &mut [[u8; BLOCK_BYTES]]) -> Result<(), SizeError> {
        self.encode_rows_with(rows, None, blocks)
    }

    /// Encodes four rows of normals like [`Self::encode_rows`], by the errors of their `lobes`. Other metrics than
    /// [`Metric::Direction`] ignore the lobes.
    ///
    /// # Errors
    /// Returns the errors of [`Self::encode_rows`], and [`SizeError::Rows`] if a row of lobes does not have the length
    /// of the rows of texels.
    pub fn encode_rows_with_lobes(
        &self,
        rows: [&[[u8; 4]]; 4],
        lobes: [&[Lobe]; 4],
        blocks: &mut [[u8; BLOCK_BYTES]],
    ) -> Result<(), SizeError> {
        self.encode_rows_with(rows, Some(lobes), blocks)
    }

    fn encode_rows_with(
        &self,
        rows: [&[[u8; 4]]; 4],
        lobes: Option<[&[Lobe]; 4]>,
        blocks: &mut [[u8; BLOCK_BYTES]],
    ) -> Result<(), SizeError> {
        let widths = rows.map(<[_]>::len);
        for widths in [Some(widths), lobes.map(|lobes| lobes.map(<[_]>::len))].into_iter().flatten() {
            if widths != [rows[0].len(); 4] || widths[0] == 0 {
                return Err(SizeError::Rows { widths });
            }
        }
        let (expected, found) = (widths[0].div_ceil(4), blocks.len());
        if expected != found {
            return Err(SizeError::Blocks { expected, found });
        }
        self.encode_row(rows, lobes, blocks);
        Ok(())
    }

    /// Encodes four rows of equal length. The search is compiled here, once for each instruction set.
    fn encode_row(&self, rows: [&[[u8; 4]]; 4], lobes: Option<[&[Lobe]; 4]>, blocks: &mut [[u8; BLOCK_BYTES]]) {
        let texels = |column: usize| match self.metric {
            Metric::Rgba => gather(rows, column * 4),
            _ => gather_opaque(rows, column * 4),
        };
        let texels = (0..blocks.len()).map(texels).collect();
        let lobes = lobes.filter(|_| self.metric == Metric::Direction);
        let lobes = lobes.map(|rows| (0..blocks.len()).map(|column| gather(rows, column * 4)).collect());
        let row = Row::new(texels, lobes);
        dispatch!(self.instructions, simd => search_row(simd, row, self.metric, self.effort, blocks));
    }
}

/// Returns the texels of the block that begins at column `left` of four rows, made opaque.
fn gather_opaque(rows: [&[[u8; 4]]; 4], left: usize) -> Texels {
    let mut texels = gather(rows, left);
    texels.iter_mut().for_each(|texel| texel[3] = 255);
    texels
}

/// Returns what the block that begins at column `left` of four rows holds. The last element of a row is repeated.
fn gather<T: Copy>(rows: [&[T]; 4], left: usize) -> [T; 16] {
    let mut block = [rows[0][left]; 16];
    for (four, row) in block.as_chunks_mut::<4>().0.iter_mut().zip(rows) {
        match row.get(left..).and_then(<[_]>::first_chunk) {
            Some(found) => *four = *found,
            None => *four = std::array::from_fn(|x| row[(left + x).min(row.len() - 1)]),
        }
    }
    block
}

/// Encodes the blocks of a row. The order of operations is fixed, so that every instruction set gives the same bytes.
#[inline(always)]
fn search_row<S: Simd>(simd: S, mut row: Row, metric: Metric, effort: Effort, out: &mut [[u8; BLOCK_BYTES]]) {
    let mut varying = Vec::with_capacity(out.len());
    for (k, texels) in row.texels.iter().enumerate() {
        if texels.iter().all(|texel| *texel == texels[0]) {
            out[k] = pack_solid(texels[0], solid_etc1(texels[0]));
        } else {
            varying.push(k);
        }
    }
    row.search(simd, &varying, metric, effort);
    for (group, at) in groups(&varying) {
        let hints = Hints::of_lanes(simd, at.map(|k| &row.texels[k]), at.map(|k| row.blocks[k].mode));
        for (&k, hints) in group.iter().zip(&hints) {
            out[k] = row.blocks[k].clone().pack(hints);
        }
    }
}
