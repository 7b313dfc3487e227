//! Fits one half of a block, its endpoints or its weights, to new texels and keeps the other half.

#![expect(clippy::needless_range_loop, reason = "loops over texels read several arrays at one index")]

use super::points::{DecodedPoints, decoded_points};
use crate::Metric;
use crate::direction::UNIT;
use crate::lanes::{ROUND, ScalarGrid, sum};
use crate::line::decode;
use crate::pack::Block;
use crate::tables::Range;

/// Returns the nearest level of `range` to a value, which may lie outside of 0..=255.
#[inline(always)]
fn quantise(range: &Range, value: f32) -> u8 {
    range.level[((value.clamp(0.0, 255.0) + ROUND).to_bits() & 255) as usize]
}

/// Fits the endpoints of `block` to the points `source` by linear regression and keeps its weights.
#[inline(always)]
pub(super) fn refit_endpoints(block: &mut Block, metric: Metric, source: &[ScalarGrid; 3]) {
    let offset = if metric == Metric::Direction { UNIT } else { 0.0 };
    let scale = metric.scale();
    for subset in 0..block.mode.subsets {
        let members = block.members(subset);
        let mut mask = [0.0; 16];
        for i in 0..16 {
            mask[i] = f32::from(members >> i & 1);
        }
        let count = sum(|i| mask[i]);
        for plane in 0..block.mode.planes {
            let weights = block.ramps(plane);
            let w = sum(|i| mask[i] * weights[i]);
            let ww = sum(|i| mask[i] * weights[i] * weights[i]);
            let determinant = count * ww - w * w;
            for c in 0..3 {
                if block.plane_of(c) != plane {
                    continue;
                }
                let x = sum(|i| mask[i] * source[c][i]);
                let wx = sum(|i| mask[i] * weights[i] * source[c][i]);
                let slope = if determinant > 0.0 { (count * wx - w * x) / determinant } else { 0.0 };
                let low = (x - slope * w) / count;
                let high = low + 64.0 * slope;
                block.endpoints[subset][c] = [low, high].map(|end| quantise(block.mode.range, end / scale[c] + offset));
            }
        }
    }
}

/// Chooses the weights of `block` that are nearest to the points `source` and keeps its endpoints.
#[inline(always)]
pub(super) fn refit_weights(block: &mut Block, metric: Metric, source: &[ScalarGrid; 3]) {
    let bits = block.mode.weight_bits;
    let last = (1u32 << bits) - 1;
    let has_two_planes = block.mode.planes == 2;
    let entries = palette_len(block);
    for subset in 0..block.mode.subsets {
        let members = block.members(subset);
        let palette = palette(block, metric, subset);
        let anchor = members.trailing_zeros() as usize;
        let (mut least, mut at) = ([f32::INFINITY; 16], [0.0; 16]);
        for e in 0..entries {
            let (sixteen, k) = (&palette[e / 16], e % 16);
            let [u, v, w] = sixteen.points.map(|p| p[k]);
            let loss = sixteen.loss[k];
            // The top bit of an anchor's weight is not stored, so it must be 0.
            let e = e as u32;
            let anchor_error = if e & last > last / 2 || e >> bits > last / 2 { f32::INFINITY } else { 0.0 };
            for i in 0..16 {
                let (a, b, c) = (source[0][i] - u, source[1][i] - v, source[2][i] - w);
                let error = a * a + b * b + c * c + loss + if i == anchor { anchor_error } else { 0.0 };
                let is_nearer = error < least[i];
                least[i] = if is_nearer { error } else { least[i] };
                at[i] = if is_nearer { e as f32 } else { at[i] };
            }
        }
        for i in 0..16 {
            let entry = (at[i] + ROUND).to_bits() & 31;
            if members >> i & 1 == 1 {
                block.weights[0][i] = (entry & last) as u8;
                block.weights[1][i] = if has_two_planes { (entry >> bits) as u8 } else { 0 };
            }
        }
    }
}

/// Returns how many combinations of weights a texel can have.
fn palette_len(block: &Block) -> usize {
    1 << (block.mode.planes as u32 * block.mode.weight_bits)
}

/// Returns the points of all combinations of weights in a subset, sixteen in each element. With two planes, the upper
/// bits of an entry's index are the weight of the selected channel.
#[inline(always)]
fn palette(block: &Block, metric: Metric, subset: usize) -> [DecodedPoints; 2] {
    let (ramp, bits) = (block.mode.ramp(), block.mode.weight_bits);
    let last = (1u32 << bits) - 1;
    let mut palette = [DecodedPoints { points: [[0.0; 16]; 3], loss: [0.0; 16] }; 2];
    for (part, entries) in palette.iter_mut().enumerate().take(palette_len(block).div_ceil(16)) {
        let mut levels = [[0.0; 16]; 3];
        for (c, levels) in levels.iter_mut().enumerate() {
            let [low, high] = block.endpoints[subset][c].map(f32::from);
            let shift = if block.mode.planes == 2 && block.selector == c { bits } else { 0 };
            for (i, level) in levels.iter_mut().enumerate() {
                let weight = ramp.weight::<f32>(((16 * part + i) as u32 >> shift & last) as f32);
                *level = decode(low, high - low, weight);
            }
        }
        *entries = decoded_points(metric, &levels);
    }
    palette
}

impl Block {
    /// Returns the squared distance between the endpoints of two blocks of equal mode and pattern, multiplied by the
    /// number of texels that each endpoint serves on average.
    pub(super) fn distance(&self, other: &Self) -> f32 {
        let mut distance = 0;
        for (ends, others) in self.endpoints[..self.mode.subsets].iter().zip(&other.endpoints) {
            for (&[a, b], &[p, q]) in ends[..3].iter().zip(others) {
                distance += (i32::from(a) - i32::from(p)).pow(2) + (i32::from(b) - i32::from(q)).pow(2);
            }
        }
        let texels = 8 / self.mode.subsets as i32;
        (distance * texels) as f32
    }
}
