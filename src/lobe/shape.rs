//! The shape of a distribution of offsets along the axes of its ellipse.

use crate::bump::ShapedMoments;

/// Spread, kurtosis and skewness along the axes of K, the axis of larger variance first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Unit vectors in (T, B), at right angles.
    pub axes: [[f32; 2]; 2],
    /// Variance along each axis: the eigenvalues of K.
    pub variance: [f32; 2],
    /// E\[d^4\] over the squared variance: 1 for two equal peaks, 1.8 for a uniform distribution, 3 for a normal one,
    /// more with heavy tails.
    pub kurtosis: [f32; 2],
    /// How far the tails pull the mean away from where most offsets are: the standardised E\[d^3\] and
    /// [`CROSS_SKEWNESS`] times E\[d e^2\], with e across the axis.
    pub skewness: [f32; 2],
}

/// How much the mixed third moment counts. The best lobes of the synthetic families choose it, of steps of 0.1
/// (`examples/correction_table`).
pub const CROSS_SKEWNESS: f32 = 0.4;

impl Shape {
    /// The shape of `m`; along an axis without variance that of a normal distribution.
    pub fn of(m: &ShapedMoments) -> Self {
        let eigen = m.moments.covariance.eigen();
        let [x, y] = eigen.axis;
        let axes = [[x, y], [-y, x]];
        let variance = [eigen.major.max(0.0), eigen.minor];
        let along = |k: usize| {
            let (a, b) = (axes[k], axes[1 - k]);
            let (va, vb) = (variance[k], variance[1 - k]);
            // Squares of variances below this are no longer normal numbers.
            if va < 1e-18 {
                return (3.0, 0.0);
            }
            let mixed = if vb < 1e-18 { 0.0 } else { CROSS_SKEWNESS * cubic(m.third, a, b, b) / vb };
            // A distribution's kurtosis is at least 1, whatever the rounding.
            ((quartic(m.fourth, a) / (va * va)).max(1.0), (cubic(m.third, a, a, a) / va + mixed) / va.sqrt())
        };
        let ((major, lean), (minor, side)) = (along(0), along(1));
        Self { axes, variance, kurtosis: [major, minor], skewness: [lean, side] }
    }
}

/// The symmetric tensor of third moments applied to three vectors.
fn cubic([uuu, uuv, uvv, vvv]: [f32; 4], a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> f32 {
    uuu * a[0] * b[0] * c[0]
        + uuv * (a[0] * b[0] * c[1] + a[0] * b[1] * c[0] + a[1] * b[0] * c[0])
        + uvv * (a[0] * b[1] * c[1] + a[1] * b[0] * c[1] + a[1] * b[1] * c[0])
        + vvv * a[1] * b[1] * c[1]
}

/// The symmetric tensor of fourth moments applied to one vector four times.
fn quartic([uuuu, uuuv, uuvv, uvvv, vvvv]: [f32; 5], [x, y]: [f32; 2]) -> f32 {
    let (xx, xy, yy) = (x * x, x * y, y * y);
    uuuu * xx * xx + 4.0 * uuuv * xx * xy + 6.0 * uuvv * xx * yy + 4.0 * uvvv * xy * yy + vvvv * yy * yy
}

#[cfg(test)]
mod tests {
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

    /// Turning the points turns the axes and changes nothing else.
    #[test]
    fn shape_turns_with_the_points() {
        let points = [[0.0, 0.1], [0.4, 0.2], [-0.3, 0.9], [1.5, -0.2], [0.1, 0.1]];
        let (cos, sin) = (0.6, 0.8);
        let straight = of_points(&points);
        let turned = of_points(&points.map(|[x, y]| [x * cos - y * sin, x * sin + y * cos]));
        for k in 0..2 {
            assert_near(straight.variance[k], turned.variance[k]);
            assert_near(straight.kurtosis[k], turned.kurtosis[k]);
            assert_near(straight.skewness[k].abs(), turned.skewness[k].abs());
        }
    }
}
