//! The recent blocks whose bytes a block may reuse.
//!
//! Every block is compared with all recent blocks. The numbers that this comparison reads are therefore stored for
//! eight recent blocks side by side and fill a vector. Only the few recent blocks with the least estimates are fitted.

#![expect(clippy::needless_range_loop, reason = "loops over lanes read several arrays at one index")]

use super::points::decoded_points;
use crate::Metric;
use crate::lanes::{ScalarGrid, sum};
use crate::pack::Block;
use crate::unpack::{Unpacked, unpack_rgb};

/// Recent blocks side by side.
pub(super) const GROUP: usize = 8;
/// Distinct blocks that are remembered. A larger window takes more time and saves hardly more bytes.
const WINDOW: usize = 256;
const GROUPS: usize = WINDOW / GROUP;

/// One recent block.
#[derive(Clone)]
pub(super) struct RecentBlock {
    /// The packed block.
    pub bytes: [u8; 16],
    /// Index in the band of the last block with these bytes.
    pub index: usize,
    /// The unpacked block; `None` for a block of one colour.
    pub block: Option<Block>,
    /// The hints of the block, in the form of [`Hints::bits`](crate::hints::Hints::bits).
    pub hints: u128,
}

/// A number for each block of a group.
type GroupValues = [f32; GROUP];

/// The numbers of a group that estimates are made from.
#[derive(Clone)]
struct Group {
    /// Decoded texels as points of the metric.
    points: [[GroupValues; 16]; 3],
    /// Sum over the texels of the part of the error that does not depend on the source.
    loss: GroupValues,
    /// Weights of every channel, centred and of length 1; 0 for blocks of several subsets.
    ramps: [[GroupValues; 16]; 3],
    /// Low endpoints as points.
    low: [GroupValues; 3],
    /// Directions of the lines of both planes, of length 1 or 0.
    axes: [[GroupValues; 3]; 2],
    /// Half the length of the line of each plane.
    half_length: [GroupValues; 2],
    /// Squared error that remains because weights are quantised; infinite for blocks of several subsets.
    spacing: GroupValues,
}

/// The last distinct blocks of a band.
pub(super) struct RecentBlocks {
    blocks: Vec<RecentBlock>,
    groups: Vec<Group>,
    /// Where the next block is stored.
    next: usize,
}

/// Estimated errors of one block that reuses bytes of each recent block.
pub(super) struct Estimates {
    /// All bytes are reused.
    pub copied: [f32; WINDOW],
    /// The weights are reused, and the endpoints are fitted.
    pub same_weights: [f32; WINDOW],
    /// The endpoints are reused, and the weights are fitted.
    pub same_endpoints: [f32; WINDOW],
}

/// First and second moments of the source points of a block.
pub(super) struct SourceMoments {
    mean: [f32; 3],
    centred: [ScalarGrid; 3],
    scatter: [[f32; 3]; 3],
}

impl SourceMoments {
    #[inline(always)]
    pub fn of(source: &[ScalarGrid; 3]) -> Self {
        let mean = source.map(|channel| sum(|i| channel[i]) / 16.0);
        let mut centred = *source;
        for c in 0..3 {
            for i in 0..16 {
                centred[c][i] -= mean[c];
            }
        }
        let scatter = [0, 1, 2].map(|a| [0, 1, 2].map(|b| sum(|i| centred[a][i] * centred[b][i])));
        Self { mean, centred, scatter }
    }
}

impl RecentBlocks {
    pub fn new() -> Self {
        let zero = [0.0; GROUP];
        let never = [f32::INFINITY; GROUP];
        let group = Group {
            points: [[zero; 16]; 3],
            loss: never,
            ramps: [[zero; 16]; 3],
            low: [zero; 3],
            axes: [[zero; 3]; 2],
            half_length: [zero; 2],
            spacing: never,
        };
        Self { blocks: Vec::with_capacity(WINDOW), groups: vec![group; GROUPS], next: 0 }
    }

    pub fn all(&self) -> &[RecentBlock] {
        &self.blocks
    }

    /// Adds the block at `index`. A block with the same bytes is moved to this index; otherwise the oldest block of a
    /// full window is replaced.
    pub fn add(&mut self, bytes: [u8; 16], index: usize, metric: Metric) {
        if let Some(recent) = self.blocks.iter_mut().find(|recent| recent.bytes == bytes) {
            recent.index = index;
            return;
        }
        let Some(unpacked) = unpack_rgb(&bytes) else { return };
        if self.blocks.len() == WINDOW {
            self.next = (0..WINDOW).min_by_key(|&k| self.blocks[k].index).unwrap_or(0);
        }
        let decoded = decoded_points(metric, &unpacked.levels());
        let (group, j) = (&mut self.groups[self.next / GROUP], self.next % GROUP);
        for c in 0..3 {
            for i in 0..16 {
                group.points[c][i][j] = decoded.points[c][i];
                group.ramps[c][i][j] = 0.0;
            }
        }
        group.loss[j] = decoded.loss.iter().sum();
        group.spacing[j] = f32::INFINITY;
        let block = if let Unpacked::Block(block) = unpacked { Some(block) } else { None };
        if let Some(block) = &block
            && block.mode.subsets == 1
        {
            group.set_lines(j, block, metric);
        }
        let hints = block.as_ref().map_or(0, |block| block.mode.hints_in(&bytes));
        let recent = RecentBlock { bytes, index, block, hints };
        if let Some(oldest) = self.blocks.get_mut(self.next) {
            *oldest = recent;
        } else {
            self.blocks.push(recent);
        }
        self.next = (self.next + 1) % WINDOW;
    }

    /// Estimates the errors of a block with these `source` points and their `moments`.
    #[inline(always)]
    pub fn estimate(&self, source: &[ScalarGrid; 3], moments: &SourceMoments, out: &mut Estimates) {
        let used = self.blocks.len().div_ceil(GROUP);
        for (k, group) in self.groups[..used].iter().enumerate() {
            let range = k * GROUP..(k + 1) * GROUP;
            out.copied[range.clone()].copy_from_slice(&group.copied_errors(source));
            out.same_weights[range.clone()].copy_from_slice(&group.same_weights_errors(moments));
            out.same_endpoints[range].copy_from_slice(&group.same_endpoints_errors(moments));
        }
    }
}

impl Group {
    /// Stores the weights and the lines of a block of one subset in lane `j`.
    fn set_lines(&mut self, j: usize, block: &Block, metric: Metric) {
        for c in 0..3 {
            let ramp = block.ramps(block.plane_of(c));
            let mean = ramp.iter().sum::<f32>() / 16.0;
            let length = ramp.iter().map(|w| (w - mean) * (w - mean)).sum::<f32>().sqrt();
            for i in 0..16 {
                self.ramps[c][i][j] = if length > 0.0 { (ramp[i] - mean) / length } else { 0.0 };
            }
        }
        // Elements 0 and 1 hold the low and the high end as points.
        let ends = [0, 1, 2].map(|c| {
            let [low, high] = block.endpoints[0][c].map(f32::from);
            std::array::from_fn(|i| if i == 0 { low } else { high })
        });
        let ends = decoded_points(metric, &ends).points;
        let last = ((1 << block.mode.weight_bits) - 1) as f32;
        self.spacing[j] = 0.0;
        for plane in 0..2 {
            let step = [0, 1, 2].map(|c| if block.plane_of(c) == plane { ends[c][1] - ends[c][0] } else { 0.0 });
            let length = step.iter().map(|s| s * s).sum::<f32>().sqrt();
            for c in 0..3 {
                self.axes[plane][c][j] = if length > 0.0 { step[c] / length } else { 0.0 };
            }
            self.half_length[plane][j] = 0.5 * length;
            // The variance of sixteen texels that lie evenly between neighbouring weights.
            self.spacing[j] += 16.0 / 12.0 * (length / last) * (length / last);
        }
        for c in 0..3 {
            self.low[c][j] = ends[c][0];
        }
    }

    /// Returns the errors of the blocks as they are.
    #[inline(always)]
    fn copied_errors(&self, source: &[ScalarGrid; 3]) -> GroupValues {
        let mut errors = self.loss;
        for c in 0..3 {
            for i in 0..16 {
                for j in 0..GROUP {
                    let d = self.points[c][i][j] - source[c][i];
                    errors[j] += d * d;
                }
            }
        }
        errors
    }

    /// Returns the scatter that remains after regression on the weights of the blocks.
    #[inline(always)]
    fn same_weights_errors(&self, moments: &SourceMoments) -> GroupValues {
        let total: f32 = (0..3).map(|c| moments.scatter[c][c]).sum();
        let mut errors = [total; GROUP];
        for c in 0..3 {
            let mut along = [0.0; GROUP];
            for i in 0..16 {
                for j in 0..GROUP {
                    along[j] += self.ramps[c][i][j] * moments.centred[c][i];
                }
            }
            for j in 0..GROUP {
                errors[j] -= along[j] * along[j];
            }
        }
        errors
    }

    /// Returns the sum of four errors for the lines of each block: the scatter off the lines, the distance of the mean
    /// from the lines, the texels beyond the ends, and the spacing of the weights.
    #[inline(always)]
    fn same_endpoints_errors(&self, moments: &SourceMoments) -> GroupValues {
        let total: f32 = (0..3).map(|c| moments.scatter[c][c]).sum();
        let mut errors = self.spacing;
        let mut from_low = [[0.0; GROUP]; 3];
        for c in 0..3 {
            for j in 0..GROUP {
                from_low[c][j] = moments.mean[c] - self.low[c][j];
                errors[j] += 16.0 * from_low[c][j] * from_low[c][j];
            }
        }
        for plane in 0..2 {
            for j in 0..GROUP {
                let axis = [0, 1, 2].map(|c| self.axes[plane][c][j]);
                let (mut along, mut on, mut first) = (0.0, 0.0, 0.0);
                for a in 0..3 {
                    along += axis[a] * from_low[a][j];
                    first += axis[a] * moments.centred[a][0];
                    for b in 0..3 {
                        on += axis[a] * axis[b] * moments.scatter[a][b];
                    }
                }
                errors[j] -= 16.0 * along * along + on;
                // The estimate assumes texels up to 1.5 standard deviations from their mean.
                let half = self.half_length[plane][j];
                let reach = (along - half).abs() + 1.5 * (on * (1.0 / 16.0)).sqrt() - half;
                let beyond = if reach > 0.0 { reach } else { 0.0 };
                // The top bit of the first texel's weight is not stored, so this weight is not above the middle.
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
        Self { copied: [0.0; WINDOW], same_weights: [0.0; WINDOW], same_endpoints: [0.0; WINDOW] }
    }
}
