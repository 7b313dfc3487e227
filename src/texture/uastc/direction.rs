//! Blocks judged by the directions of the vectors that they decode to.
//!
//! Engines either read x, y, z and normalise (three, Babylon, Filament, PlayCanvas), or read x, y and rebuild z (Godot).
//! To the first the length of a decoded vector means nothing, which squared differences of channels cannot know. All
//! colours of a subset, its palette, are therefore turned into directions, and each texel takes the nearest: exact for
//! any mode, and the error of any endpoints. What a departure from unit length costs keeps both kinds of engines right
//! and textures filterable.

#![expect(clippy::needless_range_loop, reason = "lane loops read several arrays at one index")]

use fearless_simd::{Select, Simd, SimdBase, prelude::*};

use super::line::{ROUND, decode, quantise, ramp};
use super::moments::{Lane, sum};
use super::pack::Block;
use super::tables::Range;
use crate::simd::{LANES, Real, Wide};

/// Unit normals of a block, in units of [`UNIT`].
pub(super) type Normals = [Lane; 3];

/// Decoded levels are 127.5 (1 + component).
pub(super) const UNIT: f32 = 127.5;

/// Share of engines that rebuild z in the error. At 0 they get larger angles than from squared differences of channels.
pub(super) const REBUILT: f32 = 0.25;
/// Squared error of a vector that is too short or too long, by squared departure. Palettes between two unit vectors are
/// short; at 0.15 for both a level of waves comes out 2 % short on average, and `check` (RC1402) takes it for mips that
/// nobody normalised. So, 1.2 % at most, and 1.7 % for the relief of wool.
pub(super) const SHORT: f32 = 0.4;
/// See [`SHORT`].
pub(super) const LONG: f32 = 0.1;

/// The normals that `texels` stand for.
#[inline(always)]
pub(super) fn normals(texels: &[Lane; 3]) -> Normals {
    let mut normals = [[0.0; 16]; 3];
    for i in 0..16 {
        let [x, y, z] = [texels[0][i] - UNIT, texels[1][i] - UNIT, texels[2][i] - UNIT];
        // Never 0: levels are whole numbers.
        let scale = UNIT / (x * x + y * y + z * z).sqrt();
        (normals[0][i], normals[1][i], normals[2][i]) = (x * scale, y * scale, z * scale);
    }
    normals
}

/// The vectors that all weights give between two endpoints, of which there are 32 at most.
struct Palette {
    /// As decoded.
    vectors: [[f32; 32]; 3],
    /// Mean of the directions as read and as rebuilt.
    directions: [[f32; 32]; 3],
    /// Part of the error that does not depend on the normal.
    loss: [f32; 32],
}

/// Endpoints per channel of one subset: low, high.
type Ends = [[u8; 2]; 3];

/// A subset of a block with weights of `BITS` bits, whose palette has `P` entries: a weight for all channels, or with two
/// planes one for channel `alone` above one for the rest.
struct Subset<'a, const P: usize, const BITS: u32> {
    range: &'a Range,
    alone: Option<usize>,
    normals: &'a Normals,
    /// 1 for a member, 0 for the rest.
    mask: Lane,
}

/// Endpoints with the best weights for them.
#[derive(Clone, Copy)]
struct Fit {
    ends: Ends,
    /// Palette entry of every texel.
    entries: [u32; 16],
    /// Decoded vectors.
    vectors: [Lane; 3],
    error: f32,
}

impl<const P: usize, const BITS: u32> Subset<'_, P, BITS> {
    const LAST: u32 = (1 << BITS) - 1;

    /// Where an entry holds the weight of channel `c`.
    #[inline(always)]
    fn shift(&self, c: usize) -> u32 {
        if self.alone == Some(c) { BITS } else { 0 }
    }

    #[inline(always)]
    fn palette<S: Simd>(&self, simd: S, ends: &Ends) -> Palette {
        let mut palette = Palette { vectors: [[0.0; 32]; 3], directions: [[0.0; 32]; 3], loss: [0.0; 32] };
        for first in (0..P).step_by(LANES) {
            let mut vector = [Wide::splat(simd, 0.0); 3];
            for c in 0..3 {
                let [low, high] = ends[c].map(f32::from);
                let shift = self.shift(c);
                let mut weights = [0.0; LANES];
                for j in 0..LANES {
                    weights[j] = ramp::<BITS>(((first + j) as u32 >> shift & Self::LAST) as i32) as f32;
                }
                let (low, step) = (Wide::splat(simd, low), Wide::splat(simd, high - low));
                vector[c] = decode(low, step, Wide::simd_from(simd, weights)) - UNIT;
                palette.vectors[c][first..first + LANES].copy_from_slice(&*vector[c]);
            }
            let [x, y, z] = vector;
            let flat = x * x + y * y;
            let length = Real::sqrt(flat + z * z);
            let scale = Wide::splat(simd, UNIT) / length;
            let rebuilt = Real::sqrt(Real::max(Wide::splat(simd, UNIT * UNIT) - flat, Wide::splat(simd, 0.0)));
            let stay = length.simd_lt(UNIT).select(Wide::splat(simd, SHORT), Wide::splat(simd, LONG));
            let mut loss = stay * (length - UNIT) * (length - UNIT);
            // (1 - r) |u - n|^2 + r |v - n|^2 = |w - n|^2 + r (1 - r) |u - v|^2 with w = (1 - r) u + r v.
            for (c, (read, rebuilt)) in [(x, x), (y, y), (z, rebuilt)].into_iter().enumerate() {
                let u = read * scale;
                let direction = u * (1.0 - REBUILT) + rebuilt * REBUILT;
                palette.directions[c][first..first + LANES].copy_from_slice(&*direction);
                loss += (u - rebuilt) * (REBUILT * (1.0 - REBUILT)) * (u - rebuilt);
            }
            palette.loss[first..first + LANES].copy_from_slice(&*loss);
        }
        palette
    }

    /// The nearest entry of every texel.
    #[inline(always)]
    fn choose<S: Simd>(&self, simd: S, ends: &Ends) -> Fit {
        let palette = self.palette(simd, ends);
        let (mut entries, mut errors) = ([0; 16], [0.0; 16]);
        // Eight texels at a time, so that least errors stay in registers.
        for k in 0..16 / LANES {
            let [x, y, z] = self.normals.each_ref().map(|n| n.as_chunks::<LANES>().0[k]);
            let (x, y, z) = (Wide::simd_from(simd, x), Wide::simd_from(simd, y), Wide::simd_from(simd, z));
            let (mut least, mut at) = (Wide::splat(simd, f32::INFINITY), Wide::splat(simd, 0.0));
            for e in 0..P {
                let [u, v, w] = [palette.directions[0][e], palette.directions[1][e], palette.directions[2][e]];
                let (a, b, c) = (x - u, y - v, z - w);
                let error = a * a + palette.loss[e] + b * b + c * c;
                let is_nearer = error.simd_lt(least);
                least = is_nearer.select(error, least);
                at = is_nearer.select(Wide::splat(simd, e as f32), at);
            }
            let (least, at): ([f32; LANES], [f32; LANES]) = (least.into(), at.into());
            for j in 0..LANES {
                entries[LANES * k + j] = (at[j] + ROUND).to_bits() & 31;
                errors[LANES * k + j] = least[j];
            }
        }
        let vectors = palette.vectors.map(|v| entries.map(|e| v[e as usize % P]));
        Fit { ends: *ends, entries, vectors, error: sum(|i| self.mask[i] * errors[i]) }
    }

    /// Endpoints that bring the weights of `entries` nearest to `targets`, channel by channel.
    #[inline(always)]
    fn regress(&self, targets: &[Lane; 3], entries: &[u32; 16]) -> Ends {
        let count = sum(|i| self.mask[i]);
        let mut ends = [[0; 2]; 3];
        for c in 0..3 {
            let shift = self.shift(c);
            let mut weights = [0.0; 16];
            for i in 0..16 {
                weights[i] = self.mask[i] * ramp::<BITS>((entries[i] >> shift & Self::LAST) as i32) as f32;
            }
            let w = sum(|i| weights[i]);
            let ww = sum(|i| weights[i] * weights[i]);
            let x = sum(|i| self.mask[i] * targets[c][i]);
            let wx = sum(|i| weights[i] * targets[c][i]);
            let determinant = count * ww - w * w;
            let slope = if determinant > 0.0 { (count * wx - w * x) / determinant } else { 0.0 };
            let low = (x - slope * w) / count + UNIT;
            ends[c] = [quantise(self.range, low), quantise(self.range, low + 64.0 * slope)];
        }
        ends
    }

    /// Normals moved along themselves to where the vectors of `fit` are nearest: a squared distance to these, whose
    /// channels regression can treat one by one, is one to the directions (and bounds it from above for others).
    #[inline(always)]
    fn targets(&self, fit: &Fit) -> [Lane; 3] {
        let mut targets = *self.normals;
        for i in 0..16 {
            let along: f32 = (0..3).map(|c| fit.vectors[c][i] * self.normals[c][i]).sum::<f32>() / (UNIT * UNIT);
            let stay = if along < 1.0 { SHORT } else { LONG };
            let length = along + stay * (1.0 - along);
            for c in 0..3 {
                targets[c][i] *= length;
            }
        }
        targets
    }

    /// Regression on `entries`, then in turns with choice as long as that helps; `ends` as they are without a round.
    #[inline(always)]
    fn refine<S: Simd>(&self, simd: S, ends: &Ends, entries: &[u32; 16], rounds: usize) -> Fit {
        if rounds == 0 {
            return self.choose(simd, ends);
        }
        let mut best = self.choose(simd, &self.regress(self.normals, entries));
        for _ in 1..rounds {
            let next = self.choose(simd, &self.regress(&self.targets(&best), &best.entries));
            if next.error >= best.error {
                break;
            }
            best = next;
        }
        best
    }

    /// Moves single endpoints to neighbouring levels as long as that helps.
    #[inline(always)]
    fn polish<S: Simd>(&self, simd: S, mut best: Fit, passes: usize) -> Fit {
        for _ in 0..passes {
            let before = best.error;
            for k in 0..12 {
                let mut ends = best.ends;
                let end = &mut ends[k / 4][k % 2];
                *end = self.range.neighbour(*end, k % 4 < 2);
                let next = self.choose(simd, &ends);
                if next.error < best.error {
                    best = next;
                }
            }
            if best.error == before {
                break;
            }
        }
        best
    }
}

impl Block {
    /// Fits the block to `normals` by direction: endpoints by `rounds` of regression, which starts from the weights that
    /// the block has (0 leaves them), then by `passes` over single endpoints; and the best weights for them. The error
    /// becomes that of the directions.
    #[inline(always)]
    pub(super) fn aim<S: Simd>(&mut self, simd: S, normals: &Normals, rounds: usize, passes: usize) {
        match (self.mode.planes, self.mode.weight_bits) {
            (2, _) => self.aim_in::<_, 16, 2>(simd, normals, rounds, passes),
            (_, 2) => self.aim_in::<_, 4, 2>(simd, normals, rounds, passes),
            (_, 3) => self.aim_in::<_, 8, 3>(simd, normals, rounds, passes),
            (_, 4) => self.aim_in::<_, 16, 4>(simd, normals, rounds, passes),
            _ => self.aim_in::<_, 32, 5>(simd, normals, rounds, passes),
        }
    }

    #[inline(always)]
    fn aim_in<S: Simd, const P: usize, const BITS: u32>(
        &mut self,
        simd: S,
        normals: &Normals,
        rounds: usize,
        passes: usize,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                self.error = 0.0;
                let alone = (self.mode.planes == 2).then_some(self.selector);
                let mut entries = [0; 16];
                for i in 0..16 {
                    entries[i] = u32::from(self.weights[0][i]);
                    if alone.is_some() {
                        entries[i] |= u32::from(self.weights[1][i]) << BITS;
                    }
                }
                for subset in 0..self.mode.subsets {
                    let members = self.members(subset);
                    let mask = std::array::from_fn(|i| f32::from(members >> i & 1));
                    let part = Subset::<P, BITS> { range: self.mode.range, alone, normals, mask };
                    let ends = [0, 1, 2].map(|c| self.endpoints[subset][c]);
                    let fit = part.polish(simd, part.refine(simd, &ends, &entries, rounds), passes);
                    self.error += fit.error;
                    self.endpoints[subset][..3].copy_from_slice(&fit.ends);
                    for i in 0..16 {
                        if members >> i & 1 == 1 {
                            self.weights[0][i] = (fit.entries[i] & ((1 << BITS) - 1)) as u8;
                            self.weights[1][i] = (fit.entries[i] >> BITS) as u8;
                        }
                    }
                }
            },
        );
    }
}
