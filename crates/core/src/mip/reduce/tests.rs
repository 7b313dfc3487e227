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

/// Returns a number in [0, 1).
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
