//! Choice of the mode of a block.
//!
//! Both efforts fit candidates and keep the one with the least squared error. `best_rgb` fits all
//! that pay; `fast_rgb` first estimates errors from the moments of the colours and fits only what
//! can win: on 83,000 blocks of eighteen real maps the gates below cost 0.03 dB.

use fearless_simd::Simd;

use super::candidate::{Split, one_line, rest, split_lines, two_planes};
use super::moments::{ALL, Lane, Moments, moments, principal_axis, scatter_along};
use super::pack::Block;
use super::partition::likely_patterns;
use super::tables::{
    MODE_0, MODE_1, MODE_2, MODE_4, MODE_5, MODE_6, MODE_9, MODE_10, MODE_11, MODE_12, MODE_14, MODE_18,
};

/// Rounds of regression for opaque blocks; a third gains 0.04 dB.
const ROUNDS: usize = 2;

/// The candidate with the least error so far; the earlier one wins ties.
pub(super) struct Winner(pub Block);

impl Winner {
    pub fn offer(&mut self, block: Block) {
        if block.error < self.0.error {
            self.0 = block;
        }
    }
}

/// The best block found for opaque `texels`, whose channels have `scale` per level.
#[inline(always)]
pub(super) fn best_rgb<S: Simd>(simd: S, texels: &[Lane; 3], scale: &[f32; 3]) -> Block {
    let all = moments(texels, &ALL);
    let axis = principal_axis(&all.scatter);
    let mut winner = Winner(one_line::<_, 3, 4>(simd, texels, &all, &axis, scale, &MODE_0, ROUNDS));
    // Many weights serve long lines, exact endpoints short ones.
    let along = scatter_along(&all.scatter, &axis);
    if along > 400.0 {
        winner.offer(one_line::<_, 3, 5>(simd, texels, &all, &axis, scale, &MODE_18, ROUNDS));
    }
    if along < 3000.0 {
        winner.offer(one_line::<_, 3, 3>(simd, texels, &all, &axis, scale, &MODE_5, ROUNDS));
    }
    if along < 200.0 {
        winner.offer(one_line::<_, 3, 2>(simd, texels, &all, &axis, scale, &MODE_1, ROUNDS));
    }
    for selector in 0..3 {
        winner.offer(two_planes::<_, 3, 2>(simd, texels, &all, selector, scale, &MODE_6, ROUNDS));
    }
    for pattern in likely_patterns::<3, 2>(texels, &all, &axis) {
        let split = Split::in_two(texels, pattern);
        if split.scatter().0 > winner.0.error {
            continue;
        }
        winner.offer(split_lines::<_, 3, 2, 2>(simd, texels, &split, scale, &MODE_4, ROUNDS));
        // Sixteen levels an endpoint are too coarse for less.
        if winner.0.error > 150.0 {
            winner.offer(split_lines::<_, 3, 2, 3>(simd, texels, &split, scale, &MODE_2, ROUNDS));
        }
    }
    winner.0.polish(simd, texels, scale, 2);
    winner.0
}

/// A quickly found block for opaque `texels`, whose channels have `scale` per level.
#[inline(always)]
pub(super) fn fast_rgb<S: Simd>(simd: S, texels: &[Lane; 3], scale: &[f32; 3]) -> Block {
    /// Estimates are right within a factor of 2 for 90 % of blocks.
    const DOUBT: f32 = 2.0;
    /// Below this error of a block (1 per texel and channel) a second subset hardly ever wins.
    const GOOD: f32 = 50.0;

    let all = moments(texels, &ALL);
    let axis = principal_axis(&all.scatter);
    let along = scatter_along(&all.scatter, &axis);
    let off = (0..3).map(|c| all.scatter[c][c]).sum::<f32>() - along;
    let (selector, planes_estimate) = likely_planes(&all);
    let line_estimate = 1.05 * off + 0.003 * along + 3.0;

    let line = || {
        if along < 300.0 {
            // Short lines gain more from exact endpoints than from sixteen weights,
            one_line::<_, 3, 3>(simd, texels, &all, &axis, scale, &MODE_5, ROUNDS)
        } else if along > 25000.0 && off < 0.02 * along {
            // and long ones more from 32 weights: 4 dB on a grey map.
            one_line::<_, 3, 5>(simd, texels, &all, &axis, scale, &MODE_18, ROUNDS)
        } else {
            one_line::<_, 3, 4>(simd, texels, &all, &axis, scale, &MODE_0, ROUNDS)
        }
    };
    let planes = || two_planes::<_, 3, 2>(simd, texels, &all, selector, scale, &MODE_6, ROUNDS);
    let mut winner = if planes_estimate < line_estimate {
        let mut winner = Winner(planes());
        if line_estimate < DOUBT * planes_estimate {
            winner.offer(line());
        }
        winner
    } else {
        let mut winner = Winner(line());
        if planes_estimate < DOUBT * line_estimate {
            winner.offer(planes());
        }
        winner
    };
    if winner.0.error > GOOD {
        let [pattern] = likely_patterns(texels, &all, &axis);
        let split = Split::in_two(texels, pattern);
        let (off, along) = split.scatter();
        if off + along / 12.0 < 1.4 * winner.0.error {
            winner.offer(split_lines::<_, 3, 2, 2>(simd, texels, &split, scale, &MODE_4, ROUNDS));
        }
    }
    winner.0
}

/// The channel that is best given a plane of its own, and the squared error to expect then.
#[inline(always)]
fn likely_planes(all: &Moments<3>) -> (usize, f32) {
    let mut least = (0, f32::INFINITY);
    for alone in 0..3 {
        let [p, q] = rest(alone);
        let (a, b, c) = (all.scatter[p][p], all.scatter[p][q], all.scatter[q][q]);
        let radius = (0.25 * (a - c) * (a - c) + b * b).sqrt();
        let middle = 0.5 * (a + c);
        // 2-bit weights leave about a twelfth of the scatter along their line.
        let error = (middle - radius) + (middle + radius + all.scatter[alone][alone]) / 12.0;
        if error < least.1 {
            least = (alone, error);
        }
    }
    (least.0, 0.85 * least.1 + 4.0)
}

/// A block with alpha.
#[inline(always)]
pub(super) fn rgba<S: Simd>(simd: S, texels: &[Lane; 4], thorough: bool) -> Block {
    let rounds = if thorough { 4 } else { 2 };
    let all = moments(texels, &ALL);
    let axis = principal_axis(&all.scatter);
    let mut winner = Winner(one_line::<_, 4, 4>(simd, texels, &all, &axis, &[1.0; 4], &MODE_10, rounds));
    winner.offer(one_line::<_, 4, 3>(simd, texels, &all, &axis, &[1.0; 4], &MODE_12, rounds));
    winner.offer(two_planes::<_, 4, 2>(simd, texels, &all, 3, &[1.0; 4], &MODE_11, rounds));
    if thorough {
        winner.offer(one_line::<_, 4, 2>(simd, texels, &all, &axis, &[1.0; 4], &MODE_14, rounds));
        for selector in 0..3 {
            winner.offer(two_planes::<_, 4, 2>(simd, texels, &all, selector, &[1.0; 4], &MODE_11, rounds));
        }
        for pattern in likely_patterns::<4, 4>(texels, &all, &axis) {
            let split = Split::in_two(texels, pattern);
            winner.offer(split_lines::<_, 4, 2, 2>(simd, texels, &split, &[1.0; 4], &MODE_9, rounds));
        }
    }
    winner.0
}
