//! Choice of the mode of a block of normals.
//!
//! A normal is two numbers. Lines and planes are fitted to x and y alone, which costs less than to three channels; z
//! follows by regression on their weights, and all three are then judged by direction.

use fearless_simd::Simd;

use super::candidate::{Split, one_line, split_lines, two_planes};
use super::direction::normals;
use super::moments::{ALL, Lane, moments, principal_axis, scatter_along};
use super::pack::Block;
use super::partition::likely_patterns;
use super::search::Winner;
use super::tables::{MODE_0, MODE_1, MODE_2, MODE_3, MODE_4, MODE_5, MODE_6, MODE_18};

/// A quickly found block.
#[inline(always)]
pub(super) fn fast<S: Simd>(simd: S, texels: &[Lane; 3]) -> Block {
    /// Estimates are right within a factor of 2 for most blocks.
    const DOUBT: f32 = 2.0;
    /// Below this squared error of x and y (1 per texel and channel) a second subset hardly ever wins.
    const GOOD: f32 = 30.0;

    let xy = [texels[0], texels[1]];
    let all = moments(&xy, &ALL);
    let axis = principal_axis(&all.scatter);
    let along = scatter_along(&all.scatter, &axis);
    let off = all.scatter[0][0] + all.scatter[1][1] - along;
    let planes_estimate = 0.07 * (along + off) + 3.0;
    let line_estimate = 1.05 * off + 0.003 * along + 2.0;
    let line = || {
        if along < 300.0 {
            one_line::<_, 2, 3>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_5, 1)
        } else if along > 25000.0 && off < 0.02 * along {
            one_line::<_, 2, 5>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_18, 1)
        } else {
            one_line::<_, 2, 4>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_0, 1)
        }
    };
    let planes = || two_planes::<_, 2, 2>(simd, &xy, &all, 0, &[1.0; 2], &MODE_6, 1);
    let mut winner = Winner(if planes_estimate < line_estimate { planes() } else { line() });
    if planes_estimate < line_estimate {
        if line_estimate < DOUBT * planes_estimate {
            winner.offer(line());
        }
    } else if planes_estimate < DOUBT * line_estimate {
        winner.offer(planes());
    }
    if winner.0.error > GOOD {
        let [pattern] = likely_patterns(&xy, &all, &axis);
        let split = Split::in_two(&xy, pattern);
        let (off, along) = split.scatter();
        if off + along / 12.0 < 1.4 * winner.0.error {
            winner.offer(split_lines::<_, 2, 2, 2>(simd, &xy, &split, &[1.0; 2], &MODE_4, 1));
            // Sixteen levels an endpoint are too coarse for less.
            if winner.0.error > 150.0 {
                winner.offer(split_lines::<_, 2, 2, 3>(simd, &xy, &split, &[1.0; 2], &MODE_2, 1));
            }
        }
    }
    winner.0.aim(simd, &normals(texels), 2, 0);
    winner.0
}

/// The best block found.
#[inline(always)]
pub(super) fn best<S: Simd>(simd: S, texels: &[Lane; 3]) -> Block {
    let xy = [texels[0], texels[1]];
    let target = normals(texels);
    let all = moments(&xy, &ALL);
    let axis = principal_axis(&all.scatter);
    let along = scatter_along(&all.scatter, &axis);
    let mut winner = Winner(fast(simd, texels));
    let mut offer = |mut block: Block| {
        if block.error >= winner.0.error {
            return;
        }
        block.aim(simd, &target, 2, 0);
        winner.offer(block);
    };
    offer(one_line::<_, 2, 4>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_0, 2));
    if along > 400.0 {
        offer(one_line::<_, 2, 5>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_18, 2));
    }
    if along < 3000.0 {
        offer(one_line::<_, 2, 3>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_5, 2));
    }
    if along < 200.0 {
        offer(one_line::<_, 2, 2>(simd, &xy, &all, &axis, &[1.0; 2], &MODE_1, 2));
    }
    for selector in 0..2 {
        offer(two_planes::<_, 2, 2>(simd, &xy, &all, selector, &[1.0; 2], &MODE_6, 2));
    }
    for pattern in likely_patterns::<2, 2>(&xy, &all, &axis) {
        let split = Split::in_two(&xy, pattern);
        offer(split_lines::<_, 2, 2, 2>(simd, &xy, &split, &[1.0; 2], &MODE_4, 2));
        offer(split_lines::<_, 2, 2, 3>(simd, &xy, &split, &[1.0; 2], &MODE_2, 2));
    }
    let mut splits = Split::in_three(&xy);
    let expected = |split: &Split<2, 3>| {
        let (off, along) = split.scatter();
        off + along / 12.0
    };
    splits.sort_by(|a, b| expected(a).total_cmp(&expected(b)));
    for split in &splits[..2] {
        offer(split_lines::<_, 2, 3, 2>(simd, &xy, split, &[1.0; 2], &MODE_3, 2));
    }
    winner.0.aim(simd, &target, 0, 2);
    winner.0
}
