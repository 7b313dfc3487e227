//! Rewrites the blocks of one band.

use fearless_simd::Simd;

use super::bits::{BitModel, MatchState, SHORTEST_MATCH};
use super::points::{decoded_points, grids, source_points};
use super::recent::{Estimates, RecentBlock, RecentBlocks, SourceMoments};
use super::refit::{refit_endpoints, refit_weights};
use crate::Metric;
use crate::hints::Hints;
use crate::lanes::{ScalarGrid, Texels};
use crate::pack::Block;
use crate::tables::{MODE_0, MODE_6};
use crate::unpack::{Unpacked, unpack_rgb};

/// How many recent blocks are refitted with new endpoints, and how many with new weights.
const REFITTED: usize = 6;

/// The cheapest candidate for a block so far.
struct Choice {
    bytes: [u8; 16],
    /// The error, plus `lambda` times the bits.
    cost: f32,
    /// The state of the bit model after this candidate.
    after: MatchState,
}

/// What a block is made from.
struct Source<'a> {
    texels: &'a Texels,
    metric: Metric,
    /// The texels as points of the metric.
    points: [ScalarGrid; 3],
}

/// What candidates for one block cost.
struct CandidateCosts<'a> {
    bits: &'a BitModel,
    lambda: f32,
    /// Index of the block in its band.
    index: usize,
    /// The state of the bit model before the block.
    state: MatchState,
}

impl CandidateCosts<'_> {
    fn offset(&self, recent: &RecentBlock) -> u32 {
        (self.index - recent.index) as u32
    }

    /// Replaces `best` by `bytes`, which have the given `error` and may match the bytes of `recent`, if `bytes` cost
    /// less.
    fn keep_if_cheaper(&self, bytes: [u8; 16], error: f32, recent: &RecentBlock, best: &mut Choice) {
        if error >= best.cost {
            return;
        }
        let (bits, after) = self.bits.with_matches(&bytes, &recent.bytes, self.offset(recent), self.state);
        let cost = error + self.lambda * bits;
        if cost < best.cost {
            *best = Choice { bytes, cost, after };
        }
    }

    /// Tries the [`Self::nearest`] recent blocks after `fit` has changed each of them to suit `source`.
    #[inline(always)]
    fn try_refitted(
        &self,
        recent: &[RecentBlock],
        estimates: &[f32],
        extra_bits: impl Fn(&RecentBlock) -> f32,
        source: &Source<'_>,
        fit: impl Fn(&mut Block),
        best: &mut Choice,
    ) {
        for recent in self.nearest(recent, estimates, extra_bits).into_iter().flatten().map(|k| &recent[k]) {
            let Some(mut fitted) = recent.block.clone() else { continue };
            fit(&mut fitted);
            let error = decoded_points(source.metric, &fitted.levels()).error(&source.points);
            if error < best.cost {
                let hints = Hints::of(source.texels, fitted.mode);
                self.keep_if_cheaper(fitted.pack(&hints), error, recent, best);
            }
        }
    }

    /// Returns the indices of the recent blocks with the least estimated costs, followed by `None` if there are fewer
    /// than [`REFITTED`].
    #[inline(always)]
    fn nearest(
        &self,
        recent: &[RecentBlock],
        estimates: &[f32],
        extra_bits: impl Fn(&RecentBlock) -> f32,
    ) -> [Option<usize>; REFITTED] {
        let mut nearest = [(f32::INFINITY, None); REFITTED];
        for (k, (recent, estimate)) in recent.iter().zip(estimates).enumerate() {
            if *estimate >= nearest[REFITTED - 1].0 {
                continue;
            }
            let bits = self.state.bits_of_match(self.offset(recent)) + extra_bits(recent);
            let estimate = estimate + self.lambda * bits;
            let mut at = REFITTED;
            while at > 0 && estimate < nearest[at - 1].0 {
                at -= 1;
            }
            if at < REFITTED {
                nearest[at..].rotate_right(1);
                nearest[at] = (estimate, Some(k));
            }
        }
        nearest.map(|(_, k)| k)
    }
}

/// Returns whether two blocks share bytes at one end that zstd could match. Most pairs share none and need no further
/// comparison.
fn may_match(a: &[u8; 16], b: &[u8; 16]) -> bool {
    let differ = u128::from_le_bytes(*a) ^ u128::from_le_bytes(*b);
    differ.trailing_zeros() >= 16 || differ.leading_zeros() >= 8 * SHORTEST_MATCH
}

/// Rewrites the blocks of a band so that the sum of their errors and of `lambda` times their bits falls. `texels`
/// returns the source of the block at an index.
#[inline(always)]
pub(super) fn rewrite_band<S: Simd>(
    simd: S,
    blocks: &mut [[u8; 16]],
    texels: &dyn Fn(usize) -> Texels,
    metric: Metric,
    bits: &BitModel,
    lambda: f32,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut recent = RecentBlocks::new();
            let mut estimates = Estimates::new();
            let mut state = MatchState::default();
            for (index, block) in blocks.iter_mut().enumerate() {
                let Some(unpacked) = unpack_rgb(block) else {
                    state = state.closed();
                    continue;
                };
                let costs = CandidateCosts { bits, lambda, index, state };
                let texels = texels(index);
                let source = Source { texels: &texels, metric, points: source_points(metric, &grids(&texels)) };
                let best = cheapest(*block, &unpacked, &source, &costs, &recent, &mut estimates);
                *block = best.bytes;
                state = best.after;
                recent.add(best.bytes, index, metric);
            }
        },
    );
}

/// Returns the cheapest candidate for a block: `original`, or one that reuses bytes of a recent block.
#[inline(always)]
fn cheapest(
    original: [u8; 16],
    unpacked: &Unpacked,
    source: &Source<'_>,
    costs: &CandidateCosts<'_>,
    recent: &RecentBlocks,
    estimates: &mut Estimates,
) -> Choice {
    let metric = source.metric;
    let error = decoded_points(metric, &unpacked.levels()).error(&source.points);
    let cost = error + costs.lambda * costs.bits.literals(&original);
    let mut best = Choice { bytes: original, cost, after: costs.state.closed() };
    recent.estimate(&source.points, &SourceMoments::of(&source.points), estimates);

    // The original bytes, or all bytes of a recent block.
    for (recent, &copied_error) in recent.all().iter().zip(&estimates.copied) {
        if may_match(&original, &recent.bytes) {
            costs.keep_if_cheaper(original, error, recent, &mut best);
        }
        costs.keep_if_cheaper(recent.bytes, copied_error, recent, &mut best);
    }

    // The weights of a recent block with new endpoints.
    costs.try_refitted(
        recent.all(),
        &estimates.same_weights,
        |_| 0.0,
        source,
        #[inline(always)]
        |block| refit_endpoints(block, metric, &source.points),
        &mut best,
    );

    // The endpoints of a recent block with new weights.
    if let Unpacked::Block(block) = unpacked {
        estimate_same_pattern(block, error, recent.all(), &mut estimates.same_endpoints);
    }
    // A block with other hints differs in its first bytes.
    let hints = [&MODE_0, &MODE_6].map(|mode| Hints::of(source.texels, mode).bits(mode));
    let header_bits = costs.bits.literals(&original[..3]);
    let extra_bits = |recent: &RecentBlock| if hints.contains(&recent.hints) { 0.0 } else { header_bits };
    costs.try_refitted(
        recent.all(),
        &estimates.same_endpoints,
        extra_bits,
        source,
        #[inline(always)]
        |block| refit_weights(block, metric, &source.points),
        &mut best,
    );
    best
}

/// Estimates the errors of `block` with the endpoints of recent blocks that have several subsets and the mode and
/// pattern of `block`. [`RecentBlocks::estimate`] leaves out blocks of several subsets.
#[inline(always)]
fn estimate_same_pattern(block: &Block, error: f32, recent: &[RecentBlock], estimates: &mut [f32]) {
    if block.mode.subsets == 1 {
        return;
    }
    for (recent, estimate) in recent.iter().zip(estimates) {
        if let Some(other) = &recent.block
            && other.mode.subsets > 1
            && other.mode.code == block.mode.code
            && other.pattern == block.pattern
        {
            *estimate = error + block.distance(other);
        }
    }
}
