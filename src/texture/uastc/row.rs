//! The blocks of one row, searched eight at a time.
//!
//! Blocks that stand beside each other are searched together; then, since a last step differs by mode, blocks of equal mode
//! are.

use fearless_simd::Simd;

use super::blocks::Blocks;
use super::direction::normals;
use super::lanes::{Grid, Texels, channels};
use super::pack::Block;
use super::tables::{MODE_0, MODES};
use super::{Effort, Metric, normals as directions, search};
use crate::simd::LANES;

/// Blocks and where they come from.
pub(super) struct Row {
    pub texels: Vec<Texels>,
    pub blocks: Vec<Block>,
}

impl Row {
    pub fn new(texels: Vec<Texels>) -> Self {
        let blocks = vec![Block::empty(&MODE_0); texels.len()];
        Self { texels, blocks }
    }

    /// Finds the blocks at `which`, whose texels are opaque.
    #[inline(always)]
    pub fn search_opaque<S: Simd>(&mut self, simd: S, which: &[usize], metric: Metric, effort: Effort) {
        let scale = metric.scale();
        match (metric, effort) {
            (Metric::Direction, effort) => {
                self.by_eights(
                    which,
                    #[inline(always)]
                    |texels, _| directions::fast(simd, &channels(simd, texels)),
                );
                self.by_kind(
                    simd,
                    which,
                    #[inline(always)]
                    |blocks, texels| aim(simd, blocks, texels, 2, 0),
                );
                if effort == Effort::Best {
                    self.by_eights(
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
            (_, Effort::Fast) => self.by_eights(
                which,
                #[inline(always)]
                |texels, _| search::fast_rgb(simd, &colours(simd, texels, &scale), &scale),
            ),
            (_, Effort::Best) => {
                self.by_eights(
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

    /// Finds the blocks at `which` with alpha.
    #[inline(always)]
    pub fn search_rgba<S: Simd>(&mut self, simd: S, which: &[usize], effort: Effort) {
        self.by_eights(
            which,
            #[inline(always)]
            |texels, _| search::rgba(simd, &channels(simd, texels), effort == Effort::Best),
        );
    }

    /// Replaces the blocks at `which` by what `make` makes of eight of them and of their texels.
    #[inline(always)]
    fn by_eights<S: Simd>(&mut self, which: &[usize], make: impl Fn(&[Texels; LANES], [&Block; LANES]) -> Blocks<S>) {
        for (eight, at) in eights(which) {
            let made = make(&at.map(|k| self.texels[k]), at.map(|k| &self.blocks[k])).store();
            for (&k, block) in eight.iter().zip(made) {
                self.blocks[k] = block;
            }
        }
    }

    /// Changes the blocks at `which`, eight of one mode and selector at a time.
    #[inline(always)]
    fn by_kind<S: Simd>(&mut self, simd: S, which: &[usize], change: impl Fn(&mut Blocks<S>, &[Texels; LANES])) {
        // Selectors are 0 to 3.
        let mut kinds = vec![Vec::new(); 4 * MODES];
        for &k in which {
            let block = &self.blocks[k];
            kinds[4 * usize::from(block.mode.number) + block.selector].push(k);
        }
        for kind in kinds {
            self.by_eights(
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

/// `which` by eights, as they are and filled up with the last one.
pub(super) fn eights(which: &[usize]) -> impl Iterator<Item = (&[usize], [usize; LANES])> {
    which.chunks(LANES).map(|eight| (eight, std::array::from_fn(|j| eight[j.min(eight.len() - 1)])))
}

/// Levels, times `scale`.
#[inline(always)]
fn colours<S: Simd>(simd: S, texels: &[Texels; LANES], scale: &[f32; 3]) -> [Grid<S>; 3] {
    let mut levels: [Grid<S>; 3] = channels(simd, texels);
    for (levels, scale) in levels.iter_mut().zip(scale) {
        for level in levels {
            *level *= *scale;
        }
    }
    levels
}

/// [`Blocks::aim`] at the normals that `texels` stand for.
#[inline(always)]
fn aim<S: Simd>(simd: S, blocks: &mut Blocks<S>, texels: &[Texels; LANES], rounds: usize, passes: usize) {
    blocks.aim(simd, &normals(&channels(simd, texels)), rounds, passes);
}
