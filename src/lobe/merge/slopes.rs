//! A lobe as slopes about some normal, and how far an EM step takes it.

use crate::simd::Real;

/// Lobes are taken to be at least 0.001 wide: without width there is no density.
pub const MIN_SQUARED_ALPHA: f32 = 1e-6;

/// How far to go along an EM step. Where the points are a GGX lobe, one step leaves a third of what mean, width and
/// shape alike lack, so that 3/2 of it leaves nothing to first order: q has the density 1 / (1 + q)^2 and with
/// w = 1 / (1 + q), E[w] = 1/2, E[w^2 q] = 1/6 and E[w^2 q^2] = 1/3 what is left is E[w^2 q] / E[w] of the mean,
/// 2 (E[w^2 q^2] - E[w^2 q]) of the width and E[w^2 q^2] of the shape.
const STRIDE: f32 = 1.5;

/// A symmetric matrix.
#[derive(Clone, Copy, Default)]
pub struct Matrix<F> {
    pub uu: F,
    pub uv: F,
    pub vv: F,
}

impl<F: Real> Matrix<F> {
    /// |A|.
    #[inline(always)]
    fn determinant(self) -> F {
        self.uu * self.vv - self.uv * self.uv
    }

    /// A^-1, with A made as wide at least as lobes are taken to be, and wider where it is long, so that rounding leaves it a
    /// determinant.
    #[inline(always)]
    pub fn inverse(self) -> Self {
        let zero = self.uu.splat_like(0.0);
        let (one, least) = (zero.splat_like(1.0), zero.splat_like(MIN_SQUARED_ALPHA));
        let uu = self.uu.max(least);
        let shortest = least * (one + self.vv);
        let vv = self.vv.max(self.uv * self.uv / uu + shortest);
        // Not of `vv`, for whose division it would wait.
        let determinant = Self { uu, ..self }.determinant().max(uu * shortest);
        let scale = one / determinant;
        Self { uu: vv * scale, uv: zero - self.uv * scale, vv: uu * scale }
    }

    /// p^T A q.
    #[inline(always)]
    pub fn between(self, p: [F; 2], q: [F; 2]) -> F {
        p[0] * q[0] * self.uu + (p[0] * q[1] + p[1] * q[0]) * self.uv + p[1] * q[1] * self.vv
    }
}

/// A lobe as slopes about some normal.
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

    /// Each number and that of `other`, made one by `of`.
    #[inline(always)]
    fn with(self, other: Self, of: impl Fn(F, F) -> F) -> Self {
        let mean = [of(self.mean[0], other.mean[0]), of(self.mean[1], other.mean[1])];
        let (own, other) = (self.a, other.a);
        Self { mean, a: Matrix { uu: of(own.uu, other.uu), uv: of(own.uv, other.uv), vv: of(own.vv, other.vv) } }
    }

    /// Each number plus what `after` has more of it than `before`.
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

    /// The lobe after this one in EM, given the sums of w, w x, w y, w x^2, w x y and w y^2 about the mean.
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

    /// A step towards the `next` lobe, [`STRIDE`] times as far, where that leaves at least a tenth of the determinant of
    /// `otherwise`; else to this.
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
