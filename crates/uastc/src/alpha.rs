//! Chooses the modes of blocks with alpha.

use fearless_simd::{Simd, SimdBase};

use crate::Effort;
use crate::blocks::Blocks;
use crate::candidate::{Split, one_line, splat, split_lines, two_planes};
use crate::lanes::{Grid, all_lanes};
use crate::moments::{moments, principal_axis};
use crate::partition::likely_patterns;
use crate::tables::{MODE_9, MODE_10, MODE_11, MODE_12, MODE_13, MODE_14};
use texel_simd::Wide;

/// Fits the modes with alpha to red, green, blue and alpha of `texels` and returns the best blocks.
///
/// [`Effort::Fast`] gives the second plane to alpha, which is related to the colours least often. [`Effort::Best`]
/// tries every channel, two patterns and a second round of regression.
#[inline(always)]
pub(crate) fn best_rgba<S: Simd>(simd: S, texels: &[Grid<S>; 4], effort: Effort) -> Blocks<S> {
    let (rounds, selectors): (_, &[f32]) = match effort {
        Effort::Fast => (1, &[3.0]),
        Effort::Best => (2, &[3.0, 0.0, 1.0, 2.0]),
    };
    let (scale, every_lane) = (splat(simd, &[1.0; 4]), all_lanes(simd));
    let all = moments(simd, texels, None);
    let axis = principal_axis(simd, &all.scatter);
    let mut winner = one_line(simd, texels, &all, &axis, &scale, &MODE_10, rounds);
    for mode in [&MODE_12, &MODE_14] {
        winner.keep_better(&one_line(simd, texels, &all, &axis, &scale, mode, rounds), every_lane);
    }
    for &selector in selectors {
        let selector = Wide::splat(simd, selector);
        for mode in [&MODE_11, &MODE_13] {
            winner.keep_better(&two_planes(simd, texels, &all, selector, &scale, mode, rounds), every_lane);
        }
    }
    for pattern in &likely_patterns::<_, 4, 2>(simd, texels, &all, &axis)[..rounds] {
        let split = Split::two_subsets(simd, texels, *pattern);
        winner.keep_better(&split_lines(simd, texels, &split, &scale, &MODE_9, rounds), every_lane);
    }
    winner
}
