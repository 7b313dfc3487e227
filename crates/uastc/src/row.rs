//! The blocks of one row of an image, searched in groups of as many blocks as a vector has lanes.
//!
//! A search step gathers the blocks that need it, wherever they stand in the row, so that all lanes do useful work.
//! Steps that differ by mode gather blocks of equal mode.

use fearless_simd::{Simd, prelude::*};

use crate::blocks::Blocks;
use crate::candidate::splat;
use crate::direction::{Refinement, SquaredDistances, normals};
use crate::lanes::{Grid, Texels, channels};
use crate::lobe::{BlockLobes, LobeErrors, Lobes, block_scale};
use crate::normals::{self as directions, Modes};
use crate::pack::Block;
use crate::tables::{MODE_0, MODES};
use crate::{Effort, Metric, alpha, search};
use texel_simd::{LANES, Real, Wide};

/// The texels of a row of blocks, and the best blocks found for them so far.
pub(crate) struct Row {
    pub texels: Vec<Texels>,
    /// The lobes of the texels; `None` if directions count alone.
    pub lobes: Option<Vec<BlockLobes>>,
    pub blocks: Vec<Block>,
}

/// What the blocks of a group are made from.
#[derive(Clone, Copy)]
struct Group<'a> {
    texels: [&'a Texels; LANES],
    lobes: Option<[&'a BlockLobes; LANES]>,
}

impl Row {
    pub fn new(texels: Vec<Texels>, lobes: Option<Vec<BlockLobes>>) -> Self {
        let blocks = vec![Block::empty(&MODE_0); texels.len()];
        Self { texels, lobes, blocks }
    }

    /// Returns what the blocks at `indices` are made from.
    #[inline(always)]
    fn group(&self, indices: [usize; LANES]) -> Group<'_> {
        Group {
            texels: indices.map(|k| &self.texels[k]),
            lobes: self.lobes.as_ref().map(|lobes| indices.map(|k| &lobes[k])),
        }
    }

    /// Searches the blocks at `indices`.
    #[inline(always)]
    pub fn search<S: Simd>(&mut self, simd: S, indices: &[usize], metric: Metric, effort: Effort) {
        if metric == Metric::Direction {
            return self.search_directions(simd, indices, effort);
        }
        let (opaque, with_alpha): (Vec<_>, Vec<_>) = indices.iter().copied().partition(|&k| is_opaque(&self.texels[k]));
        match effort {
            Effort::Fast => self.search_colours_fast(simd, &opaque, &metric.scale()),
            Effort::Best => self.search_colours_best(simd, &opaque, &metric.scale()),
        }
        // Only `Metric::Rgba` keeps alpha.
        if !with_alpha.is_empty() {
            self.search_alpha(simd, &with_alpha, effort);
        }
    }

    /// Searches blocks of normals.
    #[inline(always)]
    fn search_directions<S: Simd>(&mut self, simd: S, indices: &[usize], effort: Effort) {
        if effort == Effort::Fast {
            return self.search_directions_fast(simd, indices, 1);
        }
        // Blocks for lobes start with those that are best by squared distance, so that they are never worse.
        let lobes = self.lobes.take();
        self.search_directions_fast(simd, indices, 2);
        self.fit_modes(simd, indices, Modes::All);
        self.refine_normals(simd, indices, Refinement::passes(2));
        if lobes.is_some() {
            self.lobes = lobes;
            self.search_lobes_best(simd, indices);
        }
    }

    /// Searches blocks of normals quickly: lines and planes through x and y, then endpoints and weights by `rounds` of
    /// regression by direction.
    #[inline(always)]
    fn search_directions_fast<S: Simd>(&mut self, simd: S, indices: &[usize], rounds: usize) {
        let good_error = if self.lobes.is_some() { directions::GOOD_ERROR_FOR_LOBES } else { directions::GOOD_ERROR };
        // Compiled once, and not for each call.
        simd.vectorize(
            #[inline(always)]
            || {
                self.replace_by_groups(
                    indices,
                    #[inline(always)]
                    |group, _| fast_lines(simd, group),
                );
                self.try_candidate(
                    simd,
                    &self.with_error_above(good_error, indices),
                    #[inline(always)]
                    |winner, group| {
                        let (xy, scale) = scaled_xy(simd, group);
                        winner.try_subsets(simd, &xy, &scale);
                    },
                );
                // A second round of `Fast` would gain 2.4 % of the angle and take 19 % more time. With lobes, a second
                // round would gain 2.2 % of the total variation and take 27 % more time.
                self.refine_normals(simd, indices, Refinement::rounds(rounds));
            },
        );
    }

    /// Improves the blocks by the errors of lobes.
    ///
    /// A sum of total variations has more local minima than a sum of squares. The best block with one plane and the
    /// best block with two planes are therefore both refined, if one of them is not clearly worse.
    #[inline(always)]
    fn search_lobes_best<S: Simd>(&mut self, simd: S, indices: &[usize]) {
        /// Refinement hardly ever turns a block into the better one that starts with a larger ratio of errors.
        const CLEARLY_WORSE: f32 = 1.3;
        let refinement = Refinement { rounds: 0, hops: 1, passes: 2 };

        self.refine_normals(simd, indices, Refinement::rounds(0));
        let by_direction = self.blocks.clone();
        self.forget_errors(|block| block.mode.planes == 2);
        self.fit_modes(simd, indices, Modes::OnePlane);
        let mut others = std::mem::replace(&mut self.blocks, by_direction);
        self.forget_errors(|block| block.mode.planes == 1);
        self.fit_modes(simd, indices, Modes::TwoPlanes);
        self.keep_better(&mut others);
        let is_close = |&k: &usize| others[k].error < CLEARLY_WORSE * self.blocks[k].error;
        let close: Vec<usize> = indices.iter().copied().filter(is_close).collect();
        self.refine_normals(simd, indices, refinement);
        std::mem::swap(&mut self.blocks, &mut others);
        self.refine_normals(simd, &close, refinement);
        self.keep_better(&mut others);
    }

    /// Swaps blocks with those of `others` that have smaller errors.
    fn keep_better(&mut self, others: &mut [Block]) {
        let pairs = self.blocks.iter_mut().zip(others);
        pairs
            .filter(|(block, other)| other.error < block.error)
            .for_each(|(block, other)| std::mem::swap(block, other));
    }

    /// Lets any other block replace the blocks for which `is_excluded` holds.
    fn forget_errors(&mut self, is_excluded: impl Fn(&Block) -> bool) {
        self.blocks.iter_mut().filter(|block| is_excluded(block)).for_each(|block| block.error = f32::INFINITY);
    }

    /// Fits `modes` to normals and keeps what is better than the blocks so far.
    #[inline(always)]
    fn fit_modes<S: Simd>(&mut self, simd: S, indices: &[usize], modes: Modes) {
        // Compiled once, and not for each call.
        simd.vectorize(
            #[inline(always)]
            || {
                self.replace_by_groups(
                    indices,
                    #[inline(always)]
                    |group, blocks| best_directions(simd, Blocks::load(simd, blocks), group, modes),
                );
            },
        );
    }

    /// Refines the blocks of normals.
    #[inline(always)]
    fn refine_normals<S: Simd>(&mut self, simd: S, indices: &[usize], refinement: Refinement) {
        // Compiled once, and not for each call.
        simd.vectorize(
            #[inline(always)]
            || {
                self.change_by_kind(
                    simd,
                    indices,
                    #[inline(always)]
                    |blocks, group| fit_directions(simd, blocks, group, refinement),
                );
            },
        );
    }

    /// Searches blocks of colours quickly: a line each, then the candidates that may beat this line.
    #[inline(always)]
    fn search_colours_fast<S: Simd>(&mut self, simd: S, indices: &[usize], scale: &[f32; 3]) {
        let (green, colourful): (Vec<_>, Vec<_>) =
            indices.iter().copied().partition(|&k| only_green_varies(&self.texels[k]));
        self.replace_by_groups(
            &green,
            #[inline(always)]
            |group, _| search::fast_green(simd, &colours(simd, group.texels, scale), scale),
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
            |winner, group| winner.try_planes(simd, &colours(simd, group.texels, scale), scale),
        );
        self.try_candidate(
            simd,
            &self.with_error_above(search::GOOD_ERROR, indices),
            #[inline(always)]
            |winner, group| winner.try_subsets(simd, &colours(simd, group.texels, scale), &splat(simd, scale)),
        );
        self.try_candidate(
            simd,
            &grey,
            #[inline(always)]
            |winner, group| winner.try_grey(simd, &colours(simd, group.texels, scale), scale, 1),
        );
    }

    /// Searches blocks of colours thoroughly: all modes that pay, then the endpoints of the winner one by one.
    #[inline(always)]
    fn search_colours_best<S: Simd>(&mut self, simd: S, indices: &[usize], scale: &[f32; 3]) {
        self.replace_by_groups(
            indices,
            #[inline(always)]
            |group, _| search::best_rgb(simd, &colours(simd, group.texels, scale), scale),
        );
        self.change_by_kind(
            simd,
            indices,
            #[inline(always)]
            |blocks, group| blocks.polish::<3, 2>(simd, &colours(simd, group.texels, scale), scale, 2),
        );
    }

    /// Searches blocks of colours with alpha.
    #[inline(always)]
    fn search_alpha<S: Simd>(&mut self, simd: S, indices: &[usize], effort: Effort) {
        self.replace_by_groups(
            indices,
            #[inline(always)]
            |group, _| alpha::best_rgba(simd, &channels(simd, group.texels), effort),
        );
        if effort == Effort::Best {
            self.change_by_kind(
                simd,
                indices,
                #[inline(always)]
                |blocks, group| blocks.polish::<4, 3>(simd, &channels(simd, group.texels), &[1.0; 4], 2),
            );
        }
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
    fn try_candidate<S: Simd>(&mut self, simd: S, indices: &[usize], search: impl Fn(&mut Blocks<S>, Group<'_>)) {
        for (group, at) in groups(indices) {
            let error = Wide::simd_from(simd, at.map(|k| self.blocks[k].error));
            let mut winner = Blocks { error, ..Blocks::none(simd) };
            search(&mut winner, self.group(at));
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
        make: impl Fn(Group<'_>, [&Block; LANES]) -> Blocks<S>,
    ) {
        for (group, at) in groups(indices) {
            let made = make(self.group(at), at.map(|k| &self.blocks[k])).store();
            for (lane, &k) in group.iter().enumerate() {
                self.blocks[k] = made.block(lane);
            }
        }
    }

    /// Changes the blocks at `indices`, in groups of equal mode and selector.
    #[inline(always)]
    fn change_by_kind<S: Simd>(&mut self, simd: S, indices: &[usize], change: impl Fn(&mut Blocks<S>, Group<'_>)) {
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
                |group, blocks| {
                    let mut blocks = Blocks::load(simd, blocks);
                    change(&mut blocks, group);
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

/// Returns whether alpha is 255 in all texels.
fn is_opaque(texels: &Texels) -> bool {
    texels.iter().all(|texel| texel[3] == 255)
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

/// Fits blocks to the normals of `group` by [`Blocks::fit_directions`].
#[inline(always)]
fn fit_directions<S: Simd>(simd: S, blocks: &mut Blocks<S>, group: Group<'_>, refinement: Refinement) {
    let normals = normals(&channels(simd, group.texels));
    match group.lobes {
        None => blocks.fit_directions(simd, SquaredDistances(&normals), refinement),
        Some(lobes) => {
            let lobes = Lobes::load(simd, lobes, &normals);
            blocks.fit_directions(simd, LobeErrors { normals: &normals, lobes: &lobes }, refinement);
        }
    }
}

/// Returns x and y of the normals of `group` and what they are multiplied by: 1 without lobes.
#[inline(always)]
fn scaled_xy<S: Simd>(simd: S, group: Group<'_>) -> ([Grid<S>; 2], [Wide<S>; 2]) {
    let mut xy: [Grid<S>; 2] = channels(simd, group.texels);
    let Some(lobes) = group.lobes else { return (xy, splat(simd, &[1.0; 2])) };
    let scale = block_scale(simd, lobes);
    for (levels, scale) in xy.iter_mut().zip(scale) {
        for level in levels {
            *level *= scale;
        }
    }
    (xy, scale)
}

/// Finds blocks of one subset for the normals of `group` by [`directions::fast_lines`].
#[inline(always)]
fn fast_lines<S: Simd>(simd: S, group: Group<'_>) -> Blocks<S> {
    let (xy, scale) = scaled_xy(simd, group);
    directions::fast_lines(simd, &xy, &scale)
}

/// Searches `modes` for the normals of `group` by [`directions::best`], starting with the blocks `winner`.
#[inline(always)]
fn best_directions<S: Simd>(simd: S, winner: Blocks<S>, group: Group<'_>, modes: Modes) -> Blocks<S> {
    let (normals, (xy, scale)) = (normals(&channels(simd, group.texels)), scaled_xy(simd, group));
    match group.lobes {
        None => directions::best(simd, &xy, &scale, SquaredDistances(&normals), modes, winner),
        Some(lobes) => {
            let lobes = Lobes::load(simd, lobes, &normals);
            directions::best(simd, &xy, &scale, LobeErrors { normals: &normals, lobes: &lobes }, modes, winner)
        }
    }
}
