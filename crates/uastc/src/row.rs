//! The blocks of one row of an image, searched in groups of as many blocks as a vector has lanes.
//!
//! A search step gathers the blocks that need it, wherever they stand in the row, so that all lanes do useful work.
//! Steps that differ by mode gather blocks of equal mode.

use fearless_simd::{Simd, prelude::*};

use crate::blocks::Blocks;
use crate::direction::normals;
use crate::lanes::{Grid, Texels, channels};
use crate::pack::Block;
use crate::tables::{MODE_0, MODES};
use crate::{Effort, Metric, normals as directions, search};
use texel_simd::{LANES, Real, Wide};

/// The texels of a row of blocks, and the best blocks found for them so far.
pub(crate) struct Row {
    pub texels: Vec<Texels>,
    pub blocks: Vec<Block>,
}

impl Row {
    pub fn new(texels: Vec<Texels>) -> Self {
        let blocks = vec![Block::empty(&MODE_0); texels.len()];
        Self { texels, blocks }
    }

    /// Searches the blocks at `indices`.
    #[inline(always)]
    pub fn search<S: Simd>(&mut self, simd: S, indices: &[usize], metric: Metric, effort: Effort) {
        match (metric, effort) {
            (Metric::Direction, effort) => self.search_directions(simd, indices, effort),
            (_, Effort::Fast) => self.search_colours_fast(simd, indices, &metric.scale()),
            (_, Effort::Best) => self.search_colours_best(simd, indices, &metric.scale()),
        }
    }

    /// Searches blocks of normals: lines and planes through x and y, then endpoints and weights by direction.
    #[inline(always)]
    fn search_directions<S: Simd>(&mut self, simd: S, indices: &[usize], effort: Effort) {
        self.replace_by_groups(
            indices,
            #[inline(always)]
            |texels, _| directions::fast_lines(simd, &channels(simd, texels)),
        );
        self.try_candidate(
            simd,
            &self.with_error_above(directions::GOOD_ERROR, indices),
            #[inline(always)]
            |winner, texels| winner.try_subsets(simd, &channels(simd, texels), &[1.0; 2]),
        );
        // A second round of `Fast` would gain 2.4 % of the angle and take 19 % more time.
        let rounds = if effort == Effort::Best { 2 } else { 1 };
        self.change_by_kind(
            simd,
            indices,
            #[inline(always)]
            |blocks, texels| fit_directions(simd, blocks, texels, rounds, 0),
        );
        if effort == Effort::Best {
            self.replace_by_groups(
                indices,
                #[inline(always)]
                |texels, blocks| directions::best(simd, &channels(simd, texels), Blocks::load(simd, blocks)),
            );
            self.change_by_kind(
                simd,
                indices,
                #[inline(always)]
                |blocks, texels| fit_directions(simd, blocks, texels, 0, 2),
            );
        }
    }

    /// Searches blocks of colours quickly: a line each, then the candidates that may beat this line.
    #[inline(always)]
    fn search_colours_fast<S: Simd>(&mut self, simd: S, indices: &[usize], scale: &[f32; 3]) {
        let (green, colourful): (Vec<_>, Vec<_>) =
            indices.iter().copied().partition(|&k| only_green_varies(&self.texels[k]));
        self.replace_by_groups(
            &green,
            #[inline(always)]
            |texels, _| search::fast_green(simd, &colours(simd, texels, scale), scale),
        );
        let [planes, grey] = self.replace_and_select(
            &colourful,
            #[inline(always)]
            |texels| search::fast_lines(simd, &colours(simd, texels, scale), scale),
        );
        self.try_candidate(
            simd,
            &planes,
            #[inline(always)]
            |winner, texels| winner.try_planes(simd, &colours(simd, texels, scale), scale),
        );
        self.try_candidate(
            simd,
            &self.with_error_above(search::GOOD_ERROR, indices),
            #[inline(always)]
            |winner, texels| winner.try_subsets(simd, &colours(simd, texels, scale), scale),
        );
        self.try_candidate(
            simd,
            &grey,
            #[inline(always)]
            |winner, texels| winner.try_grey(simd, &colours(simd, texels, scale), scale, 1),
        );
    }

    /// Searches blocks of colours thoroughly: all modes that pay, then the endpoints of the winner one by one.
    #[inline(always)]
    fn search_colours_best<S: Simd>(&mut self, simd: S, indices: &[usize], scale: &[f32; 3]) {
        self.replace_by_groups(
            indices,
            #[inline(always)]
            |texels, _| search::best_rgb(simd, &colours(simd, texels, scale), scale),
        );
        self.change_by_kind(
            simd,
            indices,
            #[inline(always)]
            |blocks, texels| blocks.polish(simd, &colours(simd, texels, scale), scale, 2),
        );
    }

    /// Replaces the blocks at `indices` by those that `make` makes from the texels of a group. `make` also returns `N`
    /// masks of lanes; the result lists, for each mask, the indices of the blocks in its lanes.
    #[inline(always)]
    fn replace_and_select<S: Simd, const N: usize>(
        &mut self,
        indices: &[usize],
        make: impl Fn([&Texels; LANES]) -> (Blocks<S>, [<Wide<S> as Real>::Mask; N]),
    ) -> [Vec<usize>; N] {
        let mut selected = [const { Vec::new() }; N];
        for (group, at) in groups(indices) {
            let (made, masks) = make(at.map(|k| &self.texels[k]));
            let made = made.store();
            for (lane, &k) in group.iter().enumerate() {
                self.blocks[k] = made.block(lane);
            }
            for (selected, mask) in selected.iter_mut().zip(masks) {
                let bits = mask.to_bitmask();
                selected.extend(group.iter().enumerate().filter(|(j, _)| bits >> j & 1 == 1).map(|(_, &k)| k));
            }
        }
        selected
    }

    /// Returns those of `indices` whose blocks have errors above `limit`.
    fn with_error_above(&self, limit: f32, indices: &[usize]) -> Vec<usize> {
        indices.iter().copied().filter(|&k| self.blocks[k].error > limit).collect()
    }

    /// Replaces the blocks at `indices` where `search` finds better ones. `search` is given empty blocks that carry the
    /// errors so far.
    ///
    /// `indices` should list only blocks that the candidate may suit. Among neighbours a candidate nearly always suits
    /// one lane and hardly ever all of them.
    #[inline(always)]
    fn try_candidate<S: Simd>(
        &mut self,
        simd: S,
        indices: &[usize],
        search: impl Fn(&mut Blocks<S>, [&Texels; LANES]),
    ) {
        for (group, at) in groups(indices) {
            let error = Wide::simd_from(simd, at.map(|k| self.blocks[k].error));
            let mut winner = Blocks { error, ..Blocks::none(simd) };
            search(&mut winner, at.map(|k| &self.texels[k]));
            let winner = winner.store();
            for (lane, &k) in group.iter().enumerate() {
                if winner.errors[lane] < self.blocks[k].error {
                    self.blocks[k] = winner.block(lane);
                }
            }
        }
    }

    /// Replaces the blocks at `indices` by those that `make` makes from the texels and the blocks of a group.
    #[inline(always)]
    fn replace_by_groups<S: Simd>(
        &mut self,
        indices: &[usize],
        make: impl Fn([&Texels; LANES], [&Block; LANES]) -> Blocks<S>,
    ) {
        for (group, at) in groups(indices) {
            let made = make(at.map(|k| &self.texels[k]), at.map(|k| &self.blocks[k])).store();
            for (lane, &k) in group.iter().enumerate() {
                self.blocks[k] = made.block(lane);
            }
        }
    }

    /// Changes the blocks at `indices`, in groups of equal mode and selector.
    #[inline(always)]
    fn change_by_kind<S: Simd>(
        &mut self,
        simd: S,
        indices: &[usize],
        change: impl Fn(&mut Blocks<S>, [&Texels; LANES]),
    ) {
        // Selectors are 0 to 3.
        let mut kinds = vec![Vec::new(); 4 * MODES];
        for &k in indices {
            let block = &self.blocks[k];
            kinds[4 * usize::from(block.mode.number) + block.selector].push(k);
        }
        for kind in kinds {
            self.replace_by_groups(
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

/// Cuts `indices` into groups for the lanes of a vector. Each group comes twice: as a slice, and filled up to all lanes
/// with its last member.
pub(crate) fn groups(indices: &[usize]) -> impl Iterator<Item = (&[usize], [usize; LANES])> {
    indices.chunks(LANES).map(|group| (group, std::array::from_fn(|j| group[j.min(group.len() - 1)])))
}

/// Returns whether red and blue are constant.
#[inline(always)]
fn only_green_varies(texels: &Texels) -> bool {
    let first = u32::from_le_bytes(texels[0]);
    let varying = texels.iter().fold(0, |varying, texel| varying | (u32::from_le_bytes(*texel) ^ first));
    let [red, _, blue, _] = varying.to_le_bytes();
    red | blue == 0
}

/// Returns the levels of red, green and blue, multiplied by `scale`.
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

/// Fits blocks to the normals that `texels` encode, by [`Blocks::fit_directions`].
#[inline(always)]
fn fit_directions<S: Simd>(simd: S, blocks: &mut Blocks<S>, texels: [&Texels; LANES], rounds: usize, passes: usize) {
    blocks.fit_directions(simd, &normals(&channels(simd, texels)), rounds, passes);
}
