//! Fewer bytes after zstd, for a bounded loss.
//!
//! zstd finds nothing in blocks that were fitted one by one: their bytes are next to random. Here each block may take
//! over bytes of a recent one: all of them, the weights with endpoints fitted anew, or the endpoints with weights
//! fitted anew. A block does so if that lowers its error plus lambda times the bits that zstd takes for it (Lagrangian
//! relaxation). One lambda for all blocks of a level is best for their sum; it is the largest within the loss that is
//! allowed.

mod bits;
mod donors;
mod look;
mod pass;
mod refit;

use fearless_simd::Level;
use rayon::prelude::*;

use texel_simd::dispatch;

use self::bits::Bits;
use self::look::{look, target};
use crate::image::{Image, SizeError};
use crate::lanes::{Lane, Texels};
use crate::unpack::unpack_rgb;
use crate::{BLOCK_BYTES, Metric};

type Block = [u8; BLOCK_BYTES];

/// Rows of blocks that are rewritten one after another. Bands are rewritten side by side and know nothing of each
/// other; 256 rows do no better.
const BAND_ROWS: usize = 32;

/// An image and what its errors cost.
struct Source<'a> {
    instructions: Level,
    image: &'a Image<'a>,
    metric: Metric,
}

/// Squared errors of an image: by its metric, and of red, green and blue evenly.
type Errors = [f64; 2];

/// Rewrites the blocks of an image so that zstd, or any compressor that finds repeated bytes, makes them smaller.
///
/// `blocks` are what [`Encoder::encode`](crate::Encoder::encode) made of the same `image` by the same `metric`. Neither
/// the error by `metric` nor that of red, green and blue grows by as much as `max_loss` dB, summed over all texels of
/// the image. Nothing is rewritten if `max_loss` is not above 0; blocks that can be exact as greys (mode 15) always
/// stay as they are. The bytes depend on neither the machine nor the number of threads; the work is done on those of
/// the current rayon pool.
///
/// # Errors
/// [`SizeError::Blocks`] if `blocks` are not as many as the image has.
pub fn lower_rate(
    blocks: &mut [[u8; BLOCK_BYTES]],
    image: &Image<'_>,
    metric: Metric,
    max_loss: f64,
) -> Result<(), SizeError> {
    lower_rate_with(Level::new(), blocks, image, metric, max_loss)
}

pub(crate) fn lower_rate_with(
    instructions: Level,
    blocks: &mut [[u8; BLOCK_BYTES]],
    image: &Image<'_>,
    metric: Metric,
    max_loss: f64,
) -> Result<(), SizeError> {
    image.check(blocks)?;
    if max_loss > 0.0 {
        Source { instructions, image, metric }.lower(blocks, max_loss);
    }
    Ok(())
}

impl Source<'_> {
    fn lower(&self, blocks: &mut [Block], loss: f64) {
        let bits = Bits::of(blocks.as_flattened());
        let bands = self.image.rows().div_ceil(BAND_ROWS);
        let mut lambda = 0.5 * self.errors(blocks, 1)[0] / (48 * blocks.len()) as f64;
        if bands >= 4 * SAMPLE {
            (lambda, _) = self.search(blocks, &bits, lambda, loss, SAMPLE);
        }
        if let (_, Some(rewritten)) = self.search(blocks, &bits, lambda, loss, 1) {
            blocks.copy_from_slice(&rewritten);
        }
    }

    /// Looks at every `step`th band for the largest lambda within the bound, from `lambda` on; and the blocks that it
    /// gives, if any are within.
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
        let band = BAND_ROWS * self.image.columns();
        blocks.par_chunks_mut(band).enumerate().step_by(step).for_each(|(k, blocks)| {
            let texels = |at: usize| self.image.block(k * band + at);
            dispatch!(instructions, simd => pass::pass(simd, blocks, &texels, self.metric, bits, lambda));
        });
    }

    /// The errors of the texels of every `step`th band, in a fixed order of addition.
    fn errors(&self, blocks: &[Block], step: usize) -> Errors {
        let columns = self.image.columns();
        let rows: Vec<Errors> = blocks
            .par_chunks(columns)
            .enumerate()
            .filter(|(row, _)| (row / BAND_ROWS).is_multiple_of(step))
            .map(|(row, blocks)| {
                let errors = blocks.iter().zip(row * columns..).map(|(block, at)| {
                    errors(block, &self.image.block(at), self.metric, |i| self.image.contains(at, i))
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
    let Some(unpacked) = unpack_rgb(block) else { return [0.0; 2] };
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
