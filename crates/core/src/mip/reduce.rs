//! Computes the next coarser level with area-weighted boxes: 2 taps for even sizes, 3 taps for odd sizes (polyphase).

use fearless_simd::{Level as InstructionSet, Simd};
use rayon::prelude::*;

use crate::mip::merge::{MAX_PARTS, Merge, Numbers, merge_lanes};
use crate::mip::rows::TexelRows;
use crate::simd::{LANES, dispatch};

/// The most texels under one coarser texel along one axis.
const MAX_TAPS: usize = 3;

/// One level of a pyramid, rows top to bottom.
#[derive(Clone, Debug, PartialEq)]
pub struct Level<T> {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` texels.
    pub texels: Vec<T>,
}

impl<T: Merge> TexelRows for Level<T> {
    type Texel = T;

    fn width(&self) -> u32 {
        self.width
    }

    fn height(&self) -> u32 {
        self.height
    }

    fn row(&self, y: u32, out: &mut [T]) {
        out.copy_from_slice(self.row_texels(y));
    }
}

impl<T> Level<T> {
    /// Returns the texels of row `y`.
    pub(super) fn row_texels(&self, y: u32) -> &[T] {
        let width = self.width as usize;
        &self.texels[y as usize * width..][..width]
    }
}

/// Returns the size of the next coarser level along one axis: max(1, n / 2), as OpenGL, Vulkan and WebGPU define mip
/// chains.
pub fn level_size(size: u32) -> u32 {
    (size / 2).max(1)
}

/// Returns the sizes of all levels of a full mip chain, level 0 first, down to 1 x 1.
pub fn level_sizes(width: u32, height: u32) -> Vec<(u32, u32)> {
    let mut sizes = vec![(width, height)];
    let mut last = (width, height);
    while last != (1, 1) {
        last = (level_size(last.0), level_size(last.1));
        sizes.push(last);
    }
    sizes
}

/// Builds levels 1 and coarser of `source`, which is level 0. Returns no level for a source of 1 x 1.
pub fn build<R: TexelRows>(source: &R) -> Vec<Level<R::Texel>> {
    let sizes = level_sizes(source.width(), source.height());
    let mut levels: Vec<Level<R::Texel>> = Vec::with_capacity(sizes.len());
    while levels.len() + 1 < sizes.len() {
        let tail = &sizes[levels.len() + 1..];
        let next = match levels.last() {
            None => reduce(source, tail),
            Some(finer) => reduce(finer, tail),
        };
        levels.extend(next);
    }
    levels
}

/// Computes the first levels of `sizes` below `finer`: at least one, and as many as bands of rows do not share.
///
/// Each band computes all its levels while the finer levels are in the cache, so that one pass over memory suffices.
fn reduce<R: TexelRows>(finer: &R, sizes: &[(u32, u32)]) -> Vec<Level<R::Texel>> {
    let even = finer.height().trailing_zeros().min(MAX_BAND_LEVELS);
    let shared = (finer.height() / MIN_BANDS).checked_ilog2().unwrap_or(0);
    let fused = (even.min(shared) as usize).clamp(1, sizes.len());
    let mut levels: Vec<Level<R::Texel>> = sizes[..fused]
        .iter()
        .map(|&(width, height)| Level { width, height, texels: default_texels(width as usize * height as usize) })
        .collect();
    let bands = levels[fused - 1].height as usize;
    let mut parts: Vec<Vec<&mut [R::Texel]>> = (0..bands).map(|_| Vec::with_capacity(fused)).collect();
    for level in &mut levels {
        let rows = level.height as usize / bands;
        let chunks = level.texels.chunks_exact_mut(rows * level.width as usize);
        parts.iter_mut().zip(chunks).for_each(|(part, chunk)| part.push(chunk));
    }
    let simd = InstructionSet::new();
    parts.into_par_iter().enumerate().for_each_init(
        || finer_rows_for(finer, ROWS_TOGETHER),
        |rows, (band, mut levels)| {
            let (first, tail) = levels.split_at_mut(1);
            let first = &mut *first[0];
            let height = first.len() / sizes[0].0 as usize;
            reduce_rows(finer, (band * height) as u32, rows, first);
            // All heights beyond the first level of a band are even.
            let down = Taps::new(2, 0);
            let mut above: &[R::Texel] = first;
            for (level, texels) in tail.iter_mut().enumerate() {
                let (fine, coarse) = (sizes[level].0 as usize, sizes[level + 1].0 as usize);
                for (rows, out) in above.chunks_exact(2 * fine).zip(texels.chunks_exact_mut(coarse)) {
                    reduce_row(simd, rows, fine, &down, out);
                }
                above = texels;
            }
        },
    );
    levels
}

/// Returns room for the rows of `finer` under `rows` rows of the next coarser level, as [`reduce_rows`] needs it.
pub(super) fn finer_rows_for<R: TexelRows>(finer: &R, rows: usize) -> Vec<R::Texel> {
    // Each row has two rows above it. A map of odd height shares one more row between two rows, or has one row in all.
    let count = 2 * rows.min(ROWS_TOGETHER) + finer.height() as usize % 2;
    vec![R::Texel::default(); finer.width() as usize * count]
}

/// Computes row `first` of the level below `finer` and the rows below it, `out`. `rows` is scratch memory.
///
/// Rows of `finer` are read in groups, since rows that are computed from their neighbours are faster together.
pub(super) fn reduce_rows<R: TexelRows>(finer: &R, first: u32, rows: &mut [R::Texel], out: &mut [R::Texel]) {
    let (fine_width, width) = (finer.width() as usize, level_size(finer.width()) as usize);
    for (top, out) in (first..).step_by(ROWS_TOGETHER).zip(out.chunks_mut(width * ROWS_TOGETHER)) {
        let down = |y: usize| Taps::new(finer.height(), top + y as u32);
        let (top, last) = (down(0).first, down(out.len() / width - 1));
        let count = (last.first - top) as usize + last.count;
        finer.rows(top, &mut rows[..count * fine_width]);
        for (y, out) in out.chunks_exact_mut(width).enumerate() {
            let down = down(y);
            let rows = &rows[(down.first - top) as usize * fine_width..];
            reduce_row(InstructionSet::new(), rows, fine_width, &down, out);
        }
    }
}

/// Returns default texels, written by all threads. The first write to a page of memory waits until the system has
/// cleared the page, so that one thread would be slower.
fn default_texels<T: Merge>(count: usize) -> Vec<T> {
    (0..count).into_par_iter().with_min_len(1 << 14).map(|_| T::default()).collect()
}

/// Rows of a level that are computed from finer rows that were read together.
const ROWS_TOGETHER: usize = 8;

/// The most levels of a band. A band then has 32 rows of level 0; for 4096 columns of lobes, its levels 1 and 2 fit
/// into 1 MB.
const MAX_BAND_LEVELS: u32 = 5;

/// The least number of bands, which are distributed to threads.
const MIN_BANDS: u32 = 64;

/// Computes one row of coarser texels, `out`. `rows` holds the finer rows under this row, one after another.
pub(super) fn reduce_row<T: Merge>(simd: InstructionSet, rows: &[T], fine_width: usize, down: &Taps, out: &mut [T]) {
    let parts = down.count * Taps::new(fine_width as u32, 0).count;
    // Most rows have four parts. Scratch memory for nine parts would take time to clear.
    if parts == 4 {
        dispatch!(simd, simd => reduce_lanes::<_, T, 4>(simd, rows, fine_width, down, out));
    } else {
        dispatch!(simd, simd => reduce_lanes::<_, T, MAX_PARTS>(simd, rows, fine_width, down, out));
    }
}

#[inline(always)]
fn reduce_lanes<S: Simd, T: Merge, const MOST: usize>(
    simd: S,
    rows: &[T],
    fine_width: usize,
    down: &Taps,
    out: &mut [T],
) {
    let rows: [&[T]; MAX_TAPS] = std::array::from_fn(|tap| match tap < down.count {
        true => &rows[tap * fine_width..][..fine_width],
        false => &[],
    });
    let taps = Taps::new(fine_width as u32, 0).count;
    let mut weights = [[0.0; LANES]; MOST];
    let mut lanes = [T::Numbers::<[f32; LANES]>::all([0.0; LANES]); MOST];
    for (group, out) in out.chunks_mut(LANES).enumerate() {
        // Lanes beyond the last texel merge the last texel again.
        let last = out.len() - 1;
        let column = |lane: usize| group * LANES + lane.min(last);
        // Two taps have equal weights in all columns, so the weights of the first group hold for all groups.
        if group == 0 || taps > 2 {
            for lane in 0..LANES {
                let across = Taps::new(fine_width as u32, column(lane) as u32);
                for (index, weights) in weights.iter_mut().enumerate().take(down.count * taps) {
                    weights[lane] = down.weights[index / taps] * across.weights[index % taps];
                }
            }
        }
        let part = |tap: usize, lane: usize| rows[tap / taps][2 * column(lane) + tap % taps];
        merge_lanes::<_, T, MOST>(simd, &weights[..down.count * taps], part, &mut lanes, out);
    }
}

/// The finer texels under one coarser texel along one axis, with their weights.
pub(super) struct Taps {
    /// The first texel.
    pub first: u32,
    /// The number of texels.
    pub count: usize,
    weights: [f32; MAX_TAPS],
}

impl Taps {
    /// Returns the taps of coarser texel `i` on an axis of `size` finer texels. The coarser texel covers
    /// [i, i + 1) * size / level_size(size).
    pub fn new(size: u32, i: u32) -> Self {
        match (size, size % 2) {
            (1, _) => Self { first: 0, count: 1, weights: [1.0, 0.0, 0.0] },
            (_, 0) => Self { first: 2 * i, count: 2, weights: [0.5, 0.5, 0.0] },
            // For size = 2m + 1, the weights are (m - i), m and (i + 1), divided by size (S. Guthe, P. Heckbert,
            // "Non-power-of-two mipmap creation", 2005).
            _ => {
                let (m, n) = ((size / 2) as f32, size as f32);
                Self { first: 2 * i, count: 3, weights: [(m - i as f32) / n, m / n, (i as f32 + 1.0) / n] }
            }
        }
    }
}

#[cfg(test)]
mod tests;
