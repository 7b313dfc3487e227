//! Fits the lobes of coarse levels to the level-0 texels of their footprints.
//!
//! Lobes that are merged from level to level drift, most where two populations meet: mirror tiles beside rough grout.
//! A fit begins at level 0 again and goes by the lobe error. `cargo run --release -p studies --bin levels` prints the
//! errors of both qualities, level by level.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::codec::uastc::Effort;
use crate::lobe::{Family, LobeTexel, OrientedLobe};
use crate::math::vector::dot;
use crate::metric::{DRAWN, DrawnFootprint, FitEffort, Search, fit};
use crate::mip::{FinerRows, MipTail, TexelRows, level_sizes};

/// Which texels of a level are fitted, and how.
struct LevelFit {
    /// The level whose texels are the parts of uneven texels: those whose finer texels [`differ`], at this level or
    /// below.
    uneven_parts: usize,
    /// The level whose texels are the parts of all other texels; `None` if these keep their merged lobes.
    even_parts: Option<usize>,
    /// Strata of these texels along each axis of a footprint.
    strata: u32,
    effort: FitEffort,
}

/// Ratio of the alphas of finer texels from which their merged lobe can be far from the best lobe.
const UNEVEN: f32 = 4.0;
/// This ratio, where a normal is further from that of the narrowest lobe than half the alpha of this lobe.
const UNEVEN_APART: f32 = 2.0;

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
    level_fit((1, None), DRAWN, 64, Search { rounds: 4, ..SHORT }, 0),
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
    let (mut finer_uneven, first_kept) = (Vec::new(), tail.first_kept());
    for level in FIRST..sizes.len() {
        let fit = &fits[(level - FIRST).min(fits.len() - 1)];
        let (size, finer_size) = (sizes[level], sizes[level - 1]);
        let is_uneven: Vec<AtomicBool> = (0..size.0 * size.1).map(|_| AtomicBool::default()).collect();
        tail.update_level(level_0, level, |y, finer, out| {
            let is_uneven = &is_uneven[(y * size.0) as usize..][..out.len()];
            if needs_marks {
                let rows = |first: u32, out: &mut [_]| finer(level - 1, first, out);
                mark_uneven(&rows, finer_size, &finer_uneven, y, is_uneven);
            }
            let is_uneven: Vec<bool> = is_uneven.iter().map(|flag| flag.load(Ordering::Relaxed)).collect();
            for (uneven, parts) in [(true, Some(fit.uneven_parts)), (false, fit.even_parts)] {
                let Some(parts) = parts.filter(|_| is_uneven.contains(&uneven)) else { continue };
                let parts = if parts == 0 { 0 } else { parts.max(first_kept.min(level - 2)) };
                let is_fitted = |x: u32| is_uneven[x as usize] == uneven;
                fit_row(finer, (parts, sizes[parts]), (y, size), family, fit, is_fitted, out);
            }
        });
        finer_uneven = is_uneven.into_iter().map(AtomicBool::into_inner).collect();
    }
}

/// Marks those texels of row `y` of a level whose four finer texels [`differ`], or of which one is marked in
/// `finer_marks`. `finer` writes adjacent rows of the finer level, which has `size` texels.
fn mark_uneven<T: LobeTexel>(
    finer: &dyn Fn(u32, &mut [T]),
    size: (u32, u32),
    finer_marks: &[bool],
    y: u32,
    marks: &[AtomicBool],
) {
    let rows = [2 * y, (2 * y + 1).min(size.1 - 1)];
    let mut texels = vec![T::default(); size.0 as usize * (1 + (rows[1] - rows[0]) as usize)];
    finer(rows[0], &mut texels);
    for (x, mark) in (0..).zip(marks) {
        let columns = [2 * x, (2 * x + 1).min(size.0 - 1)];
        let places = [0, 1, 2, 3].map(|i| (columns[i % 2], rows[i / 2]));
        let lobe = |(x, y): (u32, u32)| *texels[((y - rows[0]) * size.0 + x) as usize].lobe();
        let is_marked = |(x, y): (u32, u32)| finer_marks.get((y * size.0 + x) as usize) == Some(&true);
        mark.store(differ(&places.map(lobe)) || places.into_iter().any(is_marked), Ordering::Relaxed);
    }
}

/// Returns whether the merged lobe of `lobes` can be far from their best lobe. Lobes with nearly the same normal merge
/// well up to a larger ratio of alphas.
fn differ(lobes: &[OrientedLobe; 4]) -> bool {
    // The determinant of squared alphas is the fourth power of alpha. The least alpha is 0.001.
    let widths = lobes.map(|lobe| lobe.squared_alpha.0.determinant().max(1e-12));
    let narrowest = (0..4).fold(0, |least, i| if widths[i] < widths[least] { i } else { least });
    let least = widths[narrowest];
    let ratio = widths.into_iter().fold(0.0, f32::max) / least;
    let is_apart = |lobe: &OrientedLobe| {
        let between = [0, 1, 2].map(|i| lobe.normal[i] - lobes[narrowest].normal[i]);
        dot(between, between) > 0.25 * least.sqrt()
    };
    ratio > UNEVEN.powi(4) || (ratio > UNEVEN_APART.powi(4) && lobes.iter().any(is_apart))
}

/// Fits texels of row `y` of a level of `size`, from the lobes in `out`. The parts are texels of the level
/// `part_level`, which has the size `whole`; `finer` writes its rows.
fn fit_row<T: LobeTexel>(
    finer: &FinerRows<'_, T>,
    (part_level, whole): (usize, (u32, u32)),
    (y, size): (u32, (u32, u32)),
    family: Family,
    LevelFit { strata, effort, .. }: &LevelFit,
    is_fitted: impl Fn(u32) -> bool,
    out: &mut [T],
) {
    let footprint = |x| DrawnFootprint { whole, size, texel: (x, y), strata: *strata };
    let rows = footprint(0).rows();
    let mut texels = vec![T::default(); whole.0 as usize * rows.len()];
    let mut unread = texels.as_mut_slice();
    for adjacent in rows.chunk_by(|above, below| above.0 + 1 == below.0) {
        let (band, rest) = unread.split_at_mut(whole.0 as usize * adjacent.len());
        finer(part_level, adjacent[0].0, band);
        unread = rest;
    }
    let mut parts = Vec::new();
    for (x, texel) in (0..).zip(out).filter(|(x, _)| is_fitted(*x)) {
        parts.clear();
        for ((row, share), texels) in rows.iter().zip(texels.chunks_exact(whole.0 as usize)) {
            parts.extend(footprint(x).columns(*row).into_iter().map(|(column, weight)| {
                let part = &texels[column as usize];
                (weight * share * part.reflectance(), *part.lobe())
            }));
        }
        let total: f32 = parts.iter().map(|part| part.0).sum();
        parts.iter_mut().for_each(|part| part.0 /= total);
        let first = (y * size.0 + x) as usize * effort.half_vectors;
        texel.set_lobe(fit(family, &parts, *texel.lobe(), *effort, first));
    }
}

#[cfg(test)]
mod tests;
