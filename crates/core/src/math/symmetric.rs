//! Symmetric 2 x 2 matrices: covariances of offsets (K) and squared alphas of lobes (A).

use std::ops::{Add, Mul, Sub};

use crate::simd::Real;

/// The matrix `[[uu, uv], [uv, vv]]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Symmetric2 {
    /// First diagonal element.
    pub uu: f32,
    /// Off-diagonal element.
    pub uv: f32,
    /// Second diagonal element.
    pub vv: f32,
}

/// Eigenvalues in descending order and the unit eigenvector of the larger eigenvalue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigen {
    /// Larger eigenvalue.
    pub major: f32,
    /// Smaller eigenvalue; clamped to 0, so that rounding cannot make it negative.
    pub minor: f32,
    /// Unit eigenvector of `major`, defined up to its sign; (1, 0) if both eigenvalues are equal.
    pub axis: [f32; 2],
}

impl Symmetric2 {
    /// The zero matrix.
    pub const ZERO: Self = Self::diagonal(0.0, 0.0);

    /// Creates a matrix with elements `uu`, `uv`, `vv`.
    pub const fn new(uu: f32, uv: f32, vv: f32) -> Self {
        Self { uu, uv, vv }
    }

    /// Creates a diagonal matrix.
    pub const fn diagonal(uu: f32, vv: f32) -> Self {
        Self::new(uu, 0.0, vv)
    }

    /// Builds the matrix with eigenvalue `major` along the unit vector `axis` and `minor` across it.
    pub fn from_axes(major: f32, minor: f32, axis: [f32; 2]) -> Self {
        let [x, y] = axis;
        let difference = major - minor;
        Self::new(minor + difference * x * x, difference * x * y, minor + difference * y * y)
    }

    /// Returns the outer product `v v^T`, a matrix of rank at most 1.
    #[inline(always)]
    pub fn outer(v: [f32; 2]) -> Self {
        Self::new(v[0] * v[0], v[0] * v[1], v[1] * v[1])
    }

    /// Returns `S M S` for the diagonal matrix S = diag(scale): the covariance of scaled offsets.
    #[inline(always)]
    pub fn scaled(self, scale: [f32; 2]) -> Self {
        Self::new(self.uu * scale[0] * scale[0], self.uv * scale[0] * scale[1], self.vv * scale[1] * scale[1])
    }

    /// Returns the sum of the diagonal.
    #[inline(always)]
    pub fn trace(self) -> f32 {
        self.uu + self.vv
    }

    /// Returns the determinant, clamped to 0, so that rounding cannot make that of a rank-1 matrix negative.
    #[inline(always)]
    pub fn determinant(self) -> f32 {
        determinant([self.uu, self.uv, self.vv]).max(0.0)
    }

    /// Returns the eigenvalues and the major axis. Uses no function except square roots, which IEEE 754 rounds alike on
    /// every machine.
    #[inline(always)]
    pub fn eigen(self) -> Eigen {
        let circle = MohrCircle::new([self.uu, self.uv, self.vv]);
        let [x, y] = circle.axis();
        let length = (x * x + y * y).sqrt();
        let axis = if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] };
        let [major, minor] = circle.eigenvalues();
        Eigen { major, minor: minor.max(0.0), axis }
    }
}

/// Returns the determinant of the matrix with elements uu, uv and vv, which rounding can make negative.
#[inline(always)]
pub(crate) fn determinant<F: Copy + Mul<Output = F> + Sub<Output = F>>([uu, uv, vv]: [F; 3]) -> F {
    uu * vv - uv * uv
}

/// Mohr's circle of the matrix `[[uu, uv], [uv, vv]]`: eigenvalues and axes of numbers and of vectors of numbers.
///
/// All of them are the same operations in the same order, so a lane of a vector and an `f32` have equal bits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MohrCircle<F> {
    /// Mean of the eigenvalues.
    pub mean: F,
    /// Half the difference of the diagonal elements, and the off-diagonal element: the radius along twice the angle of
    /// the major axis.
    pub direction: [F; 2],
    /// Half the difference of the eigenvalues.
    pub radius: F,
}

impl<F: Real> MohrCircle<F> {
    /// Decomposes the matrix with elements uu, uv and vv.
    #[inline(always)]
    pub fn new(matrix: [F; 3]) -> Self {
        let (mean, [x, y]) = mean_and_direction(matrix, matrix[0].splat_like(0.5));
        Self { mean, direction: [x, y], radius: (x * x + y * y).sqrt() }
    }
}

/// The decomposition in double precision, for which [`Real`] has no operations.
impl From<[f64; 3]> for MohrCircle<f64> {
    fn from(matrix: [f64; 3]) -> Self {
        let (mean, direction) = mean_and_direction(matrix, 0.5);
        Self::from_parts(mean, direction)
    }
}

#[inline(always)]
fn mean_and_direction<F: Copy + Add<Output = F> + Sub<Output = F> + Mul<Output = F>>(
    [uu, uv, vv]: [F; 3],
    half: F,
) -> (F, [F; 2]) {
    (half * (uu + vv), [half * (uu - vv), uv])
}

impl<F: Copy + Add<Output = F> + Sub<Output = F>> MohrCircle<F> {
    /// Returns the eigenvalues, the larger one first.
    #[inline(always)]
    pub fn eigenvalues(self) -> [F; 2] {
        [self.mean + self.radius, self.mean - self.radius]
    }
}

impl<F: Copy + Default + PartialOrd + Add<Output = F> + Sub<Output = F>> MohrCircle<F> {
    /// Returns an eigenvector of the larger eigenvalue, of any length: (0, 0) when both eigenvalues are equal.
    #[inline(always)]
    pub fn axis(self) -> [F; 2] {
        let [half_difference, uv] = self.direction;
        // Two formulas are equivalent; this is the one without cancellation.
        if half_difference >= F::default() {
            [half_difference + self.radius, uv]
        } else {
            [uv, self.radius - half_difference]
        }
    }
}

impl MohrCircle<f64> {
    /// Builds the circle from the mean of the eigenvalues and the radius along twice the angle of the major axis.
    pub fn from_parts(mean: f64, [x, y]: [f64; 2]) -> Self {
        Self { mean, direction: [x, y], radius: (x * x + y * y).sqrt() }
    }

    /// Returns cosine and sine of twice the angle of the major axis; (1, 0) when both eigenvalues are equal.
    pub fn doubled_axis(self) -> [f64; 2] {
        if self.radius > 0.0 { self.direction.map(|c| c / self.radius) } else { [1.0, 0.0] }
    }

    /// Returns uu, uv and vv of the matrix with these axes and other eigenvalues.
    pub fn matrix_with(self, [major, minor]: [f64; 2]) -> [f64; 3] {
        let (mean, radius) = (0.5 * (major + minor), 0.5 * (major - minor));
        let [cos, sin] = self.doubled_axis();
        [mean + radius * cos, radius * sin, mean - radius * cos]
    }
}

impl Add for Symmetric2 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.uu + other.uu, self.uv + other.uv, self.vv + other.vv)
    }
}

impl Mul<Symmetric2> for f32 {
    type Output = Symmetric2;
    #[inline(always)]
    fn mul(self, m: Symmetric2) -> Symmetric2 {
        Symmetric2::new(self * m.uu, self * m.uv, self * m.vv)
    }
}

#[cfg(test)]
mod tests;
