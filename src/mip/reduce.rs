//! The next coarser level: area-weighted boxes of 2 taps for even sizes, 3 for odd ones (polyphase boxes).

use fearless_simd::{Level as InstructionSet, Simd};
use rayon::prelude::*;

use crate::mip::Rows;
use crate::mip::merge::{MAX_PARTS, Merge, Numbers, merge_lanes};
use crate::simd::{LANES, dispatch};

/// Texels under one coarser texel along one axis: at most 3.
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

impl<T: Merge> Rows for Level<T> {
    type Texel = T;

    fn width(&self) -> u32 {
        self.width
    }

    fn height(&self) -> u32 {
        self.height
    }

    fn row(&self, y: u32, out: &mut [T]) {
        out.copy_from_slice(self.texels_of(y));
    }
}

impl<T> Level<T> {
    /// The texels of row `y`.
    pub(super) fn texels_of(&self, y: u32) -> &[T] {
        let width = self.width as usize;
        &self.texels[y as usize * width..][..width]
    }
}

/// Size of the next coarser level along one axis: max(1, n / 2), as OpenGL, Vulkan and WebGPU define mip chains.
pub fn level_size(size: u32) -> u32 {
    (size / 2).max(1)
}

/// Sizes of all levels of a full chain, level 0 first, down to 1 x 1.
pub fn level_sizes(width: u32, height: u32) -> Vec<(u32, u32)> {
    let mut sizes = vec![(width, height)];
    let mut last = (width, height);
    while last != (1, 1) {
        last = (level_size(last.0), level_size(last.1));
        sizes.push(last);
    }
    sizes
}

/// Levels 1 and coarser over `source`, which is level 0; empty for a source of 1 x 1.
pub fn build<R: Rows>(source: &R) -> Vec<Level<R::Texel>> {
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

/// The first levels of `sizes` over `finer`: as many as bands of rows have to themselves, at least one. A band's levels
/// are made while those before are in the cache: one pass over memory for all of them.
fn reduce<R: Rows>(finer: &R, sizes: &[(u32, u32)]) -> Vec<Level<R::Texel>> {
    let even = finer.height().trailing_zeros().min(BAND_LEVELS);
    let shared = (finer.height() / BANDS).checked_ilog2().unwrap_or(0);
    let fused = (even.min(shared) as usize).clamp(1, sizes.len());
    let mut levels: Vec<Level<R::Texel>> = sizes[..fused]
        .iter()
        .map(|&(width, height)| Level { width, height, texels: blank(width as usize * height as usize) })
        .collect();
    let bands = levels[fused - 1].height as usize;
    let mut parts: Vec<Vec<&mut [R::Texel]>> = (0..bands).map(|_| Vec::with_capacity(fused)).collect();
    for level in &mut levels {
        let rows = level.height as usize / bands;
        let chunks = level.texels.chunks_exact_mut(rows * level.width as usize);
        parts.iter_mut().zip(chunks).for_each(|(part, chunk)| part.push(chunk));
    }
    let fine_width = finer.width() as usize;
    let simd = InstructionSet::new();
    parts.into_par_iter().enumerate().for_each_init(
        || vec![R::Texel::default(); fine_width * MAX_TAPS],
        |rows, (band, mut levels)| {
            let (first, tail) = levels.split_at_mut(1);
            let first = &mut *first[0];
            let height = first.len() / sizes[0].0 as usize;
            for (y, out) in first.chunks_exact_mut(sizes[0].0 as usize).enumerate() {
                let down = Taps::new(finer.height(), (band * height + y) as u32);
                for (tap, row) in rows.chunks_exact_mut(fine_width).enumerate().take(down.count) {
                    finer.row(down.first + tap as u32, row);
                }
                reduce_row(simd, rows, fine_width, &down, out);
            }
            // Only even heights are fused beyond the first level.
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

/// Default texels, written by all threads: whoever writes to memory first waits while the system clears it.
fn blank<T: Merge>(count: usize) -> Vec<T> {
    (0..count).into_par_iter().with_min_len(1 << 14).map(|_| T::default()).collect()
}

/// Levels that a band makes at most: 32 rows of level 0, whose level 1 and 2 fit into 1 MB for 4096 columns of lobes.
const BAND_LEVELS: u32 = 5;

/// Bands that there are at least, to be shared among threads.
const BANDS: u32 = 64;

/// `rows` holds the finer rows under this row, one after another; `out` the coarser texels.
pub(super) fn reduce_row<T: Merge>(simd: InstructionSet, rows: &[T], fine_width: usize, down: &Taps, out: &mut [T]) {
    let parts = down.count * Taps::new(fine_width as u32, 0).count;
    // Four parts are the rule; room for more would be cleared for nothing.
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
        // Beyond the last texel it is merged again.
        let last = out.len() - 1;
        let column = |lane: usize| group * LANES + lane.min(last);
        // Of two taps both count for half, everywhere.
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

/// The finer texels under one coarser texel along one axis.
pub(super) struct Taps {
    /// The first of them.
    pub first: u32,
    /// How many.
    pub count: usize,
    weights: [f32; MAX_TAPS],
}

impl Taps {
    /// MipTail texel `i` of an axis of `size` finer texels covers [i, i + 1) * size / level_size(size).
    pub fn new(size: u32, i: u32) -> Self {
        match (size, size % 2) {
            (1, _) => Self { first: 0, count: 1, weights: [1.0, 0.0, 0.0] },
            (_, 0) => Self { first: 2 * i, count: 2, weights: [0.5, 0.5, 0.0] },
            // size = 2m + 1: the areas (m - i), m, (i + 1) over size (S. Guthe, P. Heckbert, "Non-power-of-two
            // mipmap creation", 2005).
            _ => {
                let (m, n) = ((size / 2) as f32, size as f32);
                Self { first: 2 * i, count: 3, weights: [(m - i as f32) / n, m / n, (i as f32 + 1.0) / n] }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bump::{Moments, Offset, ShapedMoments};
    use crate::lobe::{OrientedLobe, SquaredAlpha};
    use crate::math::symmetric::Symmetric2;
    use crate::simd::instruction_sets;

    fn assert_lanes_are_single_texels<T: Merge + PartialEq + std::fmt::Debug>(texel: impl Fn(u32) -> T) {
        for (fine_width, fine_height) in [(1, 2), (2, 3), (5, 1), (16, 2), (19, 3), (37, 3), (64, 2)] {
            let rows: Vec<T> = (0..fine_width * fine_height).map(&texel).collect();
            let down = Taps::new(fine_height, 0);
            let width = level_size(fine_width);
            let expected: Vec<T> = (0..width)
                .map(|x| {
                    let across = Taps::new(fine_width, x);
                    let (mut weights, mut parts) = (Vec::new(), Vec::new());
                    for y in 0..down.count {
                        for x in 0..across.count {
                            weights.push(down.weights[y] * across.weights[x]);
                            parts.push(rows[y * fine_width as usize + across.first as usize + x]);
                        }
                    }
                    T::merge(&weights, &parts)
                })
                .collect();
            for set in instruction_sets() {
                let mut out = vec![T::default(); width as usize];
                reduce_row(set, &rows, fine_width as usize, &down, &mut out);
                assert_eq!(out, expected, "{fine_width} x {fine_height}, {set:?}");
            }
        }
    }

    /// In [0, 1).
    fn random(seed: u32) -> f32 {
        (seed.wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995).wrapping_mul(0x85eb_ca6b) as f32 / 4_294_967_808.0
    }

    fn moments(seed: u32) -> Moments {
        let [a, b, c, u, v] = [0, 1, 2, 3, 4].map(|i| random(5 * seed + i));
        let covariance = Symmetric2::outer([a, b]) + Symmetric2::diagonal(0.1 * c, 0.01);
        Moments { mean: Offset { u: 2.0 * u - 1.0, v: v * v }, covariance }
    }

    #[test]
    fn vectors_hold_the_bits_of_single_texels() {
        assert_lanes_are_single_texels(moments);
        assert_lanes_are_single_texels(|seed| ShapedMoments::normal(moments(seed)));
        assert_lanes_are_single_texels(|seed| [random(seed), random(seed + 1)]);
        // Smooth neighbours, which need no EM, beside rough ones.
        assert_lanes_are_single_texels(|seed| {
            let Moments { mean, covariance } = moments(if seed % 16 < 8 { seed } else { 3 });
            OrientedLobe::new(mean, SquaredAlpha(covariance))
        });
        assert_lanes_are_single_texels(|seed| match seed % 2 {
            0 => OrientedLobe::default(),
            _ => OrientedLobe::new(moments(seed).mean, SquaredAlpha::default()),
        });
    }
}
