//! Chooses the modes of blocks of normals.
//!
//! Two numbers describe a normal. Lines and planes are fitted to x and y alone, which costs less than three channels.
//! Regression on their weights then gives z, and [`Blocks::fit_directions`] measures the error of all three channels
//! by direction.

use fearless_simd::{Simd, SimdBase, prelude::*};

use crate::blocks::Blocks;
use crate::candidate::{Split, one_line, split_lines, two_planes};
use crate::direction::{Normals, normals};
use crate::lanes::{Grid, all_lanes};
use crate::moments::{moments, principal_axis, scatter_along, trace};
use crate::partition::likely_patterns;
use crate::tables::{MODE_0, MODE_1, MODE_2, MODE_3, MODE_4, MODE_5, MODE_6, MODE_18};
use texel_simd::{Real, Wide};

/// The squared error of x and y below which a second subset hardly ever wins. (A difference of one level in x and y of
/// every texel is an error of 32.)
pub(crate) const GOOD_ERROR: f32 = 60.0;

/// Finds blocks of one subset quickly, fitted to x and y.
#[inline(always)]
pub(crate) fn fast_lines<S: Simd>(simd: S, xy: &[Grid<S>; 2]) -> Blocks<S> {
    /// Estimates are right within this factor for most blocks.
    const UNCERTAINTY: f32 = 2.0;

    let all = moments(simd, xy, None);
    let axis = principal_axis(simd, &all.scatter);
    let along = scatter_along(simd, &all.scatter, &axis);
    let off_axis = trace(&all.scatter) - along;
    let planes_estimate = (along + off_axis) * 0.07 + 3.0;
    let line_estimate = off_axis * 1.05 + along * 0.003 + 2.0;
    let mut winner = Blocks::none(simd);
    let is_plane_likely = planes_estimate.simd_lt(line_estimate * UNCERTAINTY);
    if is_plane_likely.any_true() {
        let selector = Wide::splat(simd, 0.0);
        winner.keep_better(&two_planes(simd, xy, &all, selector, &[1.0; 2], &MODE_6, 1), is_plane_likely);
    }
    let is_line_likely = line_estimate.simd_lt(planes_estimate * UNCERTAINTY);
    winner.try_line(simd, xy, &all, &axis, &[1.0; 2], 1, is_line_likely);
    winner
}

impl<S: Simd> Blocks<S> {
    /// Fits `blocks` to `target` by direction and keeps those that are better. The error of `blocks` is that of x and
    /// y, which is below the error of directions.
    #[inline(always)]
    fn try_directions(&mut self, simd: S, target: &Normals<S>, mut blocks: Self, allowed: <Wide<S> as Real>::Mask) {
        let may_win = allowed & blocks.error.simd_lt(self.error);
        if may_win.any_true() {
            blocks.fit_directions(simd, target, 2, 0);
            self.keep_better(&blocks, may_win);
        }
    }
}

/// Fits all modes that pay and returns the best blocks. `winner` are the best blocks so far, with errors of directions.
#[inline(always)]
pub(crate) fn best<S: Simd>(simd: S, texels: &[Grid<S>; 3], mut winner: Blocks<S>) -> Blocks<S> {
    let xy = [texels[0], texels[1]];
    let target = normals(texels);
    let all = moments(simd, &xy, None);
    let axis = principal_axis(simd, &all.scatter);
    let along = scatter_along(simd, &all.scatter, &axis);
    let every_lane = all_lanes(simd);
    winner.try_directions(simd, &target, one_line(simd, &xy, &all, &axis, &[1.0; 2], &MODE_0, 2), every_lane);
    let is_long = along.simd_gt(400.0);
    if is_long.any_true() {
        winner.try_directions(simd, &target, one_line(simd, &xy, &all, &axis, &[1.0; 2], &MODE_18, 2), is_long);
    }
    let is_short = along.simd_lt(3000.0);
    if is_short.any_true() {
        winner.try_directions(simd, &target, one_line(simd, &xy, &all, &axis, &[1.0; 2], &MODE_5, 2), is_short);
    }
    let is_shortest = along.simd_lt(200.0);
    if is_shortest.any_true() {
        winner.try_directions(simd, &target, one_line(simd, &xy, &all, &axis, &[1.0; 2], &MODE_1, 2), is_shortest);
    }
    for selector in [0.0, 1.0] {
        let selector = Wide::splat(simd, selector);
        winner.try_directions(simd, &target, two_planes(simd, &xy, &all, selector, &[1.0; 2], &MODE_6, 2), every_lane);
    }
    for pattern in likely_patterns::<_, 2, 2>(simd, &xy, &all, &axis) {
        let split = Split::two_subsets(simd, &xy, pattern);
        winner.try_directions(simd, &target, split_lines(simd, &xy, &split, &[1.0; 2], &MODE_4, 2), every_lane);
        winner.try_directions(simd, &target, split_lines(simd, &xy, &split, &[1.0; 2], &MODE_2, 2), every_lane);
    }
    for pattern in Split::likely_patterns::<2>(simd, &xy) {
        let split = Split::three_subsets(simd, &xy, pattern);
        winner.try_directions(simd, &target, split_lines(simd, &xy, &split, &[1.0; 2], &MODE_3, 2), every_lane);
    }
    winner
}
