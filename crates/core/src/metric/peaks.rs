//! Footprints with two peaks, which no single lobe can follow.

use crate::lobe::Family;
use crate::math::symmetric::MohrCircle;
use crate::math::vector::{Vector, normalised};
use crate::metric::density::Lobe;
use crate::metric::footprint::{Footprint, slope};

/// A valley counts when its density is below this share of the lower peak. Two equal normal distributions that are 2.7
/// standard deviations apart have such a valley.
const VALLEY: f64 = 0.8;

/// Returns whether the density of half-vectors has a valley between two groups of slopes, split along their main axis.
/// Groups that the base lobe blurs into one peak count as one.
pub fn is_two_peaked(family: Family, footprint: &Footprint) -> bool {
    let m = footprint.moments();
    let axis = MohrCircle::from(m.covariance).axis();
    let length = (axis[0] * axis[0] + axis[1] * axis[1]).sqrt();
    if length <= 0.0 {
        return false;
    }
    let along = |[u, v]: [f64; 2]| ((u - m.mean[0]) * axis[0] + (v - m.mean[1]) * axis[1]) / length;
    let mut parts: Vec<(f64, f64, [f64; 2])> =
        footprint.parts().iter().map(|p| (along(slope(p.normal)), p.weight, slope(p.normal))).collect();
    parts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some([low, high]) = two_groups(&parts) else { return false };
    let lobes: Vec<(f64, Lobe)> =
        footprint.parts().iter().map(|p| (p.weight, Lobe::new(family, p.normal, p.base))).collect();
    let density = |at: f64| {
        let [u, v] = [0, 1].map(|i| low[i] + at * (high[i] - low[i]));
        let h: Vector = normalised([-u, -v, 1.0]);
        lobes.iter().map(|(weight, lobe)| weight * lobe.density(h)).sum::<f64>()
    };
    let peak = |range: std::ops::RangeInclusive<i32>| range.map(|i| density(0.1 * f64::from(i))).fold(0.0, f64::max);
    let valley = (1..10).map(|i| density(0.1 * f64::from(i))).fold(f64::INFINITY, f64::min);
    valley < VALLEY * peak(-2..=2).min(peak(8..=12))
}

/// Returns the mean slopes of two groups of `parts`, which are sorted by their position along an axis. The split is the
/// one that explains most of the variance (N. Otsu, "A threshold selection method from gray-level histograms", 1979).
/// Returns `None` when there is no split, or when a group has less than a tenth of the weight.
fn two_groups(parts: &[(f64, f64, [f64; 2])]) -> Option<[[f64; 2]; 2]> {
    let sums = |parts: &[(f64, f64, [f64; 2])]| {
        parts.iter().fold([0.0; 4], |s, (at, w, [u, v])| [s[0] + w, s[1] + w * at, s[2] + w * u, s[3] + w * v])
    };
    let total = sums(parts);
    let mut below = [0.0; 4];
    let (mut most, mut groups) = (0.0, None);
    for pair in parts.windows(2) {
        let (at, weight, [u, v]) = pair[0];
        for (sum, x) in below.iter_mut().zip([weight, weight * at, weight * u, weight * v]) {
            *sum += x;
        }
        let above = [0, 1, 2, 3].map(|k| total[k] - below[k]);
        let between = below[1] / below[0] - above[1] / above[0];
        let explained = below[0] * above[0] * between * between;
        if pair[1].0 > at && above[0] > 0.0 && explained > most {
            (most, groups) = (explained, Some((below, above)));
        }
    }
    let (low, high) = groups?;
    let mean = |s: [f64; 4]| [s[2] / s[0], s[3] / s[0]];
    (low[0].min(high[0]) >= 0.1 * total[0]).then(|| [mean(low), mean(high)])
}
