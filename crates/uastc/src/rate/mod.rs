//! Rate-distortion optimisation: rewrites blocks so that zstd compresses them better, within a bound on the loss.
//!
//! zstd finds hardly any matches in blocks that were fitted one by one, because their bytes are nearly random. Here a
//! block may reuse bytes of a recent block: all bytes, the weights with newly fitted endpoints, or the endpoints with
//! newly fitted weights. The cheapest candidate has the least error plus lambda times the bits that zstd needs for the
//! block (Lagrangian relaxation). All blocks of an image share one lambda, which is optimal for their sum. The search
//! looks for the largest lambda whose loss is within the bound.

mod bits;
mod pass;
mod points;
mod recent;
mod refit;

use fearless_simd::Level;
use rayon::prelude::*;

use texel_simd::dispatch;

use self::bits::BitModel;
use self::points::{decoded_points, grids, source_points};
use crate::image::{Image, SizeError};
use crate::lanes::Texels;
use crate::unpack::unpack_rgb;
use crate::{BLOCK_BYTES, Metric};

type Block = [u8; BLOCK_BYTES];

/// Rows of blocks in a band. Bands are rewritten in parallel and independently of each other. Bands of 256 rows save
/// no more bytes.
const BAND_ROWS: usize = 32;

/// The most passes of a search; four to six are usual.
const PASSES: usize = 8;

/// A search in an image of many bands starts with every fourth band, because passes over all bands take most of the
/// time.
const SAMPLE_STEP: usize = 4;

/// An image and how its errors are measured.
struct Source<'a> {
    instructions: Level,
    image: &'a Image<'a>,
    metric: Metric,
}

/// Squared errors of an image by two metrics: the metric of the encoder, and [`Metric::Rgb`].
type Errors = [f64; 2];

/// Rewrites the blocks of an image so that zstd, or any compressor that finds repeated bytes, makes them smaller.
///
/// `blocks` must be the result of [`Encoder::encode`](crate::Encoder::encode) for `image` with `metric`. Two errors are
/// summed over all texels of the image: the error by `metric` and the error by [`Metric::Rgb`]. Both grow by less than
/// `max_loss` dB. The lobes of an image do not count: each block is compared with 256 recent blocks, which only squared
/// distances make cheap. Nothing is rewritten if `max_loss` is not above 0. Blocks of grey and alpha (modes 15 to 17)
/// and blocks with alpha are never rewritten.
///
/// The work runs in parallel on the current rayon pool. The bytes depend neither on the machine nor on the number of
/// threads.
///
/// # Errors
/// Returns [`SizeError::Blocks`] if the image does not have exactly as many blocks.
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
    /// Implements [`lower_rate`] for a `max_loss` above 0.
    fn lower(&self, blocks: &mut [Block], max_loss: f64) {
        let bits = BitModel::new(blocks.as_flattened());
        let bands = self.image.rows().div_ceil(BAND_ROWS);
        let mut lambda = 0.5 * self.errors(blocks, 1)[0] / (48 * blocks.len()) as f64;
        if bands >= 4 * SAMPLE_STEP {
            (lambda, _) = self.search(blocks, &bits, lambda, max_loss, SAMPLE_STEP);
        }
        if let (_, Some(rewritten)) = self.search(blocks, &bits, lambda, max_loss, 1) {
            blocks.copy_from_slice(&rewritten);
        }
    }

    /// Searches for the largest lambda whose loss in every `step`th band is within the bound, starting at `lambda`.
    /// Returns this lambda and the rewritten blocks, or `None` if no lambda was within the bound.
    fn search(
        &self,
        blocks: &[Block],
        bits: &BitModel,
        lambda: f64,
        max_loss: f64,
        step: usize,
    ) -> (f64, Option<Vec<Block>>) {
        let before = self.errors(blocks, step);
        let allowed = libm::pow(10.0, 0.1 * max_loss);
        // The share of the allowed growth that is used; below 1 is within the bound.
        let used = |after: Errors| {
            let by = |k: usize| if after[k] > before[k] { (after[k] / before[k] - 1.0) / (allowed - 1.0) } else { 0.0 };
            by(0).max(by(1))
        };
        let mut search = LambdaSearch { lambda, within: None, beyond: None };
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
        // If no band could change, the search has learnt nothing about lambda.
        (if most_used > 0.0 { search.lambda } else { lambda }, best)
    }

    /// Rewrites every `step`th band.
    fn rewrite(&self, blocks: &mut [Block], bits: &BitModel, lambda: f32, step: usize) {
        let instructions = self.instructions;
        let band = BAND_ROWS * self.image.columns();
        blocks.par_chunks_mut(band).enumerate().step_by(step).for_each(|(k, blocks)| {
            let texels = |at: usize| self.image.block(k * band + at);
            dispatch!(instructions, simd => pass::rewrite_band(simd, blocks, &texels, self.metric, bits, lambda));
        });
    }

    /// Sums the errors of all texels of every `step`th band in a fixed order, so that the sum does not depend on
    /// threads.
    fn errors(&self, blocks: &[Block], step: usize) -> Errors {
        let columns = self.image.columns();
        let rows: Vec<Errors> = blocks
            .par_chunks(columns)
            .enumerate()
            .filter(|(row, _)| (row / BAND_ROWS).is_multiple_of(step))
            .map(|(row, blocks)| {
                let errors = blocks.iter().zip(row * columns..).map(|(block, index)| {
                    block_errors(block, &self.image.block(index), self.metric, |i| self.image.contains(index, i))
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

/// Returns the errors of the texels of a block that are inside of the image; 0 for blocks that are never rewritten.
fn block_errors(block: &Block, texels: &Texels, metric: Metric, is_inside: impl Fn(usize) -> bool) -> Errors {
    let Some(unpacked) = unpack_rgb(block) else { return [0.0; 2] };
    let (levels, source) = (unpacked.levels(), grids(texels));
    [metric, Metric::Rgb].map(|metric| {
        let each = decoded_points(metric, &levels).errors(&source_points(metric, &source));
        (0..16).filter(|&i| is_inside(i)).map(|i| f64::from(each[i])).sum()
    })
}

/// The state of a search for the largest lambda within the bound.
struct LambdaSearch {
    /// The lambda of the next pass.
    lambda: f64,
    /// The largest lambda found within the bound, and the share of the bound that it uses.
    within: Option<(f64, f64)>,
    /// The least lambda found beyond the bound, and the share of the bound that it uses.
    beyond: Option<(f64, f64)>,
}

impl LambdaSearch {
    /// Returns whether the search is done after a pass that used the share `used` of the bound. If the search is not
    /// done, chooses the lambda of the next pass.
    fn is_done(&mut self, used: f64) -> bool {
        if self.lambda == 0.0 || (0.97..1.0).contains(&used) {
            return true;
        }
        // A loss is roughly a power of lambda.
        let point = (self.lambda, used.max(0.3));
        if used < 1.0 {
            self.within = Some(point);
        } else {
            self.beyond = Some(point);
        }
        const AIM: f64 = 0.985;
        self.lambda *= match (self.within, self.beyond) {
            (Some((within, used_within)), Some((beyond, used_beyond))) => {
                let fraction = libm::log(AIM / used_within) / libm::log(used_beyond / used_within);
                within / self.lambda * libm::pow(beyond / within, fraction.clamp(0.15, 0.85))
            }
            _ => (AIM / used.max(0.1)).clamp(0.25, 4.0),
        };
        false
    }
}
