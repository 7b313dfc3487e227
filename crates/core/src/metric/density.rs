//! Densities of half-vectors: D(h) (n.h)+, which integrates to 1 over the sphere.
//!
//! B. Walter et al., "Microfacet models for refraction through rough surfaces", 2007, eq. 25, 28 (Beckmann), 33, 35
//! (GGX), stretched as in E. Heitz, "Understanding the masking-shadowing function in microfacet-based BRDFs", 2014,
//! section 5.3.

use std::f64::consts::{PI, TAU};

pub use crate::lobe::Family;

use crate::math::symmetric::{self, MohrCircle};
use crate::math::vector::{Vector, combine, dot, frame, normalised};

/// A lobe about a normal, prepared for evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    family: Family,
    /// Unit normal in (T, B, N).
    normal: Vector,
    /// A: uu, uv, vv in the frame of the normal.
    a: [f64; 3],
    /// 1 / (pi sqrt|A|).
    peak: f64,
    /// M of h^T M h = s^T A^-1 s (n.h)^2 + (n.h)^2 with slopes s about the normal: xx, xy, xz, yy, yz, zz.
    m: [f64; 6],
}

/// Narrower lobes are widened to this alpha, because a lobe without width has no density. Engines clamp far above it.
pub const MIN_ALPHA: f64 = 1e-3;

impl Lobe {
    /// Returns the lobe with squared alphas `a` (uu, uv, vv, positive semidefinite) in the frame of `normal`. T is made
    /// perpendicular to the normal, which may have any length.
    pub fn new(family: Family, normal: Vector, a: [f64; 3]) -> Self {
        let normal = normalised(normal);
        let [uu, uv, vv] = with_min_alpha(a);
        let determinant = symmetric::determinant([uu, uv, vv]);
        let inverse = [vv / determinant, -uv / determinant, uu / determinant];
        let [t, b, n] = frame(normal);
        let element = |i: usize, j: usize| {
            inverse[0] * t[i] * t[j] + inverse[1] * (t[i] * b[j] + b[i] * t[j]) + inverse[2] * b[i] * b[j] + n[i] * n[j]
        };
        let m = [element(0, 0), element(0, 1), element(0, 2), element(1, 1), element(1, 2), element(2, 2)];
        Self { family, normal, a: [uu, uv, vv], peak: 1.0 / (PI * determinant.sqrt()), m }
    }

    /// Returns the isotropic lobe of width `alpha`.
    pub fn isotropic(family: Family, normal: Vector, alpha: f64) -> Self {
        Self::new(family, normal, [alpha * alpha, 0.0, alpha * alpha])
    }

    /// Returns the unit normal in (T, B, N).
    pub fn normal(&self) -> Vector {
        self.normal
    }

    /// Returns the squared alphas (uu, uv, vv) in the frame of the normal.
    pub fn squared_alpha(&self) -> [f64; 3] {
        self.a
    }

    /// Returns the share of half-vectors per steradian about the unit vector `h`; 0 below the normal's horizon.
    #[inline(always)]
    pub fn density(&self, h: Vector) -> f64 {
        let z = dot(self.normal, h);
        let [xx, xy, xz, yy, yz, zz] = self.m;
        let [x, y, w] = h;
        let q = xx * x * x + yy * y * y + zz * w * w + 2.0 * (xy * x * y + xz * x * w + yz * y * w);
        let above = match self.family {
            Family::Ggx => self.peak * z / (q * q),
            Family::Beckmann => self.peak * libm::exp(1.0 - q / (z * z)) / (z * z * z),
        };
        if z <= 0.0 { 0.0 } else { above }
    }

    /// Maps a point of the unit square to a half-vector. Evenly spread points give half-vectors that follow the
    /// density.
    pub fn sample(&self, point: [f64; 2]) -> Vector {
        let [x, y] = unit_slope(self.family, point);
        // A = L L^T with L lower triangular.
        let [uu, uv, vv] = self.a;
        let l = uu.sqrt();
        let slope = [l * x, uv / l * x + (vv - uv * uv / uu).max(0.0).sqrt() * y];
        normalised(combine([slope[0], slope[1], 1.0], frame(self.normal)))
    }
}

/// Maps a point of the unit square to a slope of a lobe with A = 1.
pub(super) fn unit_slope(family: Family, [radial, azimuth]: [f64; 2]) -> [f64; 2] {
    // The radius within which a share of `radial` of the lobe lies.
    let radius = match family {
        Family::Ggx => (radial / (1.0 - radial)).sqrt(),
        Family::Beckmann => (-libm::log(1.0 - radial)).sqrt(),
    };
    let (sin, cos) = libm::sincos(TAU * azimuth);
    [radius * cos, radius * sin]
}

fn with_min_alpha([uu, uv, vv]: [f64; 3]) -> [f64; 3] {
    let [_, minor] = MohrCircle::from([uu, uv, vv]).eigenvalues();
    let lack = MIN_ALPHA * MIN_ALPHA - minor;
    if lack > 0.0 { [uu + lack, uv, vv + lack] } else { [uu, uv, vv] }
}
