//! Mixtures of many lobes in single precision: their densities at many half-vectors, on the vectors of the processor.
//!
//! A footprint has up to 1024 lobes, and its density is needed at 64 to 2048 half-vectors. `density.rs` has the same
//! formulas in double precision.

use crate::lobe::{Family, OrientedLobe, frame};
use crate::metric::density::MIN_ALPHA;
use crate::simd::{Real, dispatch, map_row};

/// A unit vector in (T, B, N).
pub type HalfVector = [f32; 3];

/// A lobe prepared for evaluation. With the dot products x, y and z of a half-vector with three vectors, the slopes s
/// about the normal have s^T A^-1 s = (x^2 + y^2) / z^2.
#[derive(Clone, Copy, Default)]
pub struct DensityTerms {
    /// T and B of the normal, transformed by the inverse of the lower triangular factor of A.
    pub axes: [HalfVector; 2],
    /// The normal.
    pub normal: HalfVector,
    /// The density at the normal, multiplied by the weight of the lobe.
    pub peak: f32,
}

/// A weighted sum of lobes.
pub struct Mixture {
    family: Family,
    terms: Vec<DensityTerms>,
}

impl Mixture {
    /// Prepares `lobes` with their weights. Lobes narrower than an alpha of 0.001 are widened, as in
    /// [`Lobe::new`](crate::metric::Lobe::new).
    pub fn new(family: Family, lobes: &[(f32, OrientedLobe)]) -> Self {
        let mut terms = vec![DensityTerms::default(); lobes.len()];
        let numbers = lobes.iter().map(|(weight, lobe)| {
            let ([x, y, z], a) = (lobe.normal, lobe.squared_alpha.0);
            [x, y, z, a.uu, a.uv, a.vv, *weight]
        });
        let store = |terms: &mut DensityTerms, [xx, xy, xz, yx, yy, yz, nx, ny, nz, peak]: [f32; 10]| {
            *terms = DensityTerms { axes: [[xx, xy, xz], [yx, yy, yz]], normal: [nx, ny, nz], peak };
        };
        map_row(numbers, &mut terms, prepared, store);
        Self { family, terms }
    }

    /// Returns the weighted sum of the densities of the lobes at each half-vector of `batches`.
    pub fn densities(&self, batches: &[Batch]) -> Vec<[f32; BATCH]> {
        let mut densities = vec![[0.0; BATCH]; batches.len()];
        let pairs = densities.iter_mut().zip(batches);
        // The compiler vectorises the closure of `for_each`, but not that of `collect`.
        dispatch!(fearless_simd::Level::new(), _simd => match self.family {
            Family::Ggx => pairs.for_each(|(densities, batch)| *densities = sums(&self.terms, batch, ggx)),
            Family::Beckmann => pairs.for_each(|(densities, batch)| *densities = sums(&self.terms, batch, beckmann)),
        });
        densities
    }
}

/// Half-vectors that are evaluated together: the sums of a batch fit into the registers of AVX-512.
pub const BATCH: usize = 64;

/// Half-vectors by coordinate, so that the compiler vectorises loops over them.
pub struct Batch([[f32; BATCH]; 3]);

impl Batch {
    /// Takes at least one and at most [`BATCH`] half-vectors. The last one is repeated to fill the batch.
    pub fn new(points: &[HalfVector]) -> Self {
        let mut batch = Self(points[points.len() - 1].map(|coordinate| [coordinate; BATCH]));
        for (i, point) in points.iter().take(BATCH).enumerate() {
            for (coordinates, coordinate) in batch.0.iter_mut().zip(point) {
                coordinates[i] = *coordinate;
            }
        }
        batch
    }
}

/// Returns the sums over `lobes` of `density(peak, slopes, z)` at each half-vector, in the order of the lobes.
#[inline(always)]
pub fn sums(lobes: &[DensityTerms], Batch([x, y, z]): &Batch, density: impl Fn(f32, f32, f32) -> f32) -> [f32; BATCH] {
    let mut sums = [0.0; BATCH];
    for &DensityTerms { axes: [u, v], normal: n, peak } in lobes {
        for i in 0..BATCH {
            let along = u[0] * x[i] + u[1] * y[i] + u[2] * z[i];
            let across = v[0] * x[i] + v[1] * y[i] + v[2] * z[i];
            let up = n[0] * x[i] + n[1] * y[i] + n[2] * z[i];
            sums[i] += density(peak, along * along + across * across, up.max(0.0));
        }
    }
    sums
}

/// Returns the density of a GGX lobe from its peak, the squared slopes times z^2, and z, which is 0 below the horizon.
#[inline(always)]
pub fn ggx(peak: f32, squared: f32, z: f32) -> f32 {
    let q = squared + z * z;
    peak * z / (q * q)
}

/// Returns the density of a Beckmann lobe, as [`ggx`] does.
#[inline(always)]
pub fn beckmann(peak: f32, squared: f32, z: f32) -> f32 {
    let inverse = 1.0 / z.max(1e-6);
    peak * exp_of_minus(squared * inverse * inverse) * inverse * inverse * inverse
}

/// Returns exp(-x) for x >= 0, with a relative error below 1e-6, and 0 beyond x = 87. The compiler vectorises this
/// function, and its bits depend on no library.
#[inline(always)]
pub fn exp_of_minus(x: f32) -> f32 {
    let scaled = -x.min(87.0) * std::f32::consts::LOG2_E;
    let whole = scaled.floor();
    let part = (scaled - whole) * std::f32::consts::LN_2;
    // The Taylor series of exp on [0, ln 2).
    let series = [1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0];
    let power = series.iter().fold(0.0, |sum, term| sum * part + term);
    let exponent = f32::from_bits(((whole as i32 + 127) as u32) << 23);
    if x < 87.0 { power * exponent } else { 0.0 }
}

/// Returns the numbers of [`DensityTerms`] of a normal, squared alphas uu, uv, vv, and a weight.
#[inline(always)]
fn prepared([nx, ny, nz, uu, uv, vv, weight]: [f32; 7]) -> [f32; 10] {
    let [t, b, n] = frame([nx, ny, nz]);
    let [l11, l21, l22] = lower_factor([uu, uv, vv]);
    let (along, across) = (1.0 / l11, 1.0 / l22);
    let u = t.map(|c| c * along);
    let [x, y, z] = [0, 1, 2].map(|i| (b[i] - l21 * u[i]) * across);
    [u[0], u[1], u[2], x, y, z, n[0], n[1], n[2], weight * std::f32::consts::FRAC_1_PI * along * across]
}

/// Returns the elements l11, l21, l22 of L with A = L L^T. Both diagonal elements are at least the least alpha.
#[inline(always)]
pub fn lower_factor([uu, uv, vv]: [f32; 3]) -> [f32; 3] {
    const LEAST: f32 = (MIN_ALPHA * MIN_ALPHA) as f32;
    let l11 = Real::max(uu, LEAST).sqrt();
    let l21 = uv / l11;
    [l11, l21, Real::max(vv - l21 * l21, LEAST).sqrt()]
}
