//! Blocks judged by the directions of the vectors that they decode to.
//!
//! Engines either read x, y, z and normalise (three, Babylon, Filament, PlayCanvas), or read x, y and rebuild z
//! (Godot). To the first the length of a decoded vector means nothing, which squared differences of channels cannot
//! know. All colours of a subset, its palette, are therefore turned into directions, and each texel takes the nearest:
//! exact for any mode, and the error of any endpoints. What a departure from unit length costs keeps both kinds of
//! engines right and textures filterable.

#![expect(clippy::needless_range_loop, reason = "loops over texels read several grids at one index")]

use fearless_simd::{Select, Simd, SimdBase, prelude::*};

use crate::blocks::Blocks;
use crate::candidate::texel;
use crate::lanes::{Grid, look_up, sum, take};
use crate::line::{decode, quantise, ramp, round};
use crate::moments::{count, counted};
use crate::tables::Range;
use texel_simd::{LANES, Real, Wide};

/// Unit normals of blocks side by side, in units of [`UNIT`].
pub(crate) type Normals<S> = [Grid<S>; 3];

/// Decoded levels are 127.5 (1 + component).
pub(crate) const UNIT: f32 = 127.5;

/// Share of engines that rebuild z in the error. At 0 they get larger angles than from squared differences of channels.
pub(crate) const REBUILT: f32 = 0.25;
/// Squared error of a vector that is too short or too long, by squared departure. Palettes between two unit vectors are
/// short; at 0.15 for both a level of waves comes out 2 % short on average, which looks like mips that nobody
/// normalised. With these numbers such levels are 1.2 % short at most, and a normal map of wool 1.7 %.
pub(crate) const SHORT: f32 = 0.4;
/// See [`SHORT`].
pub(crate) const LONG: f32 = 0.1;

/// The normals that `texels` stand for.
#[inline(always)]
pub(crate) fn normals<S: Simd>(texels: &[Grid<S>; 3]) -> Normals<S> {
    let mut normals = *texels;
    for i in 0..16 {
        let [x, y, z] = normal([texels[0][i] - UNIT, texels[1][i] - UNIT, texels[2][i] - UNIT]);
        (normals[0][i], normals[1][i], normals[2][i]) = (x, y, z);
    }
    normals
}

/// A vector at length [`UNIT`]. It is not 0, since levels are whole numbers.
#[inline(always)]
pub(crate) fn normal<F: Real>([x, y, z]: [F; 3]) -> [F; 3] {
    let scale = x.splat_like(UNIT) / (x * x + y * y + z * z).sqrt();
    [x * scale, y * scale, z * scale]
}

/// A decoded vector as engines see it, such that its error is a squared distance: the mean of its directions as read
/// and as rebuilt, and the part of the error that does not depend on the normal.
#[inline(always)]
pub(crate) fn seen<F: Real>([x, y, z]: [F; 3]) -> ([F; 3], F) {
    let splat = |value: f32| x.splat_like(value);
    let unit = splat(UNIT);
    let flat = x * x + y * y;
    let length = (flat + z * z).sqrt();
    let scale = unit / length;
    let rebuilt = (unit * unit - flat).max(splat(0.0)).sqrt();
    let stay = splat(LONG).select(splat(SHORT), unit.lanes_le(length));
    let mut loss = stay * (length - unit) * (length - unit);
    let mut direction = [x; 3];
    // (1 - r) |u - n|^2 + r |v - n|^2 = |w - n|^2 + r (1 - r) |u - v|^2 with w = (1 - r) u + r v.
    for (c, (read, rebuilt)) in [(x, x), (y, y), (z, rebuilt)].into_iter().enumerate() {
        let u = read * scale;
        loss = loss + (u - rebuilt) * splat(REBUILT * (1.0 - REBUILT)) * (u - rebuilt);
        direction[c] = u * splat(1.0 - REBUILT) + rebuilt * splat(REBUILT);
    }
    (direction, loss)
}

/// One of the vectors that all weights give between two endpoints.
#[derive(Clone, Copy)]
struct Entry<S: Simd> {
    /// Mean of the directions as read and as rebuilt.
    direction: [Wide<S>; 3],
    /// Part of the error that does not depend on the normal.
    loss: Wide<S>,
}

/// Endpoints per channel of one subset: low, high.
type Ends<S> = [[Wide<S>; 2]; 3];

/// A subset of blocks with weights of `BITS` bits, whose palettes have `P` entries: a weight for all channels, or with
/// two planes one for channel `alone` above one for the rest.
struct Subset<'a, S: Simd, const P: usize, const BITS: u32> {
    simd: S,
    range: &'static Range,
    alone: Option<usize>,
    normals: &'a Normals<S>,
    /// 1 for a member, 0 for the rest; none if all are members.
    mask: Option<Grid<S>>,
}

/// The weight indices that an entry of two planes is made of: of the channel alone, and of the others.
#[inline(always)]
fn indices<S: Simd, const BITS: u32>(entry: Wide<S>) -> [Wide<S>; 2] {
    let count = (1 << BITS) as f32;
    // Entries are whole: a fraction less than a half keeps rounding down.
    let upper = round(entry * (1.0 / count) - (0.5 - 0.5 / count));
    [upper, entry - upper * count]
}

/// Endpoints with the best weights for them.
#[derive(Clone, Copy)]
struct Fit<S: Simd> {
    ends: Ends<S>,
    /// Palette entry of every texel.
    entries: Grid<S>,
    error: Wide<S>,
}

impl<S: Simd> Fit<S> {
    /// Becomes `other` where that has the lesser error; whether it has anywhere.
    #[inline(always)]
    fn offer(&mut self, other: &Self) -> bool {
        let is_better = other.error.simd_lt(self.error);
        if !is_better.any_true() {
            return false;
        }
        for (own, other) in self.ends.as_flattened_mut().iter_mut().zip(other.ends.as_flattened()) {
            take(own, *other, is_better);
        }
        for (own, other) in self.entries.iter_mut().zip(&other.entries) {
            take(own, *other, is_better);
        }
        take(&mut self.error, other.error, is_better);
        true
    }
}

impl<S: Simd, const P: usize, const BITS: u32> Subset<'_, S, P, BITS> {
    /// The weights, 0..=64, that an entry stands for: of channel `alone` and of the others.
    #[inline(always)]
    fn weights(&self, entry: Wide<S>) -> [Wide<S>; 2] {
        if self.alone.is_none() {
            return [ramp::<BITS, _>(entry); 2];
        }
        let [single, others] = indices::<_, BITS>(entry);
        [ramp::<BITS, _>(single), ramp::<BITS, _>(others)]
    }

    /// Which of [`Self::weights`] is that of channel `c`.
    #[inline(always)]
    fn plane(&self, c: usize) -> usize {
        usize::from(self.alone != Some(c))
    }

    #[inline(always)]
    fn palette(&self, ends: &Ends<S>) -> [Entry<S>; P] {
        let simd = self.simd;
        let zero = Wide::splat(simd, 0.0);
        let mut palette = [Entry { direction: [zero; 3], loss: zero }; P];
        for (at, entry) in palette.iter_mut().enumerate() {
            (entry.direction, entry.loss) = seen(self.decoded(ends, Wide::splat(simd, at as f32)));
        }
        palette
    }

    /// The vector of a palette's entry, in units of [`UNIT`].
    #[inline(always)]
    fn decoded(&self, ends: &Ends<S>, entry: Wide<S>) -> [Wide<S>; 3] {
        let weights = self.weights(entry);
        let mut vector = [entry; 3];
        for c in 0..3 {
            let [low, high] = ends[c];
            vector[c] = decode(low, high - low, weights[self.plane(c)]) - UNIT;
        }
        vector
    }

    /// The nearest entry of every texel.
    #[inline(always)]
    fn choose(&self, ends: &Ends<S>) -> Fit<S> {
        let simd = self.simd;
        let palette = self.palette(ends);
        let zero = Wide::splat(simd, 0.0);
        let (mut entries, mut errors) = ([zero; 16], [zero; 16]);
        for i in 0..16 {
            let [x, y, z] = texel(self.normals, i);
            let (mut least, mut at) = (Wide::splat(simd, f32::INFINITY), zero);
            for (e, entry) in palette.iter().enumerate() {
                let [u, v, w] = entry.direction;
                let (a, b, c) = (x - u, y - v, z - w);
                let error = a * a + entry.loss + b * b + c * c;
                let is_nearer = error.simd_lt(least);
                least = is_nearer.select(error, least);
                at = is_nearer.select(Wide::splat(simd, e as f32), at);
            }
            (entries[i], errors[i]) = (at, least);
        }
        let error = sum(
            #[inline(always)]
            |i| counted(self.mask.as_ref(), i, errors[i]),
        );
        Fit { ends: *ends, entries, error }
    }

    /// Endpoints that bring the weights of `entries` nearest to `targets`, channel by channel.
    #[inline(always)]
    fn regress(&self, targets: &[Grid<S>; 3], entries: &Grid<S>) -> Ends<S> {
        let simd = self.simd;
        let subset = self.mask.as_ref();
        let count = count(simd, subset);
        let zero = Wide::splat(simd, 0.0);
        let mut weights = [[zero; 2]; 16];
        for i in 0..16 {
            let [own, others] = self.weights(entries[i]);
            weights[i] = [counted(subset, i, own), counted(subset, i, others)];
        }
        let mut ends = [[zero; 2]; 3];
        for c in 0..3 {
            let plane = self.plane(c);
            let w = sum(
                #[inline(always)]
                |i| weights[i][plane],
            );
            let ww = sum(
                #[inline(always)]
                |i| weights[i][plane] * weights[i][plane],
            );
            let x = sum(
                #[inline(always)]
                |i| counted(subset, i, targets[c][i]),
            );
            let wx = sum(
                #[inline(always)]
                |i| weights[i][plane] * targets[c][i],
            );
            let determinant = count * ww - w * w;
            let slope = determinant.simd_gt(0.0).select((count * wx - w * x) / determinant, zero);
            let low = (x - slope * w) / count + UNIT;
            ends[c] = [quantise(simd, self.range, low), quantise(simd, self.range, low + slope * 64.0)];
        }
        ends
    }

    /// Normals moved along themselves to where the vectors of `fit` are nearest: a squared distance to these, whose
    /// channels regression can treat one by one, is one to the directions (and bounds it from above for others).
    #[inline(always)]
    fn targets(&self, fit: &Fit<S>) -> [Grid<S>; 3] {
        let mut targets = *self.normals;
        for i in 0..16 {
            let [x, y, z] = self.decoded(&fit.ends, fit.entries[i]);
            let along = (x * targets[0][i] + y * targets[1][i] + z * targets[2][i]) / (UNIT * UNIT);
            let (short, long) = (Wide::splat(self.simd, SHORT), Wide::splat(self.simd, LONG));
            let stay = along.simd_lt(1.0).select(short, long);
            let length = along + stay * (1.0 - along);
            for c in 0..3 {
                targets[c][i] *= length;
            }
        }
        targets
    }

    /// Regression on `entries`, then in turns with choice as long as that helps; `ends` as they are without a round.
    #[inline(always)]
    fn refine(&self, ends: &Ends<S>, entries: &Grid<S>, rounds: usize) -> Fit<S> {
        if rounds == 0 {
            return self.choose(ends);
        }
        let mut best = self.choose(&self.regress(self.normals, entries));
        for _ in 1..rounds {
            if !best.offer(&self.choose(&self.regress(&self.targets(&best), &best.entries))) {
                break;
            }
        }
        best
    }

    /// Moves single endpoints to neighbouring levels as long as that helps.
    #[inline(always)]
    fn polish(&self, mut best: Fit<S>, passes: usize) -> Fit<S> {
        for _ in 0..passes {
            let mut is_better = false;
            for k in 0..12 {
                let mut ends = best.ends;
                let end = &mut ends[k / 4][k % 2];
                *end = look_up(self.simd, &self.range.neighbour[usize::from(k % 4 < 2)], *end);
                is_better |= best.offer(&self.choose(&ends));
            }
            if !is_better {
                break;
            }
        }
        best
    }
}

impl<S: Simd> Blocks<S> {
    /// Fits blocks of one mode and selector to `normals` by direction: endpoints by `rounds` of regression, which
    /// starts from the weights that the blocks have (0 leaves them), then by `passes` over single endpoints; and the
    /// best weights for them. The error becomes that of the directions.
    #[inline(always)]
    pub(crate) fn aim(&mut self, simd: S, normals: &Normals<S>, rounds: usize, passes: usize) {
        match (self.modes[0].planes, self.modes[0].weight_bits) {
            (2, _) => self.aim_in::<16, 2>(simd, normals, rounds, passes),
            (_, 2) => self.aim_in::<4, 2>(simd, normals, rounds, passes),
            (_, 3) => self.aim_in::<8, 3>(simd, normals, rounds, passes),
            (_, 4) => self.aim_in::<16, 4>(simd, normals, rounds, passes),
            _ => self.aim_in::<32, 5>(simd, normals, rounds, passes),
        }
    }

    #[inline(always)]
    fn aim_in<const P: usize, const BITS: u32>(&mut self, simd: S, normals: &Normals<S>, rounds: usize, passes: usize) {
        simd.vectorize(
            #[inline(always)]
            || {
                let mode = self.modes[0];
                let selector: [f32; LANES] = self.selector.into();
                let alone = (mode.planes == 2).then_some(selector[0] as usize);
                let zero = Wide::splat(simd, 0.0);
                let mut entries = self.weights[0];
                if alone.is_some() {
                    for i in 0..16 {
                        entries[i] += self.weights[1][i] * (1 << BITS) as f32;
                    }
                }
                let masks = self.masks(simd);
                let mut chosen = [zero; 16];
                self.error = zero;
                for subset in 0..mode.subsets {
                    let mask = masks.map(|masks| masks[subset]);
                    let part = Subset::<_, P, BITS> { simd, range: mode.range, alone, normals, mask };
                    let [x, y, z, _] = self.endpoints[subset];
                    let ends = [x, y, z];
                    let fit = part.polish(part.refine(&ends, &entries, rounds), passes);
                    self.error += fit.error;
                    self.endpoints[subset][..3].copy_from_slice(&fit.ends);
                    for i in 0..16 {
                        chosen[i] += counted(mask.as_ref(), i, fit.entries[i]);
                    }
                }
                self.weights[0] = chosen;
                if alone.is_some() {
                    for i in 0..16 {
                        [self.weights[1][i], self.weights[0][i]] = indices::<_, BITS>(chosen[i]);
                    }
                }
            },
        );
    }
}
