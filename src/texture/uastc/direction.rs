//! Blocks judged by the directions of the vectors that they decode to.
//!
//! Engines either read x, y, z and normalise (three, Babylon, Filament, PlayCanvas), or read x, y and rebuild z (Godot).
//! To the first the length of a decoded vector means nothing, which squared differences of channels cannot know. All
//! colours of a subset, its palette, are therefore turned into directions, and each texel takes the nearest: exact for
//! any mode, and the error of any endpoints. What a departure from unit length costs keeps both kinds of engines right
//! and textures filterable.

#![expect(clippy::needless_range_loop, reason = "lane loops read several arrays at one index")]

use super::line::{ROUND, decode, quantise, ramp};
use super::moments::{Lane, sum};
use super::pack::Block;
use super::tables::Range;

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

/// The vectors that all weights give between two endpoints.
struct Palette<const P: usize> {
    /// As decoded.
    vectors: [[f32; P]; 3],
    /// Mean of the directions as read and as rebuilt.
    directions: [[f32; P]; 3],
    /// Part of the error that does not depend on the normal.
    loss: [f32; P],
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
    fn palette(&self, ends: &Ends) -> Palette<P> {
        let mut vectors = [[0.0; P]; 3];
        for c in 0..3 {
            let [low, high] = ends[c].map(f32::from);
            let shift = self.shift(c);
            for e in 0..P {
                let weight = ramp::<BITS>((e as u32 >> shift & Self::LAST) as i32) as f32;
                vectors[c][e] = decode(low, high - low, weight) - UNIT;
            }
        }
        let mut palette = Palette { vectors, directions: [[0.0; P]; 3], loss: [0.0; P] };
        for e in 0..P {
            let [x, y, z] = [vectors[0][e], vectors[1][e], vectors[2][e]];
            let flat = x * x + y * y;
            let length = (flat + z * z).sqrt();
            let scale = UNIT / length;
            let rest = UNIT * UNIT - flat;
            let rebuilt = (if rest > 0.0 { rest } else { 0.0 }).sqrt();
            let mut loss = (if length < UNIT { SHORT } else { LONG }) * (length - UNIT) * (length - UNIT);
            // (1 - r) |u - n|^2 + r |v - n|^2 = |w - n|^2 + r (1 - r) |u - v|^2 with w = (1 - r) u + r v.
            for (c, (read, rebuilt)) in [(x, x), (y, y), (z, rebuilt)].into_iter().enumerate() {
                let u = read * scale;
                palette.directions[c][e] = (1.0 - REBUILT) * u + REBUILT * rebuilt;
                loss += REBUILT * (1.0 - REBUILT) * (u - rebuilt) * (u - rebuilt);
            }
            palette.loss[e] = loss;
        }
        palette
    }

    /// The nearest entry of every texel.
    #[inline(always)]
    fn choose(&self, ends: &Ends) -> Fit {
        let palette = self.palette(ends);
        let (mut entries, mut errors) = ([0; 16], [0.0; 16]);
        // Four texels at a time, so that least errors stay in registers: four times as fast.
        for k in 0..4 {
            let lane = |c: usize| -> [f32; 4] { std::array::from_fn(|j| self.normals[c][4 * k + j]) };
            let [x, y, z] = [lane(0), lane(1), lane(2)];
            let mut least = [f32::INFINITY; 4];
            let mut at = [0.0; 4];
            for e in 0..P {
                let [u, v, w] = [palette.directions[0][e], palette.directions[1][e], palette.directions[2][e]];
                let (loss, entry) = (palette.loss[e], e as f32);
                for j in 0..4 {
                    let (a, b, c) = (x[j] - u, y[j] - v, z[j] - w);
                    let error = loss + a * a + b * b + c * c;
                    let is_nearer = error < least[j];
                    least[j] = if is_nearer { error } else { least[j] };
                    at[j] = if is_nearer { entry } else { at[j] };
                }
            }
            for j in 0..4 {
                entries[4 * k + j] = (at[j] + ROUND).to_bits() & 31;
                errors[4 * k + j] = least[j];
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
    fn refine(&self, ends: &Ends, entries: &[u32; 16], rounds: usize) -> Fit {
        if rounds == 0 {
            return self.choose(ends);
        }
        let mut best = self.choose(&self.regress(self.normals, entries));
        for _ in 1..rounds {
            let next = self.choose(&self.regress(&self.targets(&best), &best.entries));
            if next.error >= best.error {
                break;
            }
            best = next;
        }
        best
    }

    /// Moves single endpoints to neighbouring levels as long as that helps.
    fn polish(&self, mut best: Fit, passes: usize) -> Fit {
        for _ in 0..passes {
            let before = best.error;
            for k in 0..12 {
                let mut ends = best.ends;
                let end = &mut ends[k / 4][k % 2];
                *end = self.range.neighbour(*end, k % 4 < 2);
                let next = self.choose(&ends);
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
    pub(super) fn aim(&mut self, normals: &Normals, rounds: usize, passes: usize) {
        match (self.mode.planes, self.mode.weight_bits) {
            (2, _) => self.aim_in::<16, 2>(normals, rounds, passes),
            (_, 2) => self.aim_in::<4, 2>(normals, rounds, passes),
            (_, 3) => self.aim_in::<8, 3>(normals, rounds, passes),
            (_, 4) => self.aim_in::<16, 4>(normals, rounds, passes),
            _ => self.aim_in::<32, 5>(normals, rounds, passes),
        }
    }

    fn aim_in<const P: usize, const BITS: u32>(&mut self, normals: &Normals, rounds: usize, passes: usize) {
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
            let fit = part.polish(part.refine(&ends, &entries, rounds), passes);
            self.error += fit.error;
            self.endpoints[subset][..3].copy_from_slice(&fit.ends);
            for i in 0..16 {
                if members >> i & 1 == 1 {
                    self.weights[0][i] = (fit.entries[i] & ((1 << BITS) - 1)) as u8;
                    self.weights[1][i] = (fit.entries[i] >> BITS) as u8;
                }
            }
        }
    }
}
