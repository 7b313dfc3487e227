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
    /// Skewness: the standardised E\[d^3\] plus [`CROSS_SKEWNESS`] times E\[d e^2\], where e is the deviation across
    /// the axis. Tails on one side pull the mean away from most offsets by this measure.
    pub skewness: [f32; 2],
}

/// Weight of the mixed third moment. This weight fits the best lobes of the synthetic families best, among multiples of
/// 0.1 (`benches/studies/correction_table`).
pub const CROSS_SKEWNESS: f32 = 0.4;

impl Shape {
    /// Returns the shape of `m`. An axis without variance has the shape of a normal distribution.
    pub fn of(m: &ShapedMoments) -> Self {
        let eigen = m.moments.covariance.eigen();
        let [x, y] = eigen.axis;
        let axes = [[x, y], [-y, x]];
        let variance = [eigen.major.max(0.0), eigen.minor];
        let along = |k: usize| {
            let (a, b) = (axes[k], axes[1 - k]);
            let (va, vb) = (variance[k], variance[1 - k]);
            // The squares of smaller variances are subnormal numbers.
            if va < 1e-18 {
                return (3.0, 0.0);
            }
            let mixed = if vb < 1e-18 { 0.0 } else { CROSS_SKEWNESS * cubic(m.third, a, b, b) / vb };
            // The kurtosis of a distribution is at least 1, but rounding could make it smaller.
            ((quartic(m.fourth, a) / (va * va)).max(1.0), (cubic(m.third, a, a, a) / va + mixed) / va.sqrt())
        };
        let ((major, lean), (minor, side)) = (along(0), along(1));
        Self { axes, variance, kurtosis: [major, minor], skewness: [lean, side] }
    }
}

/// Applies the symmetric tensor of third moments to three vectors.
fn cubic([uuu, uuv, uvv, vvv]: [f32; 4], a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> f32 {
    uuu * a[0] * b[0] * c[0]
        + uuv * (a[0] * b[0] * c[1] + a[0] * b[1] * c[0] + a[1] * b[0] * c[0])
        + uvv * (a[0] * b[1] * c[1] + a[1] * b[0] * c[1] + a[1] * b[1] * c[0])
        + vvv * a[1] * b[1] * c[1]
}

/// Applies the symmetric tensor of fourth moments to one vector four times.
fn quartic([uuuu, uuuv, uuvv, uvvv, vvvv]: [f32; 5], [x, y]: [f32; 2]) -> f32 {
    let (xx, xy, yy) = (x * x, x * y, y * y);
    uuuu * xx * xx + 4.0 * uuuv * xx * xy + 6.0 * uuvv * xx * yy + 4.0 * uvvv * xy * yy + vvvv * yy * yy
}

#[cfg(test)]
mod tests;
