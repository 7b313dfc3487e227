//! A lobe of slopes about a normal, and EM steps from one lobe to the next.

use crate::simd::Real;

/// The least squared alpha, 0.001^2. A lobe without width has no density.
pub const MIN_SQUARED_ALPHA: f32 = 1e-6;

/// Over-relaxation factor of EM steps.
///
/// If the points are those of a GGX lobe, one EM step leaves a third of the errors of mean, width and shape, so that a
/// step 3/2 as long leaves no error to first order. q has the density 1 / (1 + q)^2. With w = 1 / (1 + q), E[w] = 1/2,
/// E[w^2 q] = 1/6 and E[w^2 q^2] = 1/3. The remaining errors are E[w^2 q] / E[w] of the mean,
/// 2 (E[w^2 q^2] - E[w^2 q]) of the width, and E[w^2 q^2] of the shape.
const STRIDE: f32 = 1.5;

/// A symmetric matrix.
#[derive(Clone, Copy, Default)]
pub struct Matrix<F> {
    pub uu: F,
    pub uv: F,
    pub vv: F,
}

impl<F: Real> Matrix<F> {
    /// Returns the determinant |A|.
    #[inline(always)]
    fn determinant(self) -> F {
        self.uu * self.vv - self.uv * self.uv
    }

    /// Returns A^-1, with A widened to at least [`MIN_SQUARED_ALPHA`]. Long lobes are widened more, so that rounding
    /// does not make the determinant 0.
    #[inline(always)]
    pub fn inverse(self) -> Self {
        let zero = self.uu.splat_like(0.0);
        let (one, least) = (zero.splat_like(1.0), zero.splat_like(MIN_SQUARED_ALPHA));
        let uu = self.uu.max(least);
        let shortest = least * (one + self.vv);
        let vv = self.vv.max(self.uv * self.uv / uu + shortest);
        // Computed without the new `vv`, so that the determinant does not wait for the division above.
        let determinant = Self { uu, ..self }.determinant().max(uu * shortest);
        let scale = one / determinant;
        Self { uu: vv * scale, uv: zero - self.uv * scale, vv: uu * scale }
    }

    /// Returns p^T A q.
    #[inline(always)]
    pub fn between(self, p: [F; 2], q: [F; 2]) -> F {
        p[0] * q[0] * self.uu + (p[0] * q[1] + p[1] * q[0]) * self.uv + p[1] * q[1] * self.vv
    }
}

/// A lobe of slopes about a normal.
#[derive(Clone, Copy)]
pub struct Slopes<F> {
    pub mean: [F; 2],
    pub a: Matrix<F>,
}

impl<F: Real> Slopes<F> {
    #[inline(always)]
    pub fn select(self, other: Self, mask: F::Mask) -> Self {
        self.with(
            other,
            #[inline(always)]
            |own, other| own.select(other, mask),
        )
    }

    /// Combines each number with that of `other` by `of`.
    #[inline(always)]
    fn with(self, other: Self, of: impl Fn(F, F) -> F) -> Self {
        let mean = [of(self.mean[0], other.mean[0]), of(self.mean[1], other.mean[1])];
        let (own, other) = (self.a, other.a);
        Self { mean, a: Matrix { uu: of(own.uu, other.uu), uv: of(own.uv, other.uv), vv: of(own.vv, other.vv) } }
    }

    /// Adds the difference from `before` to `after`.
    #[inline(always)]
    pub fn moved(self, before: Self, after: Self) -> Self {
        let more = after.with(
            before,
            #[inline(always)]
            |after, before| after - before,
        );
        self.with(
            more,
            #[inline(always)]
            |own, more| own + more,
        )
    }

    /// Returns the next lobe of EM, given the sums of w, w x, w y, w x^2, w x y and w y^2 about the mean.
    #[inline(always)]
    pub fn next(self, [weight, x, y, xx, xy, yy]: [F; 6]) -> Self {
        let (share, two) = (weight.splat_like(1.0) / weight, weight.splat_like(2.0));
        let (dx, dy) = (x * share, y * share);
        let a = Matrix {
            uu: two * (xx * share - dx * dx),
            uv: two * (xy * share - dx * dy),
            vv: two * (yy * share - dy * dy),
        };
        let [u, v] = self.mean;
        Self { mean: [u + dx, v + dy], a }
    }

    /// Steps towards the `next` lobe, [`STRIDE`] times as far. Returns `otherwise` if the step would leave less than a
    /// tenth of the determinant of `otherwise`.
    #[inline(always)]
    pub fn step(self, next: Self, otherwise: Self) -> Self {
        let zero = self.mean[0].splat_like(0.0);
        let stride = zero.splat_like(STRIDE);
        let far = self.with(
            next,
            #[inline(always)]
            |from, to| from + stride * (to - from),
        );
        let least = zero.splat_like(0.1) * otherwise.a.determinant();
        let overshoots = far.a.determinant().lanes_le(least) | far.a.uu.lanes_le(zero);
        otherwise.select(far, overshoots)
    }
}
