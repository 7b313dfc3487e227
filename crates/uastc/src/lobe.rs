//! The error of a normal by what it does to a lobe.
//!
//! A texel's lobe is a density of slopes in the tangent plane of its normal. GGX lobes are bivariate Student t
//! densities with 2 degrees of freedom: P(s) = 1 / (pi sqrt|A|) (1 + s^T A^-1 s)^-2 with the matrix A of squared
//! alphas.
//! A wrong normal shifts this density by an offset d. The total variation between both densities is the share of
//! reflected light that goes the wrong way. With q = d^T A^-1 d it is sqrt(q / (q + 4)): the densities are equal where
//! s is equally far from both centres, and the marginal distribution of a lobe of alpha 1 is
//! 1/2 + x / (2 sqrt(1 + x^2)) with x = sqrt(q) / 2 there.

#![expect(clippy::manual_clamp, reason = "NaN becomes a bound, while `clamp` keeps NaN")]

use fearless_simd::{Simd, SimdBase, prelude::*};

use crate::blocks::Blocks;
use crate::direction::{DirectionMetric, Entry, Normals, UNIT};
use crate::lanes::Grid;
use texel_simd::{LANES, Real, Wide};

/// The squared alphas (squared widths in slopes) of the GGX lobe about a texel's normal.
///
/// The axes are T, which is the axis of red made perpendicular to the normal N, and B = N x T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// The squared alpha along T.
    pub uu: f32,
    /// The element of the matrix off the diagonal.
    pub uv: f32,
    /// The squared alpha along B.
    pub vv: f32,
}

impl Lobe {
    /// Returns the lobe of one `alpha` in all directions.
    pub fn isotropic(alpha: f32) -> Self {
        Self { uu: alpha * alpha, uv: 0.0, vv: alpha * alpha }
    }
}

/// The least squared alpha that a lobe counts with: that of an alpha of one level, at a roughness of 0.09. Narrower
/// lobes miss their reference after any encoding, and their sums would sacrifice texels without bounds.
const LEAST: f32 = 1.0 / (UNIT * UNIT);

/// The largest squared alpha that a lobe counts with.
const MOST: f32 = 1e4;

/// The least square of a factor that lines are fitted with, for alphas of which one is eight times the other.
const LEAST_SCALE: f32 = 2.0 / 65.0;

/// The least z of a normal that offsets are computed with. Steeper normals are treated like this one.
const LEAST_Z: f32 = 0.1;

/// The lobes of the texels of one block.
pub(crate) type BlockLobes = [Lobe; 16];

/// The lobes of the texels of one block in each lane, as functions of a direction's x and y.
///
/// The squared distance between a direction and the normal is e^2 + f^2 with e = `ex` x + `ey` y - `e` and
/// f = `fy` y - `f`. It is d^T A^-1 d multiplied by sqrt|A| and by the square of [`UNIT`].
pub(crate) struct Lobes<S: Simd> {
    ex: Grid<S>,
    ey: Grid<S>,
    e: Grid<S>,
    fy: Grid<S>,
    f: Grid<S>,
    /// What squared distances are multiplied by to give q.
    factor: Grid<S>,
}

impl<S: Simd> Lobes<S> {
    /// Loads the lobes about `normals`, one block into each lane.
    #[inline(always)]
    pub fn load(simd: S, blocks: [&BlockLobes; LANES], normals: &Normals<S>) -> Self {
        let zero = [Wide::splat(simd, 0.0); 16];
        let mut all = Self { ex: zero, ey: zero, e: zero, fy: zero, f: zero, factor: zero };
        for i in 0..16 {
            // NaN becomes a bound, so that every machine gives the same bytes.
            let uu = Wide::simd_from(simd, blocks.map(|lobes| lobes[i].uu.max(LEAST).min(MOST)));
            let uv = Wide::simd_from(simd, blocks.map(|lobes| lobes[i].uv.max(-MOST).min(MOST)));
            let vv = Wide::simd_from(simd, blocks.map(|lobes| lobes[i].vv.max(LEAST).min(MOST)));
            let direction = [normals[0][i], normals[1][i], normals[2][i]];
            let [ex, ey, fy, factor] = coefficients(direction, [uu, uv, vv]);
            (all.ex[i], all.ey[i], all.fy[i], all.factor[i]) = (ex, ey, fy, factor);
            all.e[i] = ex * direction[0] + ey * direction[1];
            all.f[i] = fy * direction[1];
        }
        all
    }
}

/// Returns factors of x and y, whose mean square is 1, by which squared differences become like the distances of the
/// lobes in each block. Lines are fitted to such x and y before lobes are looked at one by one.
#[inline(always)]
pub(crate) fn block_scale<S: Simd>(simd: S, blocks: [&BlockLobes; LANES]) -> [Wide<S>; 2] {
    // Lobes differ little within a block: four of them stand for all sixteen.
    let sum = |of: fn(&Lobe) -> f32| {
        let sum = |lobes: &BlockLobes| (of(&lobes[0]) + of(&lobes[5])) + (of(&lobes[10]) + of(&lobes[15]));
        Wide::simd_from(simd, blocks.map(|lobes| sum(lobes).max(LEAST).min(MOST)))
    };
    let (uu, vv) = (sum(|lobe| lobe.uu), sum(|lobe| lobe.vv));
    // Distances grow with vv in x and with uu in y, since both are divided by the same determinant.
    let share = Wide::splat(simd, 2.0) / (uu + vv);
    let scale = |squared: Wide<S>| Real::sqrt(Real::max(squared * share, Wide::splat(simd, LEAST_SCALE)));
    [scale(vv), scale(uu)]
}

/// Returns `ex`, `ey`, `fy` and `factor` of [`Lobes`] for a normal of length [`UNIT`] and the elements of A.
#[inline(always)]
pub(crate) fn coefficients<F: Real>([x, y, z]: [F; 3], [uu, uv, vv]: [F; 3]) -> [F; 4] {
    let splat = |value: f32| x.splat_like(value);
    let (one, unit) = (splat(1.0), splat(1.0 / UNIT));
    let (x, y, z) = (x * unit, y * unit, (z * unit).max(splat(LEAST_Z)));
    // An alpha may be at most 100 times the other one.
    let determinant = (uu * vv - uv * uv).max(uu * vv * splat(4e-4));
    let scale = one / determinant.sqrt();
    // A change (dx, dy) of a unit normal moves it by dx / s along T and by (x y dx + s^2 dy) / (s z) along B.
    let s = (one - x * x).max(splat(LEAST_Z * LEAST_Z)).sqrt();
    let inverse = one / (s * z);
    let (along_t, b_by_x, b_by_y) = (z * inverse, x * y * inverse, s * s * inverse);
    // The inverse of A, multiplied by sqrt|A|, in changes of x and y.
    let (tt, tb, bb) = (vv * scale, splat(0.0) - uv * scale, uu * scale);
    let xx = tt * along_t * along_t + splat(2.0) * tb * along_t * b_by_x + bb * b_by_x * b_by_x;
    let xy = (tb * along_t + bb * b_by_x) * b_by_y;
    let ex = xx.max(splat(1e-6)).sqrt();
    let inverse_ex = one / ex;
    // The determinant of this matrix is 1 / z^2.
    [ex, xy * inverse_ex, s * inverse * inverse_ex, scale * unit * unit]
}

/// Returns the total variation between two equal GGX lobes at squared distance `q`.
#[inline(always)]
pub(crate) fn total_variation<F: Real>(q: F) -> F {
    (q / (q + q.splat_like(4.0))).sqrt()
}

/// Errors of normals: the total variation between the lobe about the wanted normal and the lobe about the decoded one.
#[derive(Clone, Copy)]
pub(crate) struct LobeErrors<'a, S: Simd> {
    pub normals: &'a Normals<S>,
    pub lobes: &'a Lobes<S>,
}

impl<S: Simd> LobeErrors<'_, S> {
    /// Returns the squared distance of the direction with this `x` and `y`.
    #[inline(always)]
    fn squared(&self, i: usize, x: Wide<S>, y: Wide<S>) -> Wide<S> {
        let lobes = self.lobes;
        let e = lobes.ex[i] * x + lobes.ey[i] * y - lobes.e[i];
        let f = lobes.fy[i] * y - lobes.f[i];
        e * e + f * f
    }
}

impl<S: Simd> DirectionMetric<S> for LobeErrors<'_, S> {
    #[inline(always)]
    fn normals(&self) -> &Normals<S> {
        self.normals
    }

    #[inline(always)]
    fn distance(&self, i: usize, entry: &Entry<S>) -> Wide<S> {
        let [x, y, _] = entry.direction;
        self.squared(i, x, y) + entry.loss
    }

    #[inline(always)]
    fn error(&self, i: usize, distance: Wide<S>) -> Wide<S> {
        total_variation(distance * self.lobes.factor[i])
    }

    #[inline(always)]
    fn patterns(&self) -> usize {
        4
    }

    /// Errors of x and y by squared distance say nothing about the errors of lobes, which lie between 0 and 16.
    #[inline(always)]
    fn may_win(&self, _: &Blocks<S>, error: Wide<S>) -> <Wide<S> as Real>::Mask {
        error.simd_gt(0.0)
    }

    /// Returns a weight of iterated reweighted least squares. The total variation divided by q is 1 / sqrt(q (q + 4)),
    /// which has no bound at 0. Quantised endpoints cannot follow such weights: 1 / (q + 4) gives sums that are 0.3 %
    /// lower after one round, and equal sums after three.
    #[inline(always)]
    fn weight(&self, i: usize, [x, y, _]: [Wide<S>; 3]) -> Option<Wide<S>> {
        let factor = self.lobes.factor[i];
        Some(factor / (self.squared(i, x, y) * factor + 4.0))
    }
}
