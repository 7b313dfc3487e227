//! Clustering of a footprint's parts: few lobes stand for many, so that a sample site is made quickly.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::math::symmetric::MohrCircle;
use crate::metric::footprint::{Footprint, Part, add_products, slope};

/// Coordinates of a part in the space in which parts are clustered.
const DIMENSIONS: usize = 5;

/// A part as a point to be clustered. Its coordinates are the slopes in widths of the mean lobe, the logarithm of the
/// width of the part's lobe, and the elongation of the part's lobe. A step of 1 counts alike in each coordinate. The
/// struct is small because splitting moves it many times.
struct ClusterPoint {
    position: [f32; DIMENSIONS],
    weight: f32,
    part: u32,
}

/// Returns `parts` as a footprint of at most `limit` parts. Returns `None` where [`Footprint::new`] does.
///
/// The cluster that varies most (its weight times its variance) is split at the mean of the axis along which it varies
/// most, until there are `limit` clusters. A cluster becomes one lobe about its mean slope: the mean of its parts'
/// lobes, widened by twice the covariance of its slopes. Clusters are close together in slope, not in position on the
/// map, so this widening is small.
pub fn clustered(parts: Vec<Part>, limit: usize) -> Option<Footprint> {
    if parts.len() <= limit {
        return Footprint::new(parts);
    }
    let squared = |p: &Part| (0.5 * (p.base[0] + p.base[2])).max(1e-12);
    let total: f64 = parts.iter().map(|p| p.weight).sum();
    let alpha = (parts.iter().map(|p| p.weight * squared(p)).sum::<f64>() / total).sqrt();
    let as_point = |(index, part): (u32, &Part)| {
        let [u, v] = slope(part.normal);
        let [along, across] = elongation(part.base);
        let position = [u / alpha, v / alpha, 0.5 * libm::log(squared(part)), along, across].map(|c| c as f32);
        ClusterPoint { position, weight: (part.weight / total) as f32, part: index }
    };
    let mut points: Vec<ClusterPoint> = (0..).zip(&parts).map(as_point).collect();
    let mut clusters = BinaryHeap::from([Cluster::new(&mut points)]);
    while clusters.len() < limit && clusters.peek().is_some_and(|c| c.variation > 0.0) {
        let Some(widest) = clusters.pop() else { break };
        clusters.extend(widest.split().into_iter().filter(|c| !c.members.is_empty()));
    }
    // The order is the heap's, which is the same for equal input.
    Footprint::new(clusters.into_vec().iter().filter_map(|c| merge(&parts, c.members)).collect())
}

/// Returns the logarithm of the ratio of a lobe's alphas as a vector at twice the angle of the larger alpha.
fn elongation(a: [f64; 3]) -> [f64; 2] {
    let circle = MohrCircle::from(a);
    let [major, minor] = circle.eigenvalues();
    if circle.radius <= 0.0 {
        return [0.0; 2];
    }
    // The ratio is bounded because alphas do not reach 0 in shaders.
    let ratio = major / minor.max(1e-6);
    circle.direction.map(|c| 0.5 * libm::log(ratio) * c / circle.radius)
}

/// Neighbouring points, and how much they vary.
struct Cluster<'a> {
    members: &'a mut [ClusterPoint],
    /// Weight times variance along `axis`, the axis with the largest variance.
    variation: f32,
    axis: usize,
    mean: f32,
}

impl<'a> Cluster<'a> {
    fn new(members: &'a mut [ClusterPoint]) -> Self {
        // Differences are taken from one member, so that squares do not cancel where all members are far from 0.
        let origin = members.first().map_or([0.0; DIMENSIONS], |p| p.position);
        let (mut weight, mut sum, mut squares) = (f32::MIN_POSITIVE, [0.0; DIMENSIONS], [0.0; DIMENSIONS]);
        for member in members.iter() {
            weight += member.weight;
            for i in 0..DIMENSIONS {
                let difference = member.position[i] - origin[i];
                sum[i] += member.weight * difference;
                squares[i] += member.weight * difference * difference;
            }
        }
        let variation: [f32; DIMENSIONS] = std::array::from_fn(|i| (squares[i] - sum[i] / weight * sum[i]).max(0.0));
        let axis = (0..DIMENSIONS).max_by(|a, b| variation[*a].total_cmp(&variation[*b])).unwrap_or(0);
        Self { members, variation: variation[axis], axis, mean: origin[axis] + sum[axis] / weight }
    }

    /// Splits the cluster into the members below the mean of its axis and the others.
    fn split(self) -> [Self; 2] {
        let Self { members, axis, mean, .. } = self;
        let count = members.len();
        let mut below = 0;
        for i in 0..members.len() {
            if members[i].position[axis] < mean {
                members.swap(i, below);
                below += 1;
            }
        }
        let (low, high) = members.split_at_mut(below);
        let mut halves = [Self::new(low), Self::new(high)];
        // Rounding may put all members on one side of their mean. Such a cluster is not split again.
        if below == 0 || below == count {
            halves.iter_mut().for_each(|c| c.variation = 0.0);
        }
        halves
    }
}

impl Ord for Cluster<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.variation.total_cmp(&other.variation)
    }
}

impl PartialOrd for Cluster<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Cluster<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cluster<'_> {}

/// Returns one part with the weight, the mean slope and the total covariance of `members`.
fn merge(parts: &[Part], members: &[ClusterPoint]) -> Option<Part> {
    let members = || members.iter().filter_map(|m| parts.get(m.part as usize));
    let weight: f64 = members().map(|p| p.weight).sum();
    if weight <= 0.0 {
        return None;
    }
    let (mut mean, mut base) = ([0.0; 2], [0.0; 3]);
    for part in members() {
        let share = part.weight / weight;
        let [u, v] = slope(part.normal);
        mean = [mean[0] + share * u, mean[1] + share * v];
        for (sum, a) in base.iter_mut().zip(part.base) {
            *sum += share * a;
        }
    }
    for part in members() {
        let [u, v] = slope(part.normal);
        add_products(&mut base, 2.0 * part.weight / weight, [u - mean[0], v - mean[1]]);
    }
    Some(Part { weight, normal: [-mean[0], -mean[1], 1.0], base })
}
