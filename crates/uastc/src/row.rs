//! The blocks of one row, searched as many at a time as a vector has lanes.
//!
//! Blocks that stand beside each other, as far as one search suits them, are searched together; then those that a
//! further candidate may suit; and, since a last step differs by mode, blocks of equal mode.

use fearless_simd::{Simd, prelude::*};

use crate::blocks::Blocks;
use crate::direction::normals;
use crate::lanes::{Grid, Texels, channels};
use crate::pack::Block;
use crate::tables::{MODE_0, MODES};
use crate::{Effort, Metric, normals as directions, search};
use texel_simd::{LANES, Real, Wide};

/// Blocks and where they come from.
pub(crate) struct Row {
    pub texels: Vec<Texels>,
    pub blocks: Vec<Block>,
}

impl Row {
    pub fn new(texels: Vec<Texels>) -> Self {
        let blocks = vec![Block::empty(&MODE_0); texels.len()];
        Self { texels, blocks }
    }

    /// Finds the blocks at `which`.
    #[inline(always)]
    pub fn search<S: Simd>(&mut self, simd: S, which: &[usize], metric: Metric, effort: Effort) {
        let scale = metric.scale();
        match (metric, effort) {
            (Metric::Direction, effort) => {
                self.by_groups(
                    which,
                    #[inline(always)]
                    |texels, _| directions::fast_lines(simd, &channels(simd, texels)),
                );
                self.offer(
                    simd,
                    &self.poor(which, directions::GOOD),
                    #[inline(always)]
                    |winner, texels| winner.offer_subsets(simd, &channels(simd, texels), &[1.0; 2]),
                );
                // A second round would gain 2.4 % of the angle and take 19 % of the time more.
                let rounds = if effort == Effort::Best { 2 } else { 1 };
                self.by_kind(
                    simd,
                    which,
                    #[inline(always)]
                    |blocks, texels| aim(simd, blocks, texels, rounds, 0),
                );
                if effort == Effort::Best {
                    self.by_groups(
                        which,
                        #[inline(always)]
                        |texels, blocks| directions::best(simd, &channels(simd, texels), Blocks::load(simd, blocks)),
                    );
                    self.by_kind(
                        simd,
                        which,
                        #[inline(always)]
                        |blocks, texels| aim(simd, blocks, texels, 0, 2),
                    );
                }
            }
            (_, Effort::Fast) => {
                let (green, others): (Vec<_>, Vec<_>) =
                    which.iter().copied().partition(|&k| is_green_alone(&self.texels[k]));
                self.by_groups(
                    &green,
                    #[inline(always)]
                    |texels, _| search::fast_green(simd, &colours(simd, texels, &scale), &scale),
                );
                let [planes, grey] = self.first(
                    &others,
                    #[inline(always)]
                    |texels| search::fast_lines(simd, &colours(simd, texels, &scale), &scale),
                );
                self.offer(
                    simd,
                    &planes,
                    #[inline(always)]
                    |winner, texels| winner.offer_planes(simd, &colours(simd, texels, &scale), &scale),
                );
                self.offer(
                    simd,
                    &self.poor(which, search::GOOD),
                    #[inline(always)]
                    |winner, texels| winner.offer_subsets(simd, &colours(simd, texels, &scale), &scale),
                );
                self.offer(
                    simd,
                    &grey,
                    #[inline(always)]
                    |winner, texels| winner.offer_grey(simd, &colours(simd, texels, &scale), &scale, 1),
                );
            }
            (_, Effort::Best) => {
                self.by_groups(
                    which,
                    #[inline(always)]
                    |texels, _| search::best_rgb(simd, &colours(simd, texels, &scale), &scale),
                );
                self.by_kind(
                    simd,
                    which,
                    #[inline(always)]
                    |blocks, texels| blocks.polish(simd, &colours(simd, texels, &scale), &scale, 2),
                );
            }
        }
    }

    /// Replaces the blocks at `which` by the first ones that `make` makes of the texels of a group; and where, beside
    /// them, it tells that others may be better.
    #[inline(always)]
    fn first<S: Simd, const N: usize>(
        &mut self,
        which: &[usize],
        make: impl Fn([&Texels; LANES]) -> (Blocks<S>, [<Wide<S> as Real>::Mask; N]),
    ) -> [Vec<usize>; N] {
        let mut others = [const { Vec::new() }; N];
        for (group, at) in groups(which) {
            let (made, may_win) = make(at.map(|k| &self.texels[k]));
            let made = made.store();
            for (lane, &k) in group.iter().enumerate() {
                self.blocks[k] = made.block(lane);
            }
            for (others, may_win) in others.iter_mut().zip(may_win) {
                let bits = may_win.to_bitmask();
                others.extend(group.iter().enumerate().filter(|(j, _)| bits >> j & 1 == 1).map(|(_, &k)| k));
            }
        }
        others
    }

    /// Returns those of `which` whose blocks have errors above `good`.
    fn poor(&self, which: &[usize], good: f32) -> Vec<usize> {
        which.iter().copied().filter(|&k| self.blocks[k].error > good).collect()
    }

    /// Replaces the blocks at `which` where `offer` finds better ones; it is given empty blocks with the errors so far.
    /// Gathering the blocks that a candidate may suit keeps all lanes busy: among neighbours it suits one lane nearly
    /// always and all of them hardly ever.
    #[inline(always)]
    fn offer<S: Simd>(&mut self, simd: S, which: &[usize], offer: impl Fn(&mut Blocks<S>, [&Texels; LANES])) {
        for (group, at) in groups(which) {
            let error = Wide::simd_from(simd, at.map(|k| self.blocks[k].error));
            let mut winner = Blocks { error, ..Blocks::none(simd) };
            offer(&mut winner, at.map(|k| &self.texels[k]));
            let winner = winner.store();
            for (lane, &k) in group.iter().enumerate() {
                if winner.errors[lane] < self.blocks[k].error {
                    self.blocks[k] = winner.block(lane);
                }
            }
        }
    }

    /// Replaces the blocks at `which` by what `make` makes of a group of them and of their texels.
    #[inline(always)]
    fn by_groups<S: Simd>(&mut self, which: &[usize], make: impl Fn([&Texels; LANES], [&Block; LANES]) -> Blocks<S>) {
        for (group, at) in groups(which) {
            let made = make(at.map(|k| &self.texels[k]), at.map(|k| &self.blocks[k])).store();
            for (lane, &k) in group.iter().enumerate() {
                self.blocks[k] = made.block(lane);
            }
        }
    }

    /// Changes the blocks at `which`, a group of one mode and selector at a time.
    #[inline(always)]
    fn by_kind<S: Simd>(&mut self, simd: S, which: &[usize], change: impl Fn(&mut Blocks<S>, [&Texels; LANES])) {
        // Selectors are 0 to 3.
        let mut kinds = vec![Vec::new(); 4 * MODES];
        for &k in which {
            let block = &self.blocks[k];
            kinds[4 * usize::from(block.mode.number) + block.selector].push(k);
        }
        for kind in kinds {
            self.by_groups(
                &kind,
                #[inline(always)]
                |texels, blocks| {
                    let mut blocks = Blocks::load(simd, blocks);
                    change(&mut blocks, texels);
                    blocks
                },
            );
        }
    }
}

/// Cuts `which` into groups for the lanes of a vector: each group as it is, and filled up with its last member.
pub(crate) fn groups(which: &[usize]) -> impl Iterator<Item = (&[usize], [usize; LANES])> {
    which.chunks(LANES).map(|group| (group, std::array::from_fn(|j| group[j.min(group.len() - 1)])))
}

/// Returns whether only green varies.
#[inline(always)]
fn is_green_alone(texels: &Texels) -> bool {
    let first = u32::from_le_bytes(texels[0]);
    let varying = texels.iter().fold(0, |varying, texel| varying | (u32::from_le_bytes(*texel) ^ first));
    let [red, _, blue, _] = varying.to_le_bytes();
    red | blue == 0
}

/// Returns the levels of red, green and blue, times `scale`.
#[inline(always)]
fn colours<S: Simd>(simd: S, texels: [&Texels; LANES], scale: &[f32; 3]) -> [Grid<S>; 3] {
    let mut levels: [Grid<S>; 3] = channels(simd, texels);
    for (levels, scale) in levels.iter_mut().zip(scale) {
        for level in levels {
            *level *= *scale;
        }
    }
    levels
}

/// Fits blocks by direction to the normals that `texels` stand for ([`Blocks::aim`]).
#[inline(always)]
fn aim<S: Simd>(simd: S, blocks: &mut Blocks<S>, texels: [&Texels; LANES], rounds: usize, passes: usize) {
    blocks.aim(simd, &normals(&channels(simd, texels)), rounds, passes);
}
