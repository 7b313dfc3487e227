//! The best single lobe that an engine can show, found by numerical search.

use crate::math::symmetric::{self, MohrCircle};
use crate::metric::density::Lobe;
use crate::metric::reference::Reference;

/// Mean slopes, then the logarithm of A as (m + d, o, m - d). Every vector of these parameters is a valid lobe.
type Parameters = [f64; 5];

/// Returns the lobe with the least error for `reference` among those with alphas in [0.001, 1], and this error. The
/// search begins at its own starts and at the lobes of `starts`. The result is at least as good as every start.
pub fn oracle(reference: &Reference, starts: &[Lobe]) -> (Lobe, f64) {
    let mut candidates: Vec<Parameters> = starts.iter().map(parameters).collect();
    candidates.push(likeliest(reference));
    candidates.push(peak(reference));
    let coarse = |p: &Parameters| reference.error_of_every(4, &lobe(reference, p));
    let mut ranked: Vec<(f64, Parameters)> = candidates.iter().map(|p| (coarse(p), *p)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    // A footprint with two peaks has two minima: descend from the two best starts, then finish from the better result.
    let minima = ranked.iter().take(2).map(|(_, p)| descend(&coarse, *p, 0.5, 160));
    let best = minima.min_by(|a, b| a.0.total_cmp(&b.0)).map_or([0.0; 5], |(_, p)| p);
    let fine = |p: &Parameters| reference.error(&lobe(reference, p));
    let (error, best) = descend(&fine, best, 0.15, 120);
    let searched = (lobe(reference, &best), error);
    let given = starts.iter().map(|l| (*l, reference.error(l)));
    given.chain([searched]).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(searched)
}

fn lobe(reference: &Reference, p: &Parameters) -> Lobe {
    let [u, v, mean, difference, off] = *p;
    let circle = MohrCircle::from_parts(mean, [difference, off]);
    // The matrix exponential by way of the eigenvalues, with alphas clamped to at most 1.
    let a = circle.matrix_with(circle.eigenvalues().map(|log| libm::exp(log.clamp(-13.8, 0.0))));
    Lobe::new(reference.family(), [-u, -v, 1.0], a)
}

fn parameters(lobe: &Lobe) -> Parameters {
    let [x, y, z] = lobe.normal();
    let z = z.max(1e-3);
    from_slopes_and_a([-x / z, -y / z], lobe.squared_alpha())
}

fn from_slopes_and_a([u, v]: [f64; 2], a: [f64; 3]) -> Parameters {
    let circle = MohrCircle::from(a);
    let [major, minor] = circle.eigenvalues().map(|a| libm::log(a.clamp(1e-6, 1.0)));
    let [cos, sin] = circle.doubled_axis();
    let half_spread = 0.5 * (major - minor);
    [u, v, 0.5 * (major + minor), half_spread * cos, half_spread * sin]
}

/// Returns a start of the search: the GGX lobe under which the half-vectors are likeliest. GGX slopes are a bivariate
/// Student t distribution with two degrees of freedom, fitted by EM with weights 2 / (1 + q), q = s^T A^-1 s (C. Liu,
/// D. Rubin, "ML estimation of the t distribution using EM and its extensions", 1995).
fn likeliest(reference: &Reference) -> Parameters {
    let points = reference.points();
    let slopes: Vec<[f64; 2]> =
        points.iter().step_by(8).filter(|h| h[2] > 0.05).map(|h| [-h[0] / h[2], -h[1] / h[2]]).collect();
    let count = slopes.len().max(1) as f64;
    let (mut mean, mut a) = ([0.0; 2], [1.0_f64, 0.0, 1.0]);
    for _ in 0..30 {
        let determinant = symmetric::determinant(a).max(1e-12);
        let (mut total, mut sum, mut products) = (0.0, [0.0; 2], [0.0; 3]);
        for [u, v] in &slopes {
            let (x, y) = (u - mean[0], v - mean[1]);
            let q = (a[2] * x * x - 2.0 * a[1] * x * y + a[0] * y * y) / determinant;
            let weight = 2.0 / (1.0 + q);
            total += weight;
            sum = [sum[0] + weight * u, sum[1] + weight * v];
            for (product, value) in products.iter_mut().zip([x * x, x * y, y * y]) {
                *product += weight * value;
            }
        }
        if total > 0.0 {
            mean = sum.map(|s| s / total);
        }
        a = products.map(|p| 2.0 * p / count);
        a = [a[0].max(1e-6), a[1], a[2].max(1e-6)];
    }
    from_slopes_and_a(mean, a)
}

/// Returns a start of the search: an isotropic lobe at the point of highest density, whose peak is this density.
fn peak(reference: &Reference) -> Parameters {
    let pairs = reference.points().iter().zip(reference.densities());
    let highest = pairs.filter(|(h, _)| h[2] > 0.05).max_by(|a, b| a.1.total_cmp(b.1));
    highest.map_or([0.0, 0.0, -1.0, 0.0, 0.0], |(h, density)| {
        let squared = 1.0 / (std::f64::consts::PI * density);
        from_slopes_and_a([-h[0] / h[2], -h[1] / h[2]], [squared, 0.0, squared])
    })
}

/// Minimises `value` by the downhill simplex of J. Nelder and R. Mead, "A simplex method for function minimization",
/// 1965. Returns the least value found, and where. `step` is the size of the first simplex, in alphas for the slopes
/// and in logarithms for A.
fn descend(value: &dyn Fn(&Parameters) -> f64, start: Parameters, step: f64, evaluations: usize) -> (f64, Parameters) {
    const N: usize = 5;
    let width = libm::exp(0.5 * start[2]);
    let steps = [step * width, step * width, step, step, step];
    let mut simplex: Vec<(f64, Parameters)> = Vec::with_capacity(N + 1);
    simplex.push((value(&start), start));
    for i in 0..N {
        let mut corner = start;
        corner[i] += steps[i];
        simplex.push((value(&corner), corner));
    }
    let mut left = evaluations.saturating_sub(N + 1);
    while left > 0 {
        simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
        if simplex[N].0 - simplex[0].0 < 1e-5 {
            break;
        }
        let mut centre = [0.0; N];
        for (_, corner) in &simplex[..N] {
            for (c, x) in centre.iter_mut().zip(corner) {
                *c += x / N as f64;
            }
        }
        let worst = simplex[N];
        let along = |t: f64| {
            let mut p = centre;
            for (c, x) in p.iter_mut().zip(worst.1) {
                *c += t * (x - *c);
            }
            (value(&p), p)
        };
        let reflected = along(-1.0);
        left = left.saturating_sub(2);
        if reflected.0 < simplex[0].0 {
            let expanded = along(-2.0);
            simplex[N] = if expanded.0 < reflected.0 { expanded } else { reflected };
        } else if reflected.0 < simplex[N - 1].0 {
            simplex[N] = reflected;
        } else {
            let contracted = along(if reflected.0 < worst.0 { -0.5 } else { 0.5 });
            if contracted.0 < worst.0.min(reflected.0) {
                simplex[N] = contracted;
            } else {
                let best = simplex[0].1;
                for corner in &mut simplex[1..] {
                    let halfway = [0, 1, 2, 3, 4].map(|i| 0.5 * (best[i] + corner.1[i]));
                    *corner = (value(&halfway), halfway);
                }
                left = left.saturating_sub(N);
            }
        }
    }
    simplex.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, start))
}
