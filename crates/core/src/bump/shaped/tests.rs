use super::*;
use crate::bump::Offset;
use proptest::prelude::*;

/// Returns the sum of w d_u^p d_v^q over points, in f64.
fn central(points: &[([f64; 2], f64)], p: i32, q: i32) -> f64 {
    let mean = |i: usize| points.iter().map(|(x, w)| w * x[i]).sum::<f64>();
    let (u, v) = (mean(0), mean(1));
    points.iter().map(|(x, w)| w * (x[0] - u).powi(p) * (x[1] - v).powi(q)).sum()
}

proptest! {
    /// Merging in two steps gives the moments of all the points, computed directly in f64.
    #[test]
    fn merges_are_exact(points in prop::collection::vec((-2.0f32..2.0, -2.0f32..2.0), 9), split in 1usize..8) {
        let flat = |(u, v): (f32, f32)| ShapedMoments::normal(Moments::flat(Offset { u, v }));
        let of = |points: &[(f32, f32)]| {
            let weights = vec![1.0 / points.len() as f32; points.len()];
            ShapedMoments::merge(&weights, &points.iter().map(|p| flat(*p)).collect::<Vec<_>>())
        };
        let share = split as f32 / 9.0;
        let merged = ShapedMoments::merge(&[share, 1.0 - share], &[of(&points[..split]), of(&points[split..])]);
        let all: Vec<_> = points.iter().map(|(u, v)| ([f64::from(*u), f64::from(*v)], 1.0 / 9.0)).collect();
        for (i, third) in merged.third.into_iter().enumerate() {
            let expected = central(&all, 3 - i as i32, i as i32);
            prop_assert!((f64::from(third) - expected).abs() < 1e-4, "third {}: {} for {}", i, third, expected);
        }
        for (i, fourth) in merged.fourth.into_iter().enumerate() {
            let expected = central(&all, 4 - i as i32, i as i32);
            prop_assert!((f64::from(fourth) - expected).abs() < 3e-4, "fourth {}: {} for {}", i, fourth, expected);
        }
    }
}

/// Two normal distributions with one mean and covariance merge to themselves.
#[test]
fn normal_parts_stay_normal() {
    let m = ShapedMoments::normal(Moments { mean: Offset::default(), covariance: Symmetric2::new(2.0, 0.5, 1.0) });
    assert_eq!(ShapedMoments::merge(&[0.25, 0.75], &[m, m]), m);
}
