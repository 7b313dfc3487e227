//! The pass over one band of blocks.

use fearless_simd::Simd;

use super::bits::{Bits, LEAST, State};
use super::donors::{Donor, Donors, Estimates, Spread};
use super::lanes;
use super::look::{look, target};
use super::refit::{refit_endpoints, refit_weights};
use crate::Metric;
use crate::hints::Hints;
use crate::lanes::{Lane, Texels};
use crate::pack::Block;
use crate::tables::{MODE_0, MODE_6};
use crate::unpack::{Unpacked, unpack_rgb};

/// Donors that are fitted for each half.
const FITTED: usize = 6;

/// Bytes for a block.
struct Choice {
    bytes: [u8; 16],
    /// Error and `lambda` times bits.
    cost: f32,
    after: State,
}

/// What a block is made from.
struct Source<'a> {
    texels: &'a Texels,
    metric: Metric,
    /// What the metric asks for.
    goal: &'a [Lane; 3],
}

/// What candidates of one block are judged by.
struct Judge<'a> {
    bits: &'a Bits,
    lambda: f32,
    at: usize,
    state: State,
}

impl Judge<'_> {
    fn offset(&self, donor: &Donor) -> u32 {
        (self.at - donor.at) as u32
    }

    /// Takes `bytes` of the given `error` where they cost less than `best`.
    fn offer(&self, bytes: [u8; 16], error: f32, donor: &Donor, best: &mut Choice) {
        if error >= best.cost {
            return;
        }
        let (bits, after) = self.bits.with(&bytes, &donor.bytes, self.offset(donor), self.state);
        let cost = error + self.lambda * bits;
        if cost < best.cost {
            *best = Choice { bytes, cost, after };
        }
    }

    /// Offers the blocks of the [`Self::nearest`] donors, after `fit` has changed each to suit `source`.
    #[inline(always)]
    fn offer_nearest(
        &self,
        donors: &[Donor],
        estimates: &[f32],
        more: impl Fn(&Donor) -> f32,
        source: &Source<'_>,
        fit: impl Fn(&mut Block),
        best: &mut Choice,
    ) {
        for donor in self.nearest(donors, estimates, more).into_iter().flatten().map(|k| &donors[k]) {
            let Some(mut fitted) = donor.block.clone() else { continue };
            fit(&mut fitted);
            let error = look(source.metric, &fitted.levels()).error(source.goal);
            if error < best.cost {
                let hints = Hints::of(source.texels, fitted.mode);
                self.offer(fitted.pack(&hints), error, donor, best);
            }
        }
    }

    /// Returns the indices of the donors with the least estimates; `None` fills up if there are fewer.
    #[inline(always)]
    fn nearest(&self, donors: &[Donor], estimates: &[f32], more: impl Fn(&Donor) -> f32) -> [Option<usize>; FITTED] {
        let mut nearest = [(f32::INFINITY, None); FITTED];
        for (k, (donor, estimate)) in donors.iter().zip(estimates).enumerate() {
            if *estimate >= nearest[FITTED - 1].0 {
                continue;
            }
            let estimate = estimate + self.lambda * (self.state.of_match(self.offset(donor)) + more(donor));
            let mut at = FITTED;
            while at > 0 && estimate < nearest[at - 1].0 {
                at -= 1;
            }
            if at < FITTED {
                nearest[at..].rotate_right(1);
                nearest[at] = (estimate, Some(k));
            }
        }
        nearest.map(|(_, k)| k)
    }
}

/// Returns whether two blocks share bytes at an end that a match could take. Most do not, and are not looked at
/// further.
fn may_match(a: &[u8; 16], b: &[u8; 16]) -> bool {
    let differ = u128::from_le_bytes(*a) ^ u128::from_le_bytes(*b);
    differ.trailing_zeros() >= 16 || differ.leading_zeros() >= 8 * LEAST
}

/// Rewrites the blocks of a band, whose texels `texels` gives by the index of the block, so that the sum of errors and
/// `lambda` times bits falls.
#[inline(always)]
pub(super) fn pass<S: Simd>(
    simd: S,
    blocks: &mut [[u8; 16]],
    texels: &dyn Fn(usize) -> Texels,
    metric: Metric,
    bits: &Bits,
    lambda: f32,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut donors = Donors::new();
            let mut estimates = Estimates::new();
            let mut state = State::default();
            for (at, block) in blocks.iter_mut().enumerate() {
                let own = *block;
                let Some(unpacked) = unpack_rgb(&own) else {
                    state = state.closed();
                    continue;
                };
                let judge = Judge { bits, lambda, at, state };
                let texels = texels(at);
                let goal = target(metric, &lanes(&texels));
                let own_error = look(metric, &unpacked.levels()).error(&goal);
                let cost = own_error + lambda * bits.alone(&own);
                let mut best = Choice { bytes: own, cost, after: state.closed() };
                let source = Source { texels: &texels, metric, goal: &goal };

                let spread = Spread::of(&goal);
                donors.estimate(&goal, &spread, &mut estimates);
                for (donor, &whole) in donors.all().iter().zip(&estimates.whole) {
                    if may_match(&own, &donor.bytes) {
                        judge.offer(own, own_error, donor, &mut best);
                    }
                    judge.offer(donor.bytes, whole, donor, &mut best);
                }
                judge.offer_nearest(
                    donors.all(),
                    &estimates.weights,
                    |_| 0.0,
                    &source,
                    #[inline(always)]
                    |block| refit_endpoints(block, metric, &goal),
                    &mut best,
                );
                if let Unpacked::Block(own) = &unpacked
                    && own.mode.subsets > 1
                {
                    for (donor, estimate) in donors.all().iter().zip(&mut estimates.ends) {
                        if let Some(block) = &donor.block
                            && block.mode.subsets > 1
                            && block.mode.code == own.mode.code
                            && block.pattern == own.pattern
                        {
                            *estimate = own_error + own.distance(block);
                        }
                    }
                }
                // A block with other hints differs in its first bytes.
                let hints = [&MODE_0, &MODE_6].map(|mode| Hints::of(&texels, mode).bits(mode));
                let header = bits.alone(&own[..3]);
                let more = |donor: &Donor| if hints.contains(&donor.hints) { 0.0 } else { header };
                judge.offer_nearest(
                    donors.all(),
                    &estimates.ends,
                    more,
                    &source,
                    #[inline(always)]
                    |block| refit_weights(block, metric, &goal),
                    &mut best,
                );
                *block = best.bytes;
                state = best.after;
                donors.add(best.bytes, at, metric);
            }
        },
    );
}
