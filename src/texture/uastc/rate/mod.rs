//! Fewer bytes after zstd, for a bounded loss.
//!
//! zstd finds nothing in blocks that were fitted one by one: their bytes are next to random. Here each block may take over
//! bytes of a recent one: all of them, the weights with endpoints fitted anew, or the endpoints with weights fitted anew.
//! It does where its error and lambda times its bits, as zstd will store them, become less (Lagrangian relaxation).
//! One lambda for all blocks of a level is best for their sum; it is the largest within the loss that is allowed.

mod bits;
mod donors;
mod lane;
mod look;
mod pass;
mod refit;

use fearless_simd::Level;
use rayon::prelude::*;

use self::bits::Bits;
pub(super) use self::lane::Lane;
use self::look::{look, target};
use super::lanes::Texels;
use super::unpack::unpack;
use super::{BLOCK_BYTES, Metric};
use crate::simd::dispatch;

type Block = [u8; BLOCK_BYTES];

/// Rows of blocks that are rewritten one after another. Bands are rewritten side by side and know nothing of each other; 256
/// rows do no better.
const BAND_ROWS: usize = 32;

/// A level with its source.
struct Source<'a> {
    instructions: Level,
    texels: &'a [[u8; 4]],
    width: usize,
    height: usize,
    metric: Metric,
}

/// Squared errors of a level: by its metric, and of red, green and blue evenly.
type Errors = [f64; 2];

/// Rewrites the blocks of a level that [`super::encode_level`] made of the same `texels`, so that zstd makes them smaller.
///
/// Neither the error by `metric` nor that of red, green and blue grows by as much as `loss` dB, over all texels of the
/// level. Blocks with alpha or of greys (mode 15) stay as they are; so do all where the lengths do not fit, or `loss` is not above 0. The bytes
/// depend on neither machine nor number of threads.
pub fn lower_rate(blocks: &mut [u8], texels: &[u8], width: u32, height: u32, metric: Metric, loss: f64) {
    lower_rate_with(Level::new(), blocks, texels, (width, height), metric, loss);
}

pub(super) fn lower_rate_with(
    instructions: Level,
    blocks: &mut [u8],
    texels: &[u8],
    (width, height): (u32, u32),
    metric: Metric,
    loss: f64,
) {
    let (width, height) = (width as usize, height as usize);
    let (texels, rest) = texels.as_chunks::<4>();
    let fits = rest.is_empty()
        && width.checked_mul(height) == Some(texels.len())
        && blocks.len() == width.div_ceil(4) * height.div_ceil(4) * BLOCK_BYTES;
    if fits && !blocks.is_empty() && loss > 0.0 {
        Source { instructions, texels, width, height, metric }.lower(blocks, loss);
    }
}

impl Source<'_> {
    fn lower(&self, blocks: &mut [u8], loss: f64) {
        let bits = Bits::of(blocks);
        let blocks = blocks.as_chunks_mut::<BLOCK_BYTES>().0;
        let bands = self.height.div_ceil(4 * BAND_ROWS);
        let mut lambda = 0.5 * self.errors(blocks, 1)[0] / (48 * blocks.len()) as f64;
        if bands >= 4 * SAMPLE {
            (lambda, _) = self.search(blocks, &bits, lambda, loss, SAMPLE);
        }
        if let (_, Some(rewritten)) = self.search(blocks, &bits, lambda, loss, 1) {
            blocks.copy_from_slice(&rewritten);
        }
    }

    /// Looks at every `step`th band for the largest lambda within the bound, from `lambda` on; and the blocks that it gives,
    /// if any are within.
    fn search(&self, blocks: &[Block], bits: &Bits, lambda: f64, loss: f64, step: usize) -> (f64, Option<Vec<Block>>) {
        let before = self.errors(blocks, step);
        let allowed = libm::pow(10.0, 0.1 * loss);
        // How much of the allowed growth is used: below 1 is within.
        let used = |after: Errors| {
            let of = |k: usize| if after[k] > before[k] { (after[k] / before[k] - 1.0) / (allowed - 1.0) } else { 0.0 };
            of(0).max(of(1))
        };
        let mut search = Search { lambda, within: None, beyond: None };
        let (mut best, mut most_used) = (None, 0.0_f64);
        for _ in 0..PASSES {
            let mut rewritten = blocks.to_vec();
            self.rewrite(&mut rewritten, bits, search.lambda as f32, step);
            let used = used(self.errors(&rewritten, step));
            most_used = most_used.max(used);
            if used < 1.0 {
                best = Some(rewritten);
            }
            if search.is_done(used) {
                break;
            }
        }
        // Bands that cannot change tell nothing of lambda.
        (if most_used > 0.0 { search.lambda } else { lambda }, best)
    }

    /// Rewrites every `step`th band.
    fn rewrite(&self, blocks: &mut [Block], bits: &Bits, lambda: f32, step: usize) {
        let instructions = self.instructions;
        let band = BAND_ROWS * self.width.div_ceil(4);
        blocks.par_chunks_mut(band).enumerate().step_by(step).for_each(|(k, blocks)| {
            let texels = |at: usize| self.block(k * band + at);
            dispatch!(instructions, simd => pass::pass(simd, blocks, &texels, self.metric, bits, lambda));
        });
    }

    /// The texels of a block, the last column and row repeated.
    fn block(&self, at: usize) -> Texels {
        let columns = self.width.div_ceil(4);
        let (left, top) = (at % columns * 4, at / columns * 4);
        std::array::from_fn(|i| {
            let (x, y) = ((left + i % 4).min(self.width - 1), (top + i / 4).min(self.height - 1));
            self.texels[y * self.width + x]
        })
    }

    /// The errors of the texels of every `step`th band, in a fixed order of addition.
    fn errors(&self, blocks: &[Block], step: usize) -> Errors {
        let columns = self.width.div_ceil(4);
        let rows: Vec<Errors> = blocks
            .par_chunks(columns)
            .enumerate()
            .filter(|(row, _)| (row / BAND_ROWS).is_multiple_of(step))
            .map(|(row, blocks)| {
                let errors = blocks.iter().enumerate().map(|(column, block)| {
                    let inside = |i: usize| column * 4 + i % 4 < self.width && row * 4 + i / 4 < self.height;
                    errors(block, &self.block(row * columns + column), self.metric, inside)
                });
                add(errors)
            })
            .collect();
        add(rows)
    }
}

fn add(errors: impl IntoIterator<Item = Errors>) -> Errors {
    errors.into_iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
}

/// The errors of the texels of a block that are `inside` of the level; 0 for blocks that stay as they are.
fn errors(block: &Block, texels: &Texels, metric: Metric, inside: impl Fn(usize) -> bool) -> Errors {
    let Some(unpacked) = unpack(block) else { return [0.0; 2] };
    let (levels, source) = (unpacked.levels(), lanes(texels));
    [metric, Metric::Rgb].map(|metric| {
        let each = look(metric, &levels).errors(&target(metric, &source));
        (0..16).filter(|&i| inside(i)).map(|i| f64::from(each[i])).sum()
    })
}

fn lanes(texels: &Texels) -> [Lane; 3] {
    [0, 1, 2].map(|c| texels.map(|texel| f32::from(texel[c])))
}

/// Most passes of a search; four to six are usual.
const PASSES: usize = 8;
/// Levels of many bands are searched on every fourth first: passes over all of them take most of the time.
const SAMPLE: usize = 4;

/// Search for the largest lambda within the bound.
struct Search {
    lambda: f64,
    /// The largest lambda that is within, and how much of the bound it uses.
    within: Option<(f64, f64)>,
    /// The least that is beyond, likewise.
    beyond: Option<(f64, f64)>,
}

impl Search {
    /// Moves on after a pass that used `used` of the bound, where another is worth its time.
    fn is_done(&mut self, used: f64) -> bool {
        if self.lambda == 0.0 || (0.97..1.0).contains(&used) {
            return true;
        }
        // Losses are about powers of lambda.
        let point = (self.lambda, used.max(0.3));
        if used < 1.0 {
            self.within = Some(point);
        } else {
            self.beyond = Some(point);
        }
        const AIM: f64 = 0.985;
        self.lambda *= match (self.within, self.beyond) {
            (Some((within, less)), Some((beyond, more))) => {
                let part = libm::log(AIM / less) / libm::log(more / less);
                within / self.lambda * libm::pow(beyond / within, part.clamp(0.15, 0.85))
            }
            _ => (AIM / used.max(0.1)).clamp(0.25, 4.0),
        };
        false
    }
}
