//! Which of the two-subset patterns suit a block.

#![expect(clippy::needless_range_loop, reason = "lane loops read several arrays at one index")]

use super::moments::{Lane, Moments, principal_axis, scatter_along};
use super::tables::PATTERNS;

/// Patterns by eights in the ranking's inner loop, with room for two that do not exist.
const GROUPS: usize = 4;

/// 1 where a texel belongs to subset 1 of a pattern, per group of patterns and texel.
static MEMBERS: [[[f32; 8]; 16]; GROUPS] = members();

const fn members() -> [[[f32; 8]; 16]; GROUPS] {
    let mut members = [[[0.0; 8]; 16]; GROUPS];
    let mut pattern = 0;
    while pattern < PATTERNS.len() {
        let mut i = 0;
        while i < 16 {
            members[pattern / 8][i][pattern % 8] = (PATTERNS[pattern] >> i & 1) as f32;
            i += 1;
        }
        pattern += 1;
    }
    members
}

/// The `K` patterns with the least squared error to expect of lines of 2-bit weights, in the plane
/// of the two largest principal axes of the block (the first of them given as `axis`).
#[inline(always)]
pub(super) fn likely_patterns<const N: usize, const K: usize>(
    texels: &[Lane; N],
    all: &Moments<N>,
    axis: &[f32; N],
) -> [usize; K] {
    let first = unit(axis);
    let along = scatter_along(&all.scatter, &first);
    let mut left = all.scatter;
    for a in 0..N {
        for b in 0..N {
            left[a][b] -= along * first[a] * first[b];
        }
    }
    let second = unit(&principal_axis(&left));
    let errors = expected_errors(&place(texels, all, &first), &place(texels, all, &second));
    let mut ranked = [(f32::INFINITY, 0); K];
    for (pattern, &error) in errors.as_flattened()[..PATTERNS.len()].iter().enumerate() {
        if error < ranked[K - 1].0 {
            // Insertion from the end; earlier patterns win ties.
            let mut at = K - 1;
            while at > 0 && error < ranked[at - 1].0 {
                ranked[at] = ranked[at - 1];
                at -= 1;
            }
            ranked[at] = (error, pattern);
        }
    }
    ranked.map(|(_, pattern)| pattern)
}

#[inline(always)]
fn unit<const N: usize>(axis: &[f32; N]) -> [f32; N] {
    let length: f32 = axis.iter().map(|a| a * a).sum();
    let scale = if length > 0.0 { 1.0 / length.sqrt() } else { 0.0 };
    axis.map(|a| a * scale)
}

/// Texels along a unit `axis`, from their mean.
#[inline(always)]
fn place<const N: usize>(texels: &[Lane; N], all: &Moments<N>, axis: &[f32; N]) -> Lane {
    let mut centre = 0.0;
    for c in 0..N {
        centre += axis[c] * all.sums[c];
    }
    centre /= all.count;
    let mut places = [0.0; 16];
    for (i, place) in places.iter_mut().enumerate() {
        *place = -centre;
        for c in 0..N {
            *place += axis[c] * texels[c][i];
        }
    }
    places
}

/// Error to expect of every pattern for texels at (u, v), whose mean is 0.
#[inline(always)]
fn expected_errors(u: &Lane, v: &Lane) -> [[f32; 8]; GROUPS] {
    let mut features = [[0.0; 5]; 16];
    let mut total = [0.0; 5];
    for i in 0..16 {
        features[i] = [u[i], v[i], u[i] * u[i], u[i] * v[i], v[i] * v[i]];
        for f in 0..5 {
            total[f] += features[i][f];
        }
    }
    let mut errors = [[0.0; 8]; GROUPS];
    for (members, errors) in MEMBERS.iter().zip(&mut errors) {
        // Count, sums and products over subset 1; subset 0 is the rest.
        let mut count = [0.0; 8];
        let mut sums = [[0.0; 8]; 5];
        for i in 0..16 {
            for j in 0..8 {
                count[j] += members[i][j];
                for f in 0..5 {
                    sums[f][j] += members[i][j] * features[i][f];
                }
            }
        }
        for j in 0..8 {
            let one = sums.map(|s| s[j]);
            let mut zero = total;
            for f in 0..5 {
                zero[f] -= one[f];
            }
            errors[j] = expected_error(count[j], &one) + expected_error(16.0 - count[j], &zero);
        }
    }
    errors
}

/// The smaller eigenvalue of a subset's 2x2 scatter and a twelfth of the larger.
#[inline(always)]
fn expected_error(count: f32, [u, v, uu, uv, vv]: &[f32; 5]) -> f32 {
    let share = 1.0 / count;
    let (a, b, c) = (uu - u * u * share, uv - u * v * share, vv - v * v * share);
    let radius = (0.25 * (a - c) * (a - c) + b * b).sqrt();
    0.5 * (a + c) * (13.0 / 12.0) - radius * (11.0 / 12.0)
}
