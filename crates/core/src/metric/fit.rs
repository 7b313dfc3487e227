//! Fits the lobe of a texel to its footprint by the lobe error.

use std::sync::LazyLock;

use crate::lobe::{Family, OrientedLobe, SquaredAlpha, frame};
use crate::math::symmetric::Symmetric2;
use crate::metric::density::unit_slope;
use crate::metric::mixture::{BATCH, Batch, DensityTerms, HalfVector, Mixture, beckmann, ggx, lower_factor, sums};
use crate::metric::reference::even_point;
use crate::simd::{dispatch, map_row};

/// How much work a fit does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitEffort {
    /// Half-vectors that represent the footprint, a multiple of 64.
    pub half_vectors: usize,
    /// How long the search goes on.
    pub search: Search,
    /// EM steps towards the likeliest lobe, which is another start unless this number is 0.
    pub likelihood_steps: usize,
}

/// The length of the search for the least error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Starts from which the search descends: the best of the lobes that are tried.
    pub descents: usize,
    /// The most rounds of a descent over all its directions.
    pub rounds: usize,
}

/// Returns the lobe with the least error for the mixture of `parts` (weights that sum to 1, lobes) that a search
/// finds. The search compares lobes at half-vectors whose sequence begins at `first`. At these the result is no worse
/// than `start` and than the lobe with the mean normal and the mean squared alphas.
///
/// The search descends from the best of several starts. Besides these two there are the likeliest lobe of the
/// half-vectors, and a narrow lobe where the density is highest: in a footprint of two populations, such as mirror
/// tiles beside rough grout, the narrow population is a minimum of its own.
pub fn fit(
    family: Family,
    parts: &[(f32, OrientedLobe)],
    start: OrientedLobe,
    effort: FitEffort,
    first: usize,
) -> OrientedLobe {
    let target = Target::new(family, parts, effort.half_vectors, first);
    let given = Candidate::of(&start);
    let steps = effort.likelihood_steps;
    let likeliest = (steps > 0).then(|| target.likeliest(given, steps));
    let starts = [Some(given), mean_lobe(parts), likeliest, target.peak()].into_iter().flatten();
    let mut starts: Vec<(f32, Candidate)> = starts.map(|lobe| (target.error(&lobe), lobe)).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Search { descents, rounds } = effort.search;
    let minima = starts.iter().take(descents).map(|start| target.descend(*start, rounds));
    let best = minima.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(start, |(_, lobe)| lobe.lobe())
}

/// Returns the mean normal with the mean squared alphas; `None` if the mean normal is not above the surface.
fn mean_lobe(parts: &[(f32, OrientedLobe)]) -> Option<Candidate> {
    let (mut normal, mut a) = ([0.0; 3], Symmetric2::ZERO);
    for (weight, lobe) in parts {
        normal.iter_mut().zip(lobe.normal).for_each(|(sum, c)| *sum += weight * c);
        a = a + *weight * lobe.squared_alpha.0;
    }
    let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
    let normal = normal.map(|c| c / length);
    (normal[2] >= LEAST_Z).then(|| Candidate::of(&OrientedLobe { normal, squared_alpha: SquaredAlpha(a) }))
}

/// A lobe in the search: its density is that of slopes W s about the normal, with A^-1 = W^T W.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    normal: HalfVector,
    w: [[f32; 2]; 2],
}

impl Candidate {
    /// Takes a lobe, with alphas of at most 1.
    fn of(OrientedLobe { normal, squared_alpha: SquaredAlpha(a) }: &OrientedLobe) -> Self {
        let eigen = a.eigen();
        let a = Symmetric2::from_axes(eigen.major.min(1.0), eigen.minor.min(1.0), eigen.axis);
        let [l11, l21, l22] = lower_factor([a.uu, a.uv, a.vv]);
        Self { normal: *normal, w: [[1.0 / l11, 0.0], [-l21 / (l11 * l22), 1.0 / l22]] }
    }

    fn determinant(&self) -> f32 {
        let [[a, b], [c, d]] = self.w;
        (a * d - b * c).abs()
    }

    fn lobe(&self) -> OrientedLobe {
        let [[a, b], [c, d]] = self.w;
        // A = (W^T W)^-1.
        let scale = 1.0 / (self.determinant() * self.determinant());
        let matrix = Symmetric2::new(scale * (b * b + d * d), -scale * (a * b + c * d), scale * (a * a + c * c));
        OrientedLobe { normal: self.normal, squared_alpha: SquaredAlpha(matrix) }
    }

    fn terms(&self) -> DensityTerms {
        let [t, b, normal] = frame(self.normal);
        let axes = self.w.map(|[u, v]| [0, 1, 2].map(|i| u * t[i] + v * b[i]));
        DensityTerms { axes, normal, peak: std::f32::consts::FRAC_1_PI * self.determinant() }
    }

    /// Returns whether both alphas are in [0.001, 1] and the normal is above the surface.
    fn is_valid(&self) -> bool {
        let [[a, b], [c, d]] = self.w;
        let half_trace = 0.5 * (a * a + b * b + c * c + d * d);
        let root = (half_trace * half_trace - self.determinant() * self.determinant()).max(0.0).sqrt();
        half_trace - root >= 0.9999 && half_trace + root <= 1.0001e6 && self.normal[2] >= LEAST_Z
    }

    /// Returns the lobe moved by `step` along one of [`DIRECTIONS`]: the normal along the axes of W, in alphas; or W
    /// multiplied by I + step S, with S = I, diag(1, -1) and [[0, 1], [1, 0]].
    fn moved(&self, direction: usize, step: f32) -> Self {
        let [[a, b], [c, d]] = self.w;
        if direction < 2 {
            let [t, bitangent, n] = frame(self.normal);
            let scale = step / (a * d - b * c);
            let [u, v] = if direction == 0 { [d * scale, -c * scale] } else { [-b * scale, a * scale] };
            let moved = [0, 1, 2].map(|i| n[i] + u * t[i] + v * bitangent[i]);
            let length = moved.iter().map(|x| x * x).sum::<f32>().sqrt();
            return Self { normal: moved.map(|x| x / length), w: self.w };
        }
        let [up, down] = [1.0 + step, 1.0 / (1.0 + step)];
        let w = match direction {
            2 => [[a * up, b * up], [c * up, d * up]],
            3 => [[a * up, b * up], [c * down, d * down]],
            _ => [[a + step * c, b + step * d], [c + step * a, d + step * b]],
        };
        Self { normal: self.normal, w }
    }
}

/// Directions of the search.
const DIRECTIONS: usize = 5;
/// The first step in each direction, in alphas.
const STEPS: [f32; DIRECTIONS] = [0.25, 0.25, 0.2, 0.15, 0.15];
/// The search ends when all steps are shorter.
const LEAST_STEP: f32 = 0.02;
/// The least z of a normal, at 87 degrees.
const LEAST_Z: f32 = 0.05;

/// The half-vectors that represent a footprint, with the footprint's density at each.
struct Target {
    family: Family,
    points: Vec<HalfVector>,
    batches: Vec<Batch>,
    /// 1 / density at each half-vector.
    inverse: Vec<[f32; BATCH]>,
    densest: Option<(HalfVector, f32)>,
}

impl Target {
    fn new(family: Family, parts: &[(f32, OrientedLobe)], count: usize, first: usize) -> Self {
        let points = half_vectors(family, parts, count, first);
        let batches: Vec<Batch> = points.chunks_exact(BATCH).map(Batch::new).collect();
        let densities = Mixture::new(family, parts).densities(&batches);
        let densest = points.iter().copied().zip(densities.iter().flatten().copied());
        let densest = densest.max_by(|a, b| a.1.total_cmp(&b.1));
        let inverse = densities.iter().map(|d| d.map(|d| 1.0 / d.max(1e-20))).collect();
        Self { family, points, batches, inverse, densest }
    }

    /// Returns the lobe error: the mean of (1 - P / P_ref)+ over half-vectors of P_ref.
    fn error(&self, lobe: &Candidate) -> f32 {
        let terms = [lobe.terms()];
        let batches = self.batches.iter().zip(&self.inverse);
        let total: f32 = dispatch!(fearless_simd::Level::new(), _simd => match self.family {
            Family::Ggx => batches.map(|(batch, inverse)| missing(sums(&terms, batch, ggx), inverse)).sum(),
            Family::Beckmann => batches.map(|(batch, inverse)| missing(sums(&terms, batch, beckmann), inverse)).sum(),
        });
        total / self.points.len() as f32
    }

    /// Moves `start` along each direction as long as this lowers the error. Steps are halved when they fail.
    fn descend(&self, start: (f32, Candidate), rounds: usize) -> (f32, Candidate) {
        let mut best = start;
        let mut steps = STEPS;
        for _ in 0..rounds {
            if steps.iter().all(|step| step.abs() < LEAST_STEP) {
                break;
            }
            for (direction, step) in steps.iter_mut().enumerate() {
                let better = [*step, -*step].into_iter().find_map(|step| {
                    let lobe = best.1.moved(direction, step);
                    let error = if lobe.is_valid() { self.error(&lobe) } else { f32::INFINITY };
                    (error < best.0).then_some((error, step, lobe))
                });
                match better {
                    // The next step goes on in the direction that succeeded.
                    Some((error, taken, lobe)) => (best, *step) = ((error, lobe), taken),
                    None => *step *= 0.5,
                }
            }
        }
        best
    }

    /// Returns a narrow lobe at the half-vector of the highest density, with this density as its peak.
    fn peak(&self) -> Option<Candidate> {
        let (normal, density) = self.densest?;
        let squared = (std::f32::consts::FRAC_1_PI / density).clamp(1e-6, 1.0);
        let lobe = OrientedLobe { normal, squared_alpha: SquaredAlpha(Symmetric2::diagonal(squared, squared)) };
        (normal[2] >= LEAST_Z).then(|| Candidate::of(&lobe))
    }

    /// Returns the likeliest lobe of the half-vectors: EM steps with the weights 1 / (1 + q) of slopes about the
    /// normal of `start`, as in `lobe/merge`.
    fn likeliest(&self, start: Candidate, steps: usize) -> Candidate {
        let [t, b, n] = frame(start.normal);
        let along = |axis: HalfVector, h: &HalfVector| axis[0] * h[0] + axis[1] * h[1] + axis[2] * h[2];
        let slopes: Vec<[f32; 2]> = self
            .points
            .iter()
            .map(|h| [along(t, h), along(b, h), along(n, h).max(LEAST_Z)])
            .map(|[x, y, z]| [x / z, y / z])
            .collect();
        let (mut mean, mut a) = ([0.0_f32; 2], start.lobe().squared_alpha.0);
        for _ in 0..steps {
            let determinant = (a.uu * a.vv - a.uv * a.uv).max(1e-12);
            let (mut total, mut sum, mut products) = (0.0, [0.0; 2], [0.0; 3]);
            for [u, v] in &slopes {
                let (x, y) = (u - mean[0], v - mean[1]);
                let q = (a.vv * x * x - 2.0 * a.uv * x * y + a.uu * y * y) / determinant;
                let weight = 1.0 / (1.0 + q);
                total += weight;
                sum = [sum[0] + weight * u, sum[1] + weight * v];
                for (product, value) in products.iter_mut().zip([x * x, x * y, y * y]) {
                    *product += weight * value;
                }
            }
            mean = sum.map(|s| s / total);
            // Division by the sum of the weights, which is 1/2 for each half-vector of a GGX lobe, converges faster.
            let [uu, uv, vv] = products.map(|p| 2.0 * p / total);
            a = Symmetric2::new(uu.max(1e-6), uv, vv.max(1e-6));
        }
        let moved = [0, 1, 2].map(|i| n[i] + mean[0] * t[i] + mean[1] * b[i]);
        let length = moved.iter().map(|x| x * x).sum::<f32>().sqrt();
        let lobe = OrientedLobe { normal: moved.map(|x| x / length), squared_alpha: SquaredAlpha(a) };
        if lobe.normal[2] >= LEAST_Z { Candidate::of(&lobe) } else { start }
    }
}

/// Returns the sum of (1 - density * inverse)+, added in pairs: the order does not depend on the vectors.
#[inline(always)]
fn missing(densities: [f32; BATCH], inverse: &[f32; BATCH]) -> f32 {
    let mut missing = [0.0; BATCH];
    for i in 0..BATCH {
        missing[i] = (1.0 - densities[i] * inverse[i]).max(0.0);
    }
    let mut width = BATCH / 2;
    while width > 0 {
        for i in 0..width {
            missing[i] += missing[i + width];
        }
        width /= 2;
    }
    missing[0]
}

/// Unit slopes of half-vectors: [`TABLE`] points that fill a lobe of A = 1 evenly.
static GGX_SLOPES: LazyLock<Vec<[f32; 2]>> = LazyLock::new(|| slopes_of(Family::Ggx));
static BECKMANN_SLOPES: LazyLock<Vec<[f32; 2]>> = LazyLock::new(|| slopes_of(Family::Beckmann));

/// Points of a table of slopes.
const TABLE: usize = 4096;

fn slopes_of(family: Family) -> Vec<[f32; 2]> {
    (0..TABLE).map(|i| unit_slope(family, even_point(i)).map(|c| c as f32)).collect()
}

/// Multiples of this number, without their whole parts, fill [0, 1) evenly: (sqrt 5 - 1) / 2.
const GOLDEN: f32 = 0.618_034;

/// Returns `count` half-vectors of the mixture of `parts`, whose weights sum to 1: equally many for equal weights.
fn half_vectors(family: Family, parts: &[(f32, OrientedLobe)], count: usize, first: usize) -> Vec<HalfVector> {
    let table = match family {
        Family::Ggx => &GGX_SLOPES,
        Family::Beckmann => &BECKMANN_SLOPES,
    };
    let (mut part, mut below) = (0, 0.0);
    let lobes_and_slopes = (0..count).map(|i| {
        let place = (first + i) % TABLE;
        // Equally spaced places could follow the bumps of a periodic map.
        let jitter = place as f32 * GOLDEN;
        let chosen = (i as f32 + (jitter - (jitter as u32) as f32)) / count as f32;
        while part + 1 < parts.len() && below + parts[part].0 <= chosen {
            below += parts[part].0;
            part += 1;
        }
        let (OrientedLobe { normal: [nx, ny, nz], squared_alpha: SquaredAlpha(a) }, [x, y]) =
            (parts[part].1, table[place]);
        [nx, ny, nz, a.uu, a.uv, a.vv, x, y]
    });
    let mut half_vectors = vec![HalfVector::default(); count];
    map_row(lobes_and_slopes, &mut half_vectors, half_vector, |out, h| *out = h);
    half_vectors
}

/// Returns the half-vector of a lobe, given as its normal and squared alphas uu, uv and vv, for a slope (x, y) of the
/// lobe of A = 1.
#[inline(always)]
fn half_vector([nx, ny, nz, uu, uv, vv, x, y]: [f32; 8]) -> HalfVector {
    let ([t, b, n], [l11, l21, l22]) = (frame([nx, ny, nz]), lower_factor([uu, uv, vv]));
    let h = [0, 1, 2].map(|i| n[i] + l11 * x * t[i] + (l21 * x + l22 * y) * b[i]);
    let length = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt();
    h.map(|c| c / length)
}

#[cfg(test)]
mod tests;
