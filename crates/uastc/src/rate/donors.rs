//! Recent blocks that others may take bytes from.
//!
//! Each block looks at all donors, so what is compared first lies side by side: the same number of eight donors fills a
//! vector. Only the few that look best are fitted.

#![expect(clippy::needless_range_loop, reason = "lane loops read several arrays at one index")]

use super::look::look;
use crate::Metric;
use crate::lanes::{Lane, sum};
use crate::pack::Block;
use crate::unpack::{Unpacked, unpack_rgb};

/// Donors side by side.
pub(super) const GROUP: usize = 8;
/// Distinct blocks that are remembered. Time grows with it, what is saved hardly.
const WINDOW: usize = 256;
const GROUPS: usize = WINDOW / GROUP;

/// One block.
#[derive(Clone)]
pub(super) struct Donor {
    /// The block.
    pub bytes: [u8; 16],
    /// Index of the last block with these bytes.
    pub at: usize,
    /// None for one colour.
    pub block: Option<Block>,
    /// The hints of the block, in the form of [`Hints::bits`](crate::hints::Hints::bits).
    pub hints: u128,
}

/// A number for each donor of a group.
type Row = [f32; GROUP];

/// What is compared of a group.
#[derive(Clone)]
struct Group {
    points: [[Row; 16]; 3],
    loss: Row,
    /// Weights of every channel, centred, of length 1; 0 for blocks of several subsets.
    ramps: [[Row; 16]; 3],
    /// First endpoints as points.
    low: [Row; 3],
    /// Directions of the lines of both planes, of length 1 or 0.
    axes: [[Row; 3]; 2],
    /// Half of their lengths.
    half: [Row; 2],
    /// Squared error that weights leave by their number; infinite for blocks of several subsets.
    spacing: Row,
}

/// The last distinct blocks of a band.
pub(super) struct Donors {
    donors: Vec<Donor>,
    groups: Vec<Group>,
    next: usize,
}

/// Estimated errors of one block with each donor.
pub(super) struct Estimates {
    /// All bytes.
    pub whole: [f32; WINDOW],
    /// Weights, with endpoints fitted.
    pub weights: [f32; WINDOW],
    /// Endpoints, with weights fitted.
    pub ends: [f32; WINDOW],
}

/// Sums over a target.
pub(super) struct Spread {
    mean: [f32; 3],
    centred: [Lane; 3],
    scatter: [[f32; 3]; 3],
}

impl Spread {
    #[inline(always)]
    pub fn of(target: &[Lane; 3]) -> Self {
        let mean = target.map(|lane| sum(|i| lane[i]) / 16.0);
        let mut centred = *target;
        for c in 0..3 {
            for i in 0..16 {
                centred[c][i] -= mean[c];
            }
        }
        let scatter = [0, 1, 2].map(|a| [0, 1, 2].map(|b| sum(|i| centred[a][i] * centred[b][i])));
        Self { mean, centred, scatter }
    }
}

impl Donors {
    pub fn new() -> Self {
        let zero = [0.0; GROUP];
        let never = [f32::INFINITY; GROUP];
        let group = Group {
            points: [[zero; 16]; 3],
            loss: never,
            ramps: [[zero; 16]; 3],
            low: [zero; 3],
            axes: [[zero; 3]; 2],
            half: [zero; 2],
            spacing: never,
        };
        Self { donors: Vec::with_capacity(WINDOW), groups: vec![group; GROUPS], next: 0 }
    }

    pub fn all(&self) -> &[Donor] {
        &self.donors
    }

    /// Remembers a block in the place of the oldest, or where it was last.
    pub fn add(&mut self, bytes: [u8; 16], at: usize, metric: Metric) {
        if let Some(donor) = self.donors.iter_mut().find(|donor| donor.bytes == bytes) {
            donor.at = at;
            return;
        }
        let Some(unpacked) = unpack_rgb(&bytes) else { return };
        if self.donors.len() == WINDOW {
            self.next = (0..WINDOW).min_by_key(|&k| self.donors[k].at).unwrap_or(0);
        }
        let seen = look(metric, &unpacked.levels());
        let (group, j) = (&mut self.groups[self.next / GROUP], self.next % GROUP);
        for c in 0..3 {
            for i in 0..16 {
                group.points[c][i][j] = seen.points[c][i];
                group.ramps[c][i][j] = 0.0;
            }
        }
        group.loss[j] = seen.loss.iter().sum();
        group.spacing[j] = f32::INFINITY;
        let block = if let Unpacked::Block(block) = unpacked { Some(block) } else { None };
        if let Some(block) = &block
            && block.mode.subsets == 1
        {
            group.set_lines(j, block, metric);
        }
        let hints = block.as_ref().map_or(0, |block| block.mode.hints_in(&bytes));
        let donor = Donor { bytes, at, block, hints };
        if let Some(place) = self.donors.get_mut(self.next) {
            *place = donor;
        } else {
            self.donors.push(donor);
        }
        self.next = (self.next + 1) % WINDOW;
    }

    /// Estimates for a block.
    #[inline(always)]
    pub fn estimate(&self, target: &[Lane; 3], spread: &Spread, out: &mut Estimates) {
        let used = self.donors.len().div_ceil(GROUP);
        for (k, group) in self.groups[..used].iter().enumerate() {
            let range = k * GROUP..(k + 1) * GROUP;
            out.whole[range.clone()].copy_from_slice(&group.whole(target));
            out.weights[range.clone()].copy_from_slice(&group.weights(spread));
            out.ends[range].copy_from_slice(&group.ends(spread));
        }
    }
}

impl Group {
    fn set_lines(&mut self, j: usize, block: &Block, metric: Metric) {
        for c in 0..3 {
            let ramp = block.ramps(block.plane_of(c));
            let mean = ramp.iter().sum::<f32>() / 16.0;
            let length = ramp.iter().map(|w| (w - mean) * (w - mean)).sum::<f32>().sqrt();
            for i in 0..16 {
                self.ramps[c][i][j] = if length > 0.0 { (ramp[i] - mean) / length } else { 0.0 };
            }
        }
        // Lanes 0 and 1 hold the low and the high end as points.
        let ends = [0, 1, 2].map(|c| {
            let [low, high] = block.endpoints[0][c].map(f32::from);
            std::array::from_fn(|i| if i == 0 { low } else { high })
        });
        let ends = look(metric, &ends).points;
        let last = ((1 << block.mode.weight_bits) - 1) as f32;
        self.spacing[j] = 0.0;
        for plane in 0..2 {
            let step = [0, 1, 2].map(|c| if block.plane_of(c) == plane { ends[c][1] - ends[c][0] } else { 0.0 });
            let length = step.iter().map(|s| s * s).sum::<f32>().sqrt();
            for c in 0..3 {
                self.axes[plane][c][j] = if length > 0.0 { step[c] / length } else { 0.0 };
            }
            self.half[plane][j] = 0.5 * length;
            // Sixteen texels, evenly spread between neighbouring weights.
            self.spacing[j] += 16.0 / 12.0 * (length / last) * (length / last);
        }
        for c in 0..3 {
            self.low[c][j] = ends[c][0];
        }
    }

    #[inline(always)]
    fn whole(&self, target: &[Lane; 3]) -> Row {
        let mut errors = self.loss;
        for c in 0..3 {
            for i in 0..16 {
                for j in 0..GROUP {
                    let d = self.points[c][i][j] - target[c][i];
                    errors[j] += d * d;
                }
            }
        }
        errors
    }

    /// Scatter that is left where weights explain what they can.
    #[inline(always)]
    fn weights(&self, spread: &Spread) -> Row {
        let total: f32 = (0..3).map(|c| spread.scatter[c][c]).sum();
        let mut errors = [total; GROUP];
        for c in 0..3 {
            let mut along = [0.0; GROUP];
            for i in 0..16 {
                for j in 0..GROUP {
                    along[j] += self.ramps[c][i][j] * spread.centred[c][i];
                }
            }
            for j in 0..GROUP {
                errors[j] -= along[j] * along[j];
            }
        }
        errors
    }

    /// Scatter off the lines, distance from them, what lies beyond their ends, and spacing.
    #[inline(always)]
    fn ends(&self, spread: &Spread) -> Row {
        let total: f32 = (0..3).map(|c| spread.scatter[c][c]).sum();
        let mut errors = self.spacing;
        let mut apart = [[0.0; GROUP]; 3];
        for c in 0..3 {
            for j in 0..GROUP {
                apart[c][j] = spread.mean[c] - self.low[c][j];
                errors[j] += 16.0 * apart[c][j] * apart[c][j];
            }
        }
        for plane in 0..2 {
            for j in 0..GROUP {
                let axis = [0, 1, 2].map(|c| self.axes[plane][c][j]);
                let (mut along, mut on, mut first) = (0.0, 0.0, 0.0);
                for a in 0..3 {
                    along += axis[a] * apart[a][j];
                    first += axis[a] * spread.centred[a][0];
                    for b in 0..3 {
                        on += axis[a] * axis[b] * spread.scatter[a][b];
                    }
                }
                errors[j] -= 16.0 * along * along + on;
                // Texels reach 1.5 standard deviations from their mean.
                let half = self.half[plane][j];
                let reach = (along - half).abs() + 1.5 * (on * (1.0 / 16.0)).sqrt() - half;
                let beyond = if reach > 0.0 { reach } else { 0.0 };
                // The first texel's weight is not above the middle: its top bit is not stored.
                let above = first + along - half;
                let above = if above > 0.0 { above } else { 0.0 };
                errors[j] += 4.0 * beyond * beyond + above * above;
            }
        }
        for error in &mut errors {
            *error += total;
        }
        errors
    }
}

impl Estimates {
    pub fn new() -> Self {
        Self { whole: [0.0; WINDOW], weights: [0.0; WINDOW], ends: [0.0; WINDOW] }
    }
}
