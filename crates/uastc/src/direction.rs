//! Fits blocks of normals by the directions of the vectors that they decode to.
//!
//! Engines either read x, y, z and normalise (three, Babylon, Filament, PlayCanvas), or read x, y and rebuild z
//! (Godot). Engines that normalise ignore the length of a decoded vector; squared differences of channels do not.
//! Here every colour of a subset's palette is converted to a direction, and each texel takes the nearest direction.
//! The error is then exact for every mode and all endpoints. A penalty on departures from unit length serves both
//! kinds of engines and keeps textures filterable.

#![expect(clippy::needless_range_loop, reason = "loops over texels read several grids at one index")]

use fearless_simd::{Select, Simd, SimdBase, prelude::*};

use crate::blocks::Blocks;
use crate::candidate::texel;
use crate::lanes::{Grid, look_up, round, set_where, sum};
use crate::line::{decode, quantise};
use crate::moments::{count, masked};
use crate::ramp::Ramp;
use crate::tables::Range;
use texel_simd::{LANES, Real, Wide};

/// Unit normals of the texels of one block in each lane, multiplied by [`UNIT`].
pub(crate) type Normals<S> = [Grid<S>; 3];

/// Length of unit vectors in levels: a level is 127.5 (1 + component).
pub(crate) const UNIT: f32 = 127.5;

/// Weight of engines that rebuild z in the error. At 0 these engines show larger angles than with squared differences
/// of channels.
pub(crate) const REBUILT_Z_SHARE: f32 = 0.25;
/// Squared error of a vector shorter than unit length, for each unit of squared departure. Palettes between two unit
/// vectors contain short vectors. With 0.15 for both penalties, a level of waves decodes 2 % short on average, like a
/// mip chain that was not normalised. With these penalties such levels are at most 1.2 % short, and a normal map of
/// wool 1.7 %.
pub(crate) const SHORT_PENALTY: f32 = 0.4;
/// Squared error of a vector longer than unit length, as with [`SHORT_PENALTY`].
pub(crate) const LONG_PENALTY: f32 = 0.1;

/// Returns the normals that `texels` encode.
#[inline(always)]
pub(crate) fn normals<S: Simd>(texels: &[Grid<S>; 3]) -> Normals<S> {
    let mut normals = *texels;
    for i in 0..16 {
        let [x, y, z] = normal([texels[0][i] - UNIT, texels[1][i] - UNIT, texels[2][i] - UNIT]);
        (normals[0][i], normals[1][i], normals[2][i]) = (x, y, z);
    }
    normals
}

/// Returns a vector scaled to length [`UNIT`]. The vector is never 0, because levels are whole numbers.
#[inline(always)]
pub(crate) fn normal<F: Real>([x, y, z]: [F; 3]) -> [F; 3] {
    let scale = x.splat_like(UNIT) / (x * x + y * y + z * z).sqrt();
    [x * scale, y * scale, z * scale]
}

/// Returns the effective direction of a decoded vector, and the part of its error that does not depend on the normal.
///
/// The effective direction is the weighted mean of two directions: of engines that normalise and of engines that
/// rebuild z. The error is its squared distance from the normal, plus the second result.
#[inline(always)]
pub(crate) fn effective_direction<F: Real>([x, y, z]: [F; 3]) -> ([F; 3], F) {
    let splat = |value: f32| x.splat_like(value);
    let unit = splat(UNIT);
    let flat = x * x + y * y;
    let length = (flat + z * z).sqrt();
    let scale = unit / length;
    let rebuilt = (unit * unit - flat).max(splat(0.0)).sqrt();
    let penalty = splat(LONG_PENALTY).select(splat(SHORT_PENALTY), unit.lanes_le(length));
    let mut loss = penalty * (length - unit) * (length - unit);
    let mut direction = [x; 3];
    // (1 - r) |u - n|^2 + r |v - n|^2 = |w - n|^2 + r (1 - r) |u - v|^2 with w = (1 - r) u + r v.
    for (c, (read, rebuilt)) in [(x, x), (y, y), (z, rebuilt)].into_iter().enumerate() {
        let u = read * scale;
        loss = loss + (u - rebuilt) * splat(REBUILT_Z_SHARE * (1.0 - REBUILT_Z_SHARE)) * (u - rebuilt);
        direction[c] = u * splat(1.0 - REBUILT_Z_SHARE) + rebuilt * splat(REBUILT_Z_SHARE);
    }
    (direction, loss)
}

/// An entry of a palette: the vector that one weight (two with two planes) gives between two endpoints.
#[derive(Clone, Copy)]
pub(crate) struct Entry<S: Simd> {
    /// The direction of [`effective_direction`].
    pub direction: [Wide<S>; 3],
    /// The part of the error that does not depend on the normal.
    pub loss: Wide<S>,
}

/// How the error of a decoded vector against the normal of a texel is measured.
pub(crate) trait DirectionMetric<S: Simd>: Copy {
    /// Returns the wanted normals.
    fn normals(&self) -> &Normals<S>;

    /// Returns the distance of an entry from the normal of texel `i`. A texel takes the nearest entry.
    fn distance(&self, i: usize, entry: &Entry<S>) -> Wide<S>;

    /// Returns the error of texel `i`, whose entry has this `distance`.
    fn error(&self, i: usize, distance: Wide<S>) -> Wide<S>;

    /// Returns how many of the likeliest patterns thorough searches fit.
    fn patterns(&self) -> usize;

    /// Returns in which lanes `blocks`, which are fitted to x and y by squared distance, may get below `error`.
    fn may_win(&self, blocks: &Blocks<S>, error: Wide<S>) -> <Wide<S> as Real>::Mask;

    /// Returns the weight of texel `i` in a regression if its vector is `decoded`; `None` if all texels weigh 1.
    fn weight(&self, i: usize, decoded: [Wide<S>; 3]) -> Option<Wide<S>>;
}

/// How thoroughly endpoints are fitted.
#[derive(Clone, Copy)]
pub(crate) struct Refinement {
    /// Rounds of regression; with 0 the endpoints stay.
    pub rounds: usize,
    /// Passes of [`Subset::leave_optimum`].
    pub hops: usize,
    /// Passes over single endpoints.
    pub passes: usize,
}

impl Refinement {
    /// Returns `rounds` of regression alone.
    pub fn rounds(rounds: usize) -> Self {
        Self { rounds, hops: 0, passes: 0 }
    }

    /// Returns `passes` over the single endpoints of fitted blocks.
    pub fn passes(passes: usize) -> Self {
        Self { rounds: 0, hops: 0, passes }
    }
}

/// Squared distances between directions.
#[derive(Clone, Copy)]
pub(crate) struct SquaredDistances<'a, S: Simd>(pub &'a Normals<S>);

impl<S: Simd> DirectionMetric<S> for SquaredDistances<'_, S> {
    #[inline(always)]
    fn normals(&self) -> &Normals<S> {
        self.0
    }

    #[inline(always)]
    fn distance(&self, i: usize, entry: &Entry<S>) -> Wide<S> {
        let [x, y, z] = texel(self.0, i);
        let [u, v, w] = entry.direction;
        let (a, b, c) = (x - u, y - v, z - w);
        a * a + entry.loss + b * b + c * c
    }

    #[inline(always)]
    fn error(&self, _: usize, distance: Wide<S>) -> Wide<S> {
        distance
    }

    #[inline(always)]
    fn patterns(&self) -> usize {
        2
    }

    #[inline(always)]
    fn may_win(&self, blocks: &Blocks<S>, error: Wide<S>) -> <Wide<S> as Real>::Mask {
        // The error of x and y is below that of directions.
        blocks.error.simd_lt(error)
    }

    #[inline(always)]
    fn weight(&self, _: usize, _: [Wide<S>; 3]) -> Option<Wide<S>> {
        None
    }
}

/// Endpoints of one subset for each channel: low, high.
type Ends<S> = [[Wide<S>; 2]; 3];

/// The most entries that a palette has.
const MAX_ENTRIES: usize = 32;

/// A subset of blocks.
///
/// The index of an entry is the weight index of all channels. With two planes, its upper bits are the weight index of
/// channel `selector`, and its lower bits that of the other channels.
struct Subset<S: Simd, M> {
    simd: S,
    ramp: &'static Ramp,
    range: &'static Range,
    selector: Option<usize>,
    metric: M,
    /// 1 for a member, 0 for other texels; `None` if all texels are members.
    mask: Option<Grid<S>>,
}

/// Returns the two weight indices of an entry of two planes: of the selected channel, and of the others.
#[inline(always)]
fn weight_indices<S: Simd>(entry: Wide<S>, ramp: &Ramp) -> [Wide<S>; 2] {
    let count = ramp.last + 1.0;
    // Entries are whole: a fraction less than a half keeps rounding down.
    let upper = round(entry * (1.0 / count) - (0.5 - 0.5 / count));
    [upper, entry - upper * count]
}

/// Endpoints of a subset with the best palette entries for its texels.
#[derive(Clone, Copy)]
struct Fit<S: Simd> {
    ends: Ends<S>,
    /// Palette entry of every texel.
    entries: Grid<S>,
    error: Wide<S>,
}

impl<S: Simd> Fit<S> {
    /// Replaces `self` by `other` where `other` has the smaller error. Returns whether any lane changed.
    #[inline(always)]
    fn keep_better(&mut self, other: &Self) -> bool {
        let is_better = other.error.simd_lt(self.error);
        if !is_better.any_true() {
            return false;
        }
        for (own, other) in self.ends.as_flattened_mut().iter_mut().zip(other.ends.as_flattened()) {
            set_where(own, *other, is_better);
        }
        for (own, other) in self.entries.iter_mut().zip(&other.entries) {
            set_where(own, *other, is_better);
        }
        set_where(&mut self.error, other.error, is_better);
        true
    }
}

impl<S: Simd, M: DirectionMetric<S>> Subset<S, M> {
    /// Returns the weights, 0..=64, of an entry: of the selected channel, and of the others.
    #[inline(always)]
    fn weights(&self, entry: Wide<S>) -> [Wide<S>; 2] {
        if self.selector.is_none() {
            return [self.ramp.weight(entry); 2];
        }
        let [single, others] = weight_indices(entry, self.ramp);
        [self.ramp.weight(single), self.ramp.weight(others)]
    }

    /// Returns the index into [`Self::weights`] for channel `c`.
    #[inline(always)]
    fn plane(&self, c: usize) -> usize {
        usize::from(self.selector != Some(c))
    }

    /// Returns how many entries the palette has.
    #[inline(always)]
    fn entries(&self) -> usize {
        let weights = self.ramp.last as usize + 1;
        if self.selector.is_some() { weights * weights } else { weights }
    }

    #[inline(always)]
    fn palette(&self, ends: &Ends<S>) -> [Entry<S>; MAX_ENTRIES] {
        let simd = self.simd;
        let zero = Wide::splat(simd, 0.0);
        let mut palette = [Entry { direction: [zero; 3], loss: zero }; MAX_ENTRIES];
        for (at, entry) in palette.iter_mut().take(self.entries()).enumerate() {
            (entry.direction, entry.loss) = effective_direction(self.decoded(ends, Wide::splat(simd, at as f32)));
        }
        palette
    }

    /// Returns the decoded vector of an entry, where unit length is [`UNIT`].
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

    /// Chooses the nearest entry for every texel.
    #[inline(always)]
    fn best_entries(&self, ends: &Ends<S>) -> Fit<S> {
        // Compiled once, and not for each call.
        self.simd.vectorize(
            #[inline(always)]
            || {
                let simd = self.simd;
                let palette = self.palette(ends);
                let zero = Wide::splat(simd, 0.0);
                let (mut entries, mut errors) = ([zero; 16], [zero; 16]);
                for i in 0..16 {
                    let (mut least, mut at) = (Wide::splat(simd, f32::INFINITY), zero);
                    for (e, entry) in palette.iter().take(self.entries()).enumerate() {
                        let distance = self.metric.distance(i, entry);
                        let is_nearer = distance.simd_lt(least);
                        least = is_nearer.select(distance, least);
                        at = is_nearer.select(Wide::splat(simd, e as f32), at);
                    }
                    (entries[i], errors[i]) = (at, self.metric.error(i, least));
                }
                let error = sum(
                    #[inline(always)]
                    |i| masked(self.mask.as_ref(), i, errors[i]),
                );
                Fit { ends: *ends, entries, error }
            },
        )
    }

    /// Returns how much each texel counts in a regression if `ends` and `entries` give the present vectors: 0 outside
    /// of the subset. Returns `None` if all texels count the same.
    #[inline(always)]
    fn regression_weights(&self, ends: &Ends<S>, entries: &Grid<S>) -> Option<Grid<S>> {
        self.metric.weight(0, self.decoded(ends, entries[0]))?;
        let mut weights = *entries;
        for i in 0..16 {
            let weight = self.metric.weight(i, self.decoded(ends, entries[i]));
            weights[i] = masked(self.mask.as_ref(), i, weight.unwrap_or(Wide::splat(self.simd, 1.0)));
        }
        Some(weights)
    }

    /// Returns the endpoints that fit the weights of `entries` best to `targets`, by regression in each channel. A
    /// texel counts as `subset` says.
    #[inline(always)]
    fn regress(&self, targets: &[Grid<S>; 3], entries: &Grid<S>, subset: Option<&Grid<S>>) -> Ends<S> {
        let simd = self.simd;
        let count = count(simd, subset);
        let zero = Wide::splat(simd, 0.0);
        // Weights of interpolation, and the same multiplied by how much the texel counts.
        let (mut weights, mut counted) = ([[zero; 2]; 16], [[zero; 2]; 16]);
        for i in 0..16 {
            let [single, others] = self.weights(entries[i]);
            weights[i] = [single, others];
            counted[i] = [masked(subset, i, single), masked(subset, i, others)];
        }
        let mut ends = [[zero; 2]; 3];
        for c in 0..3 {
            let plane = self.plane(c);
            let w = sum(
                #[inline(always)]
                |i| counted[i][plane],
            );
            let ww = sum(
                #[inline(always)]
                |i| counted[i][plane] * weights[i][plane],
            );
            let x = sum(
                #[inline(always)]
                |i| masked(subset, i, targets[c][i]),
            );
            let wx = sum(
                #[inline(always)]
                |i| counted[i][plane] * targets[c][i],
            );
            let determinant = count * ww - w * w;
            // Sums of whole numbers are exact and differ by more, unless all weights are equal.
            let is_line = determinant.simd_gt(count * ww * 1e-5);
            let slope = is_line.select((count * wx - w * x) / determinant, zero);
            let low = (x - slope * w) / count + UNIT;
            ends[c] = [quantise(simd, self.range, low), quantise(simd, self.range, low + slope * 64.0)];
        }
        ends
    }

    /// Returns the normals scaled to the lengths at which they are nearest to the vectors of `fit`.
    ///
    /// For the vectors of `fit`, the squared distance to these targets equals the error of directions. For other
    /// vectors, it is an upper bound of this error. Regression can treat its channels one by one.
    #[inline(always)]
    fn targets(&self, fit: &Fit<S>) -> [Grid<S>; 3] {
        let mut targets = *self.metric.normals();
        for i in 0..16 {
            let [x, y, z] = self.decoded(&fit.ends, fit.entries[i]);
            let along = (x * targets[0][i] + y * targets[1][i] + z * targets[2][i]) / (UNIT * UNIT);
            let (short, long) = (Wide::splat(self.simd, SHORT_PENALTY), Wide::splat(self.simd, LONG_PENALTY));
            let penalty = along.simd_lt(1.0).select(short, long);
            let length = along + penalty * (1.0 - along);
            for c in 0..3 {
                targets[c][i] *= length;
            }
        }
        targets
    }

    /// Fits endpoints and entries in turns for at most `rounds` rounds, starting with regression on `entries`, while
    /// the error falls. Keeps `ends` if `rounds` is 0.
    #[inline(always)]
    fn refine(&self, ends: &Ends<S>, entries: &Grid<S>, rounds: usize) -> Fit<S> {
        if rounds == 0 {
            return self.best_entries(ends);
        }
        let weights = self.regression_weights(ends, entries);
        let subset = weights.as_ref().or(self.mask.as_ref());
        let mut best = self.best_entries(&self.regress(self.metric.normals(), entries, subset));
        for _ in 1..rounds {
            let weights = self.regression_weights(&best.ends, &best.entries);
            let subset = weights.as_ref().or(self.mask.as_ref());
            if !best.keep_better(&self.best_entries(&self.regress(&self.targets(&best), &best.entries, subset))) {
                break;
            }
        }
        best
    }

    /// Leaves the nearest optimum, `hops` times for each channel: moves its endpoints by half the distance between
    /// palette entries, fits entries and endpoints again, and keeps what is better.
    #[inline(always)]
    fn leave_optimum(&self, mut best: Fit<S>, hops: usize) -> Fit<S> {
        let step = 0.5 / self.ramp.last;
        for _ in 0..hops {
            for k in 0..12 {
                let mut ends = best.ends;
                let [low, high] = &mut ends[k / 4];
                let by = (*high - *low) * if k % 2 == 0 { step } else { -step };
                let (a, b) = if k % 4 < 2 { (*low + by, *high + by) } else { (*low - by, *high + by) };
                (*low, *high) = (quantise(self.simd, self.range, a), quantise(self.simd, self.range, b));
                let moved = self.best_entries(&ends);
                let weights = self.regression_weights(&moved.ends, &moved.entries);
                let subset = weights.as_ref().or(self.mask.as_ref());
                let fitted = self.best_entries(&self.regress(&self.targets(&moved), &moved.entries, subset));
                best.keep_better(&moved);
                best.keep_better(&fitted);
            }
        }
        best
    }

    /// Moves single endpoints to neighbouring levels while the error falls, at most `passes` times each.
    #[inline(always)]
    fn polish(&self, mut best: Fit<S>, passes: usize) -> Fit<S> {
        for _ in 0..passes {
            let mut is_better = false;
            for k in 0..12 {
                let mut ends = best.ends;
                let end = &mut ends[k / 4][k % 2];
                *end = look_up(self.simd, &self.range.neighbour[usize::from(k % 4 < 2)], *end);
                is_better |= best.keep_better(&self.best_entries(&ends));
            }
            if !is_better {
                break;
            }
        }
        best
    }
}

impl<S: Simd> Blocks<S> {
    /// Fits blocks of one mode and selector to the normals of `metric` by direction.
    ///
    /// Endpoints are fitted by regression, starting from the weights of the blocks, and then as `refinement` says. The
    /// weights become the best ones for these endpoints. The error becomes that of `metric`.
    #[inline(always)]
    pub(crate) fn fit_directions<M>(&mut self, simd: S, metric: M, refinement: Refinement)
    where
        M: DirectionMetric<S>,
    {
        let Refinement { rounds, hops, passes } = refinement;
        simd.vectorize(
            #[inline(always)]
            || {
                let mode = self.modes[0];
                let ramp = mode.ramp();
                let selector: [f32; LANES] = self.selector.into();
                let selector = (mode.planes == 2).then_some(selector[0] as usize);
                let zero = Wide::splat(simd, 0.0);
                let mut entries = self.weights[0];
                if selector.is_some() {
                    for i in 0..16 {
                        entries[i] += self.weights[1][i] * (ramp.last + 1.0);
                    }
                }
                let masks = self.masks(simd);
                let mut chosen = [zero; 16];
                self.error = zero;
                for subset in 0..mode.subsets {
                    let mask = masks.map(|masks| masks[subset]);
                    let part = Subset { simd, ramp, range: mode.range, selector, metric, mask };
                    let [x, y, z, _] = self.endpoints[subset];
                    let ends = [x, y, z];
                    let fit = part.leave_optimum(part.refine(&ends, &entries, rounds), hops);
                    let fit = part.polish(fit, passes);
                    self.error += fit.error;
                    self.endpoints[subset][..3].copy_from_slice(&fit.ends);
                    for i in 0..16 {
                        chosen[i] += masked(mask.as_ref(), i, fit.entries[i]);
                    }
                }
                self.weights[0] = chosen;
                if selector.is_some() {
                    for i in 0..16 {
                        [self.weights[1][i], self.weights[0][i]] = weight_indices(chosen[i], ramp);
                    }
                }
            },
        );
    }
}
