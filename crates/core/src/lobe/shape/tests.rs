use super::*;
use crate::bump::{Moments, Offset};
use crate::math::symmetric::Symmetric2;
use crate::mip::Merge;

fn of_points(points: &[[f32; 2]]) -> Shape {
    let parts: Vec<_> =
        points.iter().map(|[u, v]| ShapedMoments::normal(Moments::flat(Offset { u: *u, v: *v }))).collect();
    Shape::of(&ShapedMoments::merge(&vec![1.0 / parts.len() as f32; parts.len()], &parts))
}

fn assert_near(a: f32, b: f32) {
    assert!((a - b).abs() < 1e-4, "{a} is not near {b}");
}

#[test]
fn shapes_of_hand_computed_points() {
    // Along u two equal peaks; across it nothing.
    let two = of_points(&[[-1.0, 0.0], [1.0, 0.0]]);
    assert_near(two.kurtosis[0], 1.0);
    assert_near(two.skewness[0], 0.0);
    assert_eq!((two.kurtosis[1], two.skewness[1]), (3.0, 0.0));
    // One of four stands off: deviations -1/4 (3 times) and 3/4: variance 3/16, E d^3 = 3/32, E d^4 = 21/256.
    let lone = of_points(&[[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 1.0]]);
    assert_near(lone.variance[0], 3.0 / 16.0);
    assert_near(lone.kurtosis[0], 21.0 / 9.0);
    assert_near(lone.axes[0][1].abs(), 1.0);
    assert_near(lone.skewness[0] * lone.axes[0][1], 3.0 / 32.0 / (3.0f32 / 16.0).powf(1.5));
}

#[test]
fn a_normal_distribution_has_kurtosis_3_along_any_axis() {
    let m = Moments { mean: Offset::default(), covariance: Symmetric2::new(2.0, 0.7, 1.0) };
    let shape = Shape::of(&ShapedMoments::normal(m));
    shape.kurtosis.iter().for_each(|k| assert_near(*k, 3.0));
    assert_eq!(shape.skewness, [0.0; 2]);
}

/// Rotating the points rotates the axes and changes nothing else.
#[test]
fn shape_rotates_with_the_points() {
    let points = [[0.0, 0.1], [0.4, 0.2], [-0.3, 0.9], [1.5, -0.2], [0.1, 0.1]];
    let (cos, sin) = (0.6, 0.8);
    let straight = of_points(&points);
    let rotated = of_points(&points.map(|[x, y]| [x * cos - y * sin, x * sin + y * cos]));
    for k in 0..2 {
        assert_near(straight.variance[k], rotated.variance[k]);
        assert_near(straight.kurtosis[k], rotated.kurtosis[k]);
        assert_near(straight.skewness[k].abs(), rotated.skewness[k].abs());
    }
}
