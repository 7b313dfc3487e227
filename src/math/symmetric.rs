//! Symmetric 2 x 2 matrices: covariances of offsets (K) and squared alphas of lobes (A).

use std::ops::{Add, Mul};

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

/// Eigenvalues in falling order and the unit eigenvector of the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigen {
    /// Larger eigenvalue.
    pub major: f32,
    /// Smaller eigenvalue; never below 0 for a positive semidefinite matrix, whatever the rounding.
    pub minor: f32,
    /// Unit eigenvector of `major`, defined up to its sign; (1, 0) when both eigenvalues are equal.
    pub axis: [f32; 2],
}

impl Symmetric2 {
    /// The matrix without any spread.
    pub const ZERO: Self = Self::diagonal(0.0, 0.0);

    /// A matrix with elements `uu`, `uv`, `vv`.
    pub const fn new(uu: f32, uv: f32, vv: f32) -> Self {
        Self { uu, uv, vv }
    }

    /// A diagonal matrix.
    pub const fn diagonal(uu: f32, vv: f32) -> Self {
        Self::new(uu, 0.0, vv)
    }

    /// `major` along the unit vector `axis`, `minor` across it.
    pub fn from_axes(major: f32, minor: f32, axis: [f32; 2]) -> Self {
        let [x, y] = axis;
        let spread = major - minor;
        Self::new(minor + spread * x * x, spread * x * y, minor + spread * y * y)
    }

    /// The square of the vector: `v v^T`, a matrix of rank at most 1.
    #[inline(always)]
    pub fn outer(v: [f32; 2]) -> Self {
        Self::new(v[0] * v[0], v[0] * v[1], v[1] * v[1])
    }

    /// `S M S` for the diagonal matrix S = diag(scale): the covariance of scaled offsets.
    #[inline(always)]
    pub fn scaled(self, scale: [f32; 2]) -> Self {
        Self::new(self.uu * scale[0] * scale[0], self.uv * scale[0] * scale[1], self.vv * scale[1] * scale[1])
    }

    /// Sum of the diagonal.
    #[inline(always)]
    pub fn trace(self) -> f32 {
        self.uu + self.vv
    }

    /// Determinant, not below 0: what rounding leaves of a rank-1 matrix counts as rank 1.
    #[inline(always)]
    pub fn determinant(self) -> f32 {
        (self.uu * self.vv - self.uv * self.uv).max(0.0)
    }

    /// Eigenvalues and major axis. Uses square roots only, which IEEE 754 rounds alike on every machine.
    #[inline(always)]
    pub fn eigen(self) -> Eigen {
        let mean = 0.5 * (self.uu + self.vv);
        let half_difference = 0.5 * (self.uu - self.vv);
        let radius = (half_difference * half_difference + self.uv * self.uv).sqrt();
        // Of the two equivalent eigenvector formulas the one without cancellation.
        let (x, y) = if half_difference >= 0.0 {
            (half_difference + radius, self.uv)
        } else {
            (self.uv, radius - half_difference)
        };
        let length = (x * x + y * y).sqrt();
        let axis = if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] };
        Eigen { major: mean + radius, minor: (mean - radius).max(0.0), axis }
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
mod tests {
    use super::*;

    #[test]
    fn eigen_of_hand_computed_matrices() {
        // [[5, 2], [2, 2]]: eigenvalues 6 and 1, major axis (2, 1)/sqrt 5.
        let e = Symmetric2::new(5.0, 2.0, 2.0).eigen();
        assert!((e.major - 6.0).abs() < 1e-6 && (e.minor - 1.0).abs() < 1e-6);
        assert!((e.axis[0] - 2.0 / 5f32.sqrt()).abs() < 1e-6);
        assert!((e.axis[1] - 1.0 / 5f32.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn eigen_of_degenerate_matrices() {
        let zero = Symmetric2::ZERO.eigen();
        assert_eq!((zero.major, zero.minor, zero.axis), (0.0, 0.0, [1.0, 0.0]));
        let line = Symmetric2::outer([3.0, -4.0]).eigen();
        assert!((line.major - 25.0).abs() < 1e-5);
        assert!(line.minor.abs() < 1e-5);
        assert!((line.axis[0] * -4.0 - line.axis[1] * 3.0).abs() < 1e-5);
        assert_eq!(Symmetric2::diagonal(0.0, 2.0).eigen().axis, [0.0, 1.0]);
    }

    #[test]
    fn axes_rebuild_the_matrix() {
        let m = Symmetric2::new(0.3, -0.12, 0.11);
        let e = m.eigen();
        let back = Symmetric2::from_axes(e.major, e.minor, e.axis);
        for (a, b) in [(m.uu, back.uu), (m.uv, back.uv), (m.vv, back.vv)] {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
}
