//! Chooses the modes of blocks of normals.
//!
//! Two numbers describe a normal. Lines and planes are fitted to x and y alone, which costs less than three channels.
//! Regression on their weights then gives z, and [`Blocks::fit_directions`] measures the error of all three channels
//! by direction.

use fearless_simd::{Simd, SimdBase, prelude::*};

use crate::blocks::Blocks;
use crate::candidate::{Split, one_line, split_lines, two_planes};
use crate::direction::{DirectionMetric, Refinement};
use crate::lanes::{Grid, all_lanes};
use crate::moments::{moments, principal_axis, scatter_along, trace};
use crate::partition::likely_patterns;
use crate::tables::{MODE_0, MODE_1, MODE_2, MODE_3, MODE_4, MODE_5, MODE_6, MODE_18};
use texel_simd::{Real, Wide};

/// The squared error of x and y below which a second subset hardly ever wins. (A difference of one level in x and y of
/// every texel is an error of 32.)
pub(crate) const GOOD_ERROR: f32 = 60.0;

/// Finds blocks of one subset quickly, fitted to x and y, whose levels are multiplied by `scale`.
#[inline(always)]
pub(crate) fn fast_lines<S: Simd>(simd: S, xy: &[Grid<S>; 2], scale: &[Wide<S>; 2]) -> Blocks<S> {
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
        winner.keep_better(&two_planes(simd, xy, &all, selector, scale, &MODE_6, 1), is_plane_likely);
    }
    let is_line_likely = line_estimate.simd_lt(planes_estimate * UNCERTAINTY);
    winner.try_line(simd, xy, &all, &axis, scale, 1, is_line_likely);
    winner
}

impl<S: Simd> Blocks<S> {
    /// Fits `blocks` to the normals of `metric` and keeps those that are better. The error of `blocks` is that of x
    /// and y.
    #[inline(always)]
    fn try_directions<M: DirectionMetric<S>>(
        &mut self,
        simd: S,
        metric: M,
        mut blocks: Self,
        allowed: <Wide<S> as Real>::Mask,
    ) {
        let may_win = allowed & metric.may_win(&blocks, self.error);
        if may_win.any_true() {
            blocks.fit_directions(simd, metric, Refinement::rounds(2));
            self.keep_better(&blocks, may_win);
        }
    }
}

/// As [`GOOD_ERROR`], for normals whose lobes are known: lower limits change the sum of total variations by less than
/// 0.01 % on five real maps, and take up to 30 % more time.
pub(crate) const GOOD_ERROR_FOR_LOBES: f32 = 250.0;

/// Modes by their number of weight planes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Modes {
    All,
    OnePlane,
    TwoPlanes,
}

/// Fits those of `modes` that pay and returns the best blocks. `winner` are the best blocks so far, with errors of
/// `metric`. The levels of `xy` are multiplied by `scale`.
#[inline(always)]
pub(crate) fn best<S: Simd, M: DirectionMetric<S>>(
    simd: S,
    xy: &[Grid<S>; 2],
    scale: &[Wide<S>; 2],
    metric: M,
    modes: Modes,
    mut winner: Blocks<S>,
) -> Blocks<S> {
    let all = moments(simd, xy, None);
    let axis = principal_axis(simd, &all.scatter);
    let along = scatter_along(simd, &all.scatter, &axis);
    let every_lane = all_lanes(simd);
    if modes != Modes::TwoPlanes {
        winner.try_directions(simd, metric, one_line(simd, xy, &all, &axis, scale, &MODE_0, 2), every_lane);
        let is_long = along.simd_gt(400.0);
        if is_long.any_true() {
            winner.try_directions(simd, metric, one_line(simd, xy, &all, &axis, scale, &MODE_18, 2), is_long);
        }
        let is_short = along.simd_lt(3000.0);
        if is_short.any_true() {
            winner.try_directions(simd, metric, one_line(simd, xy, &all, &axis, scale, &MODE_5, 2), is_short);
        }
        let is_shortest = along.simd_lt(200.0);
        if is_shortest.any_true() {
            winner.try_directions(simd, metric, one_line(simd, xy, &all, &axis, scale, &MODE_1, 2), is_shortest);
        }
    }
    if modes != Modes::OnePlane {
        for selector in [0.0, 1.0] {
            let selector = Wide::splat(simd, selector);
            winner.try_directions(simd, metric, two_planes(simd, xy, &all, selector, scale, &MODE_6, 2), every_lane);
        }
    }
    if modes != Modes::TwoPlanes {
        for pattern in likely_patterns::<_, 2, 4>(simd, xy, &all, &axis).into_iter().take(metric.patterns()) {
            let split = Split::two_subsets(simd, xy, pattern);
            winner.try_directions(simd, metric, split_lines(simd, xy, &split, scale, &MODE_4, 2), every_lane);
            winner.try_directions(simd, metric, split_lines(simd, xy, &split, scale, &MODE_2, 2), every_lane);
        }
        for pattern in Split::likely_patterns::<4>(simd, xy).into_iter().take(metric.patterns()) {
            let split = Split::three_subsets(simd, xy, pattern);
            winner.try_directions(simd, metric, split_lines(simd, xy, &split, scale, &MODE_3, 2), every_lane);
        }
    }
    winner
}
