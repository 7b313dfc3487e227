//! Footprints with few parts in place of many, for a quick judgement.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::metric::footprint::{Footprint, Part, add_products, slope};

/// Numbers that place a part.
const PLACES: usize = 5;

/// Where a part lies: its slope in widths of the mean lobe, the logarithm of the width of its own, and how long that is
/// and in which direction. A step of each counts alike. Small, since splitting moves it many times.
struct Placed {
    at: [f32; PLACES],
    weight: f32,
    part: u32,
}

/// `parts` as a footprint of at most `limit` parts. `None` as for [`Footprint::new`].
///
/// The group of parts that varies most (its weight times its variance) is split at the mean of the axis along which it
/// varies most, until there are `limit` groups. A group becomes one lobe about its mean slope, its own lobe widened by
/// twice the group's covariance: groups lie close together in slope and not in the map, so little is left to widen.
pub fn clumped(parts: Vec<Part>, limit: usize) -> Option<Footprint> {
    if parts.len() <= limit {
        return Footprint::new(parts);
    }
    let squared = |p: &Part| (0.5 * (p.base[0] + p.base[2])).max(1e-12);
    let total: f64 = parts.iter().map(|p| p.weight).sum();
    let alpha = (parts.iter().map(|p| p.weight * squared(p)).sum::<f64>() / total).sqrt();
    let placed = |(index, part): (u32, &Part)| {
        let [u, v] = slope(part.normal);
        let [along, across] = elongation(part.base);
        let at = [u / alpha, v / alpha, 0.5 * libm::log(squared(part)), along, across].map(|c| c as f32);
        Placed { at, weight: (part.weight / total) as f32, part: index }
    };
    let mut placed: Vec<Placed> = (0..).zip(&parts).map(placed).collect();
    let mut groups = BinaryHeap::from([Group::new(&mut placed)]);
    while groups.len() < limit && groups.peek().is_some_and(|g| g.variation > 0.0) {
        let Some(widest) = groups.pop() else { break };
        groups.extend(widest.split().into_iter().filter(|g| !g.members.is_empty()));
    }
    // In the order of the heap, which equal input makes equal.
    Footprint::new(groups.into_vec().iter().filter_map(|g| merged(&parts, g.members)).collect())
}

/// The logarithm of the ratio of a lobe's alphas, along twice the angle of the longer one.
fn elongation([uu, uv, vv]: [f64; 3]) -> [f64; 2] {
    let (mean, [x, y]) = (0.5 * (uu + vv), [0.5 * (uu - vv), uv]);
    let radius = (x * x + y * y).sqrt();
    if radius <= 0.0 {
        return [0.0; 2];
    }
    // Alphas do not end at 0 in shaders.
    let ratio = (mean + radius) / (mean - radius).max(1e-6);
    [x, y].map(|c| 0.5 * libm::log(ratio) * c / radius)
}

/// Neighbours, and how much they vary.
struct Group<'a> {
    members: &'a mut [Placed],
    /// Weight times variance along `axis`.
    variation: f32,
    axis: usize,
    mean: f32,
}

impl<'a> Group<'a> {
    fn new(members: &'a mut [Placed]) -> Self {
        // From one of them, so that squares do not cancel where all lie far from 0.
        let origin = members.first().map_or([0.0; PLACES], |p| p.at);
        let (mut weight, mut sum, mut squares) = (f32::MIN_POSITIVE, [0.0; PLACES], [0.0; PLACES]);
        for member in members.iter() {
            weight += member.weight;
            for i in 0..PLACES {
                let from = member.at[i] - origin[i];
                sum[i] += member.weight * from;
                squares[i] += member.weight * from * from;
            }
        }
        let variation: [f32; PLACES] = std::array::from_fn(|i| (squares[i] - sum[i] / weight * sum[i]).max(0.0));
        let axis = (0..PLACES).max_by(|a, b| variation[*a].total_cmp(&variation[*b])).unwrap_or(0);
        Self { members, variation: variation[axis], axis, mean: origin[axis] + sum[axis] / weight }
    }

    /// The members below the mean, and the others.
    fn split(self) -> [Self; 2] {
        let Self { members, axis, mean, .. } = self;
        let count = members.len();
        let mut below = 0;
        for i in 0..members.len() {
            if members[i].at[axis] < mean {
                members.swap(i, below);
                below += 1;
            }
        }
        let (low, high) = members.split_at_mut(below);
        let mut groups = [Self::new(low), Self::new(high)];
        // Rounding may leave all of them on one side of their mean: they count as one.
        if below == 0 || below == count {
            groups.iter_mut().for_each(|g| g.variation = 0.0);
        }
        groups
    }
}

impl Ord for Group<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.variation.total_cmp(&other.variation)
    }
}

impl PartialOrd for Group<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Group<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Group<'_> {}

fn merged(parts: &[Part], members: &[Placed]) -> Option<Part> {
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
