//! Choice of the mode of blocks of normals.
//!
//! A normal is two numbers. Lines and planes are fitted to x and y alone, which costs less than to three channels; z
//! follows by regression on their weights, and all three are then judged by direction ([`Blocks::aim`]).

use fearless_simd::{Simd, SimdBase, prelude::*};

use crate::blocks::Blocks;
use crate::candidate::{Split, one_line, split_lines, two_planes};
use crate::direction::{Normals, normals};
use crate::lanes::{Grid, every};
use crate::moments::{moments, principal_axis, scatter_along, trace};
use crate::partition::likely_patterns;
use crate::tables::{MODE_0, MODE_1, MODE_2, MODE_3, MODE_4, MODE_5, MODE_6, MODE_18};
use texel_simd::{Real, Wide};

/// The squared error of x and y below which a second subset hardly ever wins. (One step of both in each texel is 32.)
pub(crate) const GOOD: f32 = 60.0;

/// Quickly found blocks of one subset, fitted to x and y.
#[inline(always)]
pub(crate) fn fast_lines<S: Simd>(simd: S, xy: &[Grid<S>; 2]) -> Blocks<S> {
    /// Estimates are right within a factor of 2 for most blocks.
    const DOUBT: f32 = 2.0;

    let all = moments(simd, xy, None);
    let axis = principal_axis(simd, &all.scatter);
    let along = scatter_along(simd, &all.scatter, &axis);
    let off = trace(&all.scatter) - along;
    let planes_estimate = (along + off) * 0.07 + 3.0;
    let line_estimate = off * 1.05 + along * 0.003 + 2.0;
    let mut winner = Blocks::none(simd);
    let is_plane_likely = planes_estimate.simd_lt(line_estimate * DOUBT);
    if is_plane_likely.any_true() {
        let selector = Wide::splat(simd, 0.0);
        winner.offer(&two_planes::<_, 2, 2>(simd, xy, &all, selector, &[1.0; 2], &MODE_6, 1), is_plane_likely);
    }
    let is_line_likely = line_estimate.simd_lt(planes_estimate * DOUBT);
    winner.offer_line(simd, xy, &all, &axis, &[1.0; 2], 1, is_line_likely);
    winner
}

impl<S: Simd> Blocks<S> {
    /// Offers blocks whose error is still that of x and y, after they were fitted by direction to `target`.
    #[inline(always)]
    fn offer_aimed(&mut self, simd: S, target: &Normals<S>, mut blocks: Self, allowed: <Wide<S> as Real>::Mask) {
        let is_hopeful = allowed & blocks.error.simd_lt(self.error);
        if is_hopeful.any_true() {
            blocks.aim(simd, target, 2, 0);
            self.offer(&blocks, is_hopeful);
        }
    }
}

/// The best blocks found, starting from `winner`, whose error is that of directions.
#[inline(always)]
pub(crate) fn best<S: Simd>(simd: S, texels: &[Grid<S>; 3], mut winner: Blocks<S>) -> Blocks<S> {
    let xy = [texels[0], texels[1]];
    let target = normals(texels);
    let all = moments(simd, &xy, None);
    let axis = principal_axis(simd, &all.scatter);
    let along = scatter_along(simd, &all.scatter, &axis);
    let every = every(simd);
    winner.offer_aimed(simd, &target, one_line::<_, 2, 4>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_0, 2), every);
    let is_long = along.simd_gt(400.0);
    if is_long.any_true() {
        winner.offer_aimed(simd, &target, one_line::<_, 2, 5>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_18, 2), is_long);
    }
    let is_short = along.simd_lt(3000.0);
    if is_short.any_true() {
        winner.offer_aimed(simd, &target, one_line::<_, 2, 3>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_5, 2), is_short);
    }
    let is_shortest = along.simd_lt(200.0);
    if is_shortest.any_true() {
        winner.offer_aimed(
            simd,
            &target,
            one_line::<_, 2, 2>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_1, 2),
            is_shortest,
        );
    }
    for selector in [0.0, 1.0] {
        let selector = Wide::splat(simd, selector);
        winner.offer_aimed(
            simd,
            &target,
            two_planes::<_, 2, 2>(simd, &xy, &all, selector, &[1.0; 2], &MODE_6, 2),
            every,
        );
    }
    for pattern in likely_patterns::<_, 2, 2>(simd, &xy, &all, &axis) {
        let split = Split::in_two(simd, &xy, pattern);
        winner.offer_aimed(simd, &target, split_lines::<_, 2, 2, 2>(simd, &xy, &split, &[1.0; 2], &MODE_4, 2), every);
        winner.offer_aimed(simd, &target, split_lines::<_, 2, 2, 3>(simd, &xy, &split, &[1.0; 2], &MODE_2, 2), every);
    }
    for pattern in Split::likely_thirds::<2>(simd, &xy) {
        let split = Split::in_three(simd, &xy, pattern);
        winner.offer_aimed(simd, &target, split_lines::<_, 2, 3, 2>(simd, &xy, &split, &[1.0; 2], &MODE_3, 2), every);
    }
    winner
}
