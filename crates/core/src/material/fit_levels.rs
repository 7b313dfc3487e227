//! Fits the lobes of coarse levels to the level-0 texels of their footprints.
//!
//! Lobes that are merged from level to level drift, most where two populations meet: mirror tiles beside rough grout. A
//! fit begins at level 0 again and goes by the lobe error. Where merged lobes have the wrong width only, this alone is
//! fitted. `cargo run --release -p studies --bin levels` prints the errors of both qualities, level by level.

mod evenness;
mod footprint_row;

use std::sync::OnceLock;

use crate::codec::uastc::Effort;
use crate::lobe::{Family, LobeTexel};
use crate::metric::{DRAWN, FitEffort, Search, fit, fit_width};
use crate::mip::{MipTail, TexelRows, level_sizes};

use evenness::{Evenness, mark_row};
use footprint_row::{FootprintRow, Parts};

/// Which texels of a level are fitted, and how.
struct LevelFit {
    /// The level whose texels are the parts of uneven texels.
    uneven_parts: usize,
    /// The level whose texels are the parts of all other texels. If it is `None`, even texels keep their merged lobes,
    /// and texels of unequal widths get another width.
    even_parts: Option<usize>,
    /// Strata of these texels along each axis of a footprint.
    strata: u32,
    effort: FitEffort,
}

impl LevelFit {
    /// Returns the level of the parts to which texels of this evenness are fitted, if they are.
    fn parts_of(&self, evenness: Evenness) -> Option<usize> {
        match evenness {
            Evenness::Uneven => Some(self.uneven_parts),
            // The four texels of level 1 under a texel of level 2 are enough for a width.
            Evenness::UnequalWidths => self.even_parts.or(Some(self.uneven_parts.max(1))),
            Evenness::Even => self.even_parts,
        }
    }

    /// Returns whether texels of this evenness keep all of their merged lobe but its width.
    fn fits_width(&self, evenness: Evenness) -> bool {
        evenness == Evenness::UnequalWidths && self.even_parts.is_none()
    }
}

/// Fits of levels 2, 3, 4 and so on; the last one holds for all coarser levels. Coarser levels have fewer texels, which
/// can have more half-vectors in the same time. A merge is good enough for most texels of levels 2 to 4: on real maps
/// it is within 1.02 to 1.15 x of the best lobe there.
///
/// `fast` takes the lobes of level 1 as parts from level 3 on: they are in memory, they stand for the whole footprint
/// up to level 6, and a merge of four texels hardly drifts. For level 2 they are too few: four for each texel. Merges
/// of even texels drift less, so that the lobes of level 2, and from level 7 on of level 3, do as well for them.
/// Searches up to level 4 are short, since these levels have the most texels; docs/accuracy.md has what that costs and
/// saves. If level 1 is too large to be kept, as for 16384 x 16384, each of these levels would compute it again. Then
/// the first kept level stands for it wherever it has at least 4 x 4 texels for each fitted texel.
const FAST: [LevelFit; 7] = [
    level_fit((0, None), DRAWN, 64, SHORT, 0),
    level_fit((1, None), DRAWN, 64, SHORT, 0),
    level_fit((1, None), DRAWN, 128, Search { rounds: 4, ..SHORT }, 0),
    level_fit((1, Some(2)), DRAWN, 64, Search { descents: 1, ..LONG }, 0),
    level_fit((1, Some(2)), DRAWN, 128, Search { descents: 1, ..LONG }, 0),
    level_fit((1, Some(3)), DRAWN, 256, LONG, 4),
    level_fit((1, Some(3)), DRAWN, 512, LONG, 4),
];
const BEST: [LevelFit; 6] = [
    level_fit((0, Some(0)), DRAWN, 128, LONG, 0),
    level_fit((0, Some(0)), DRAWN, 256, LONG, 0),
    level_fit((0, Some(0)), DRAWN, 256, LONG, 0),
    level_fit((0, Some(0)), 2 * DRAWN, 512, LONG, 4),
    level_fit((0, Some(0)), 2 * DRAWN, 1024, LONG, 4),
    level_fit((0, Some(0)), 2 * DRAWN, 2048, LONG, 4),
];
const SHORT: Search = Search { descents: 1, rounds: 2 };
const LONG: Search = Search { descents: 2, rounds: 8 };

const fn level_fit(
    (uneven_parts, even_parts): (usize, Option<usize>),
    strata: u32,
    half_vectors: usize,
    search: Search,
    likelihood_steps: usize,
) -> LevelFit {
    LevelFit { uneven_parts, even_parts, strata, effort: FitEffort { half_vectors, search, likelihood_steps } }
}

/// The finest level that is fitted: the four texels under a texel of level 1 are too few.
const FIRST: usize = 2;

/// Replaces lobes of `tail`, a mip tail of `level_0`, by fitted lobes. Texels count by area x reflectance.
pub fn fit_levels<R: TexelRows<Texel: LobeTexel>>(
    level_0: &R,
    tail: &mut MipTail<R::Texel>,
    family: Family,
    quality: Effort,
) {
    let fits: &[LevelFit] = match quality {
        Effort::Fast => &FAST,
        Effort::Best => &BEST,
    };
    let needs_marks = fits.iter().any(|fit| fit.even_parts.is_none());
    let sizes = level_sizes(level_0.width(), level_0.height());
    let (mut finer_marks, first_kept) = (Vec::new(), tail.first_kept());
    for level in FIRST..sizes.len() {
        let level_fit = &fits[(level - FIRST).min(fits.len() - 1)];
        let LevelFit { strata, effort, .. } = *level_fit;
        let (size, finer_size) = (sizes[level], sizes[level - 1]);
        let marked: Vec<OnceLock<Vec<Evenness>>> = (0..size.1).map(|_| OnceLock::new()).collect();
        tail.update_level(level_0, level, |y, finer, out| {
            let mut marks = vec![Evenness::default(); out.len()];
            if needs_marks {
                let rows = |first: u32, out: &mut [_]| finer(level - 1, first, out);
                mark_row(&rows, finer_size, &finer_marks, y, &mut marks);
            }
            let wanted = |x: u32| level_fit.parts_of(marks[x as usize]);
            let fitted = |x: u32, parts: &Parts, lobe| {
                if level_fit.fits_width(marks[x as usize]) {
                    return fit_width(family, parts, lobe);
                }
                fit(family, parts, lobe, effort, (y * size.0 + x) as usize * effort.half_vectors)
            };
            let mut part_levels: Vec<usize> = (0..size.0).filter_map(wanted).collect();
            part_levels.sort_unstable();
            part_levels.dedup();
            for part_level in part_levels {
                let kept = if part_level == 0 { 0 } else { part_level.max(first_kept.min(level - 2)) };
                let footprints = FootprintRow { level: kept, whole: sizes[kept], y, size, strata };
                footprints.refit(finer, |x| wanted(x) == Some(part_level), fitted, out);
            }
            _ = marked[y as usize].set(marks);
        });
        finer_marks = marked.into_iter().flat_map(|row| row.into_inner().unwrap_or_default()).collect();
    }
}

#[cfg(test)]
mod tests;
