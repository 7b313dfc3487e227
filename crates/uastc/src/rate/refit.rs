//! One half of a block fitted anew to texels under the other half of another block.

#![expect(clippy::needless_range_loop, reason = "lane loops read several arrays at one index")]

use super::look::{Look, look};
use crate::Metric;
use crate::direction::UNIT;
use crate::lanes::{Lane, ROUND, sum};
use crate::line::{decode, ramp};
use crate::pack::Block;
use crate::tables::Range;

/// Returns the nearest level of `range` to a value, which may lie outside of 0..=255.
#[inline(always)]
fn quantise(range: &Range, value: f32) -> u8 {
    range.level[((value.clamp(0.0, 255.0) + ROUND).to_bits() & 255) as usize]
}

/// The endpoints that suit `texels` under the weights of `block`.
#[inline(always)]
pub(super) fn refit_endpoints(block: &mut Block, metric: Metric, target: &[Lane; 3]) {
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
                let x = sum(|i| mask[i] * target[c][i]);
                let wx = sum(|i| mask[i] * weights[i] * target[c][i]);
                let slope = if determinant > 0.0 { (count * wx - w * x) / determinant } else { 0.0 };
                let low = (x - slope * w) / count;
                let high = low + 64.0 * slope;
                block.endpoints[subset][c] = [low, high].map(|end| quantise(block.mode.range, end / scale[c] + offset));
            }
        }
    }
}

/// The weights that suit `target` under the endpoints of `block`.
#[inline(always)]
pub(super) fn refit_weights(block: &mut Block, metric: Metric, target: &[Lane; 3]) {
    match (block.mode.planes, block.mode.weight_bits) {
        (2, _) => refit_weights_in::<16, 2>(block, metric, target),
        (_, 2) => refit_weights_in::<4, 2>(block, metric, target),
        (_, 3) => refit_weights_in::<8, 3>(block, metric, target),
        (_, 4) => refit_weights_in::<16, 4>(block, metric, target),
        _ => refit_weights_in::<32, 5>(block, metric, target),
    }
}

#[inline(always)]
fn refit_weights_in<const P: usize, const BITS: u32>(block: &mut Block, metric: Metric, target: &[Lane; 3]) {
    let last = (1u32 << BITS) - 1;
    let alone = block.mode.planes == 2;
    for subset in 0..block.mode.subsets {
        let members = block.members(subset);
        let mut looks = [Look { points: [[0.0; 16]; 3], loss: [0.0; 16] }; 2];
        for (part, palette) in looks.iter_mut().enumerate().take(P.div_ceil(16)) {
            let mut levels = [[0.0; 16]; 3];
            for (c, levels) in levels.iter_mut().enumerate() {
                let [low, high] = block.endpoints[subset][c].map(f32::from);
                let shift = if alone && block.selector == c { BITS } else { 0 };
                for (i, level) in levels.iter_mut().enumerate() {
                    let weight = ramp::<BITS, f32>(((16 * part + i) as u32 >> shift & last) as f32);
                    *level = decode(low, high - low, weight);
                }
            }
            *palette = look(metric, &levels);
        }
        let anchor = members.trailing_zeros() as usize;
        let (mut least, mut at) = ([f32::INFINITY; 16], [0.0; 16]);
        for e in 0..P {
            let (part, k) = (&looks[e / 16], e % 16);
            let [u, v, w] = part.points.map(|p| p[k]);
            let loss = part.loss[k];
            // The top bit of an anchor's weight is not stored.
            let e = e as u32;
            let fits = if e & last > last / 2 || e >> BITS > last / 2 { f32::INFINITY } else { 0.0 };
            for i in 0..16 {
                let (a, b, c) = (target[0][i] - u, target[1][i] - v, target[2][i] - w);
                let error = a * a + b * b + c * c + loss + if i == anchor { fits } else { 0.0 };
                let nearer = error < least[i];
                least[i] = if nearer { error } else { least[i] };
                at[i] = if nearer { e as f32 } else { at[i] };
            }
        }
        for i in 0..16 {
            let entry = (at[i] + ROUND).to_bits() & 31;
            if members >> i & 1 == 1 {
                block.weights[0][i] = (entry & last) as u8;
                block.weights[1][i] = if alone { (entry >> BITS) as u8 } else { 0 };
            }
        }
    }
}

impl Block {
    /// Squared distance between the endpoints of two blocks of one mode and pattern, for as many texels as each serves.
    pub(super) fn distance(&self, other: &Self) -> f32 {
        let mut far = 0;
        for (own, other) in self.endpoints[..self.mode.subsets].iter().zip(&other.endpoints) {
            for (&[a, b], &[p, q]) in own[..3].iter().zip(other) {
                far += (i32::from(a) - i32::from(p)).pow(2) + (i32::from(b) - i32::from(q)).pow(2);
            }
        }
        let share = 8 / self.mode.subsets as i32;
        (far * share) as f32
    }
}
