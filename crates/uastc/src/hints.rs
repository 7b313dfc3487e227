//! Transcoding hints: fields of a block that help a transcoder to ETC1, ETC2 or BC1.
//!
//! A transcoder accepts any hints, and good hints keep its quick paths close to the source. They are described in the
//! "UASTC LDR 4x4 Texture Specification", sections "ETC1 hints", "ETC2 hints" and "BC1 hints". The hints are computed
//! from the source texels. Their averages are those of the decoded texels up to rounding.

use fearless_simd::Simd;

use crate::bit_writer::BitWriter;
use crate::lanes::{Texels, channels, round};
use crate::tables::Mode;
use texel_simd::{LANES, Real};

/// ETC1 intensity tables: the magnitudes of the smaller and of the larger offset.
pub(crate) const ETC1_OFFSETS: [[i32; 2]; 8] =
    [[2, 8], [5, 17], [9, 29], [13, 42], [18, 60], [24, 80], [33, 106], [47, 183]];

/// The EAC table of blocks in modes that store alpha: its offsets, from -10 to 9, are evenly spaced.
const EAC_TABLE: u8 = 11;

/// The difference of the largest and the least offset of [`EAC_TABLE`].
const EAC_RANGE: u8 = 19;

/// Hints of a block that is not solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Hints {
    /// The weights of the block make good BC1 selectors.
    pub bc1_selectors: bool,
    /// ETC1 subblocks lie on top of each other (else side by side).
    pub flip: bool,
    /// ETC1 bases are one 5-bit colour and a difference (else two 4-bit colours).
    pub differential: bool,
    /// ETC1 intensity table per subblock.
    pub tables: [u8; 2],
    /// How the ETC1 bases differ from the rounded averages.
    pub bias: u8,
    /// The factor of the offsets in the EAC block of alpha, 1 to 15.
    pub eac_multiplier: u8,
}

impl Hints {
    /// Appends the fields that `mode` has.
    #[inline(always)]
    pub fn write(&self, mode: &Mode, out: &mut BitWriter) {
        // BC1 hint 0 (endpoints rounded to 5:6:5 as they are) is never better than fitting them.
        out.push(0, 1);
        if mode.full_hints {
            out.push(self.bc1_selectors.into(), 1);
        }
        let tables = u64::from(self.tables[0]) << 2 | u64::from(self.tables[1]) << 5;
        out.push(u64::from(self.flip) | u64::from(self.differential) << 1 | tables, 8);
        if mode.full_hints {
            out.push(self.bias.into(), 5);
        }
        if mode.has_alpha() {
            out.push(u64::from(EAC_TABLE | self.eac_multiplier << 4), 8);
        }
    }

    /// Returns the bits of the fields in a block of `mode`, which follow the code of the mode.
    pub fn bits(&self, mode: &Mode) -> u128 {
        let mut out = BitWriter::default();
        self.write(mode, &mut out);
        out.get()
    }

    /// Chooses the hints for a block of `mode` that is made from `texels`.
    pub fn of(texels: &Texels, mode: &Mode) -> Self {
        let level = |c: usize| texels.map(|texel| f32::from(texel[c]));
        Self::new(etc1_fields(&[level(0), level(1), level(2)]), texels, mode)
    }

    /// Chooses the hints of one block in each lane.
    #[inline(always)]
    pub fn of_lanes<S: Simd>(simd: S, texels: [&Texels; LANES], modes: [&Mode; LANES]) -> [Self; LANES] {
        let mut fields = [[0.0; LANES]; 5];
        for (lanes, field) in fields.iter_mut().zip(etc1_fields(&channels(simd, texels))) {
            *lanes = field.into();
        }
        std::array::from_fn(|j| Self::new(fields.map(|field| field[j]), texels[j], modes[j]))
    }

    #[inline(always)]
    fn new([flip, differential, state, first, second]: [f32; 5], texels: &Texels, mode: &Mode) -> Self {
        Self {
            bc1_selectors: mode.subsets == 1 && mode.planes == 1,
            flip: flip > 0.0,
            differential: differential > 0.0,
            tables: [first as u8, second as u8],
            bias: LEAST_BIAS[state as usize],
            eac_multiplier: if mode.has_alpha() { eac_multiplier(texels) } else { 1 },
        }
    }
}

/// Returns the least factor with which the offsets of an EAC block span all alphas of `texels`. Alphas beyond 0 and
/// 255 are clamped, so that both ends are exact.
fn eac_multiplier(texels: &Texels) -> u8 {
    let (least, most) = texels.iter().fold((255, 0), |(least, most), &[.., a]| (a.min(least), a.max(most)));
    u8::div_ceil(most - least, EAC_RANGE).max(1)
}

/// Computes the ETC1 fields of [`Hints`] for one block, or for one block in each lane: flip, differential, the index
/// into [`LEAST_BIAS`] and both tables. All sums are whole numbers that an `f32` holds exactly.
#[inline(always)]
fn etc1_fields<F: Real>(levels: &[[F; 16]; 3]) -> [F; 5] {
    let (zero, one) = (levels[0][0].splat_like(0.0), levels[0][0].splat_like(1.0));
    // Sums over the 2x2 quadrants, row 0 first.
    let mut quadrants = [[zero; 3]; 4];
    for (quadrant, first) in quadrants.iter_mut().zip([0, 2, 8, 10]) {
        for (sum, level) in quadrant.iter_mut().zip(levels) {
            *sum = (level[first] + level[first + 1]) + (level[first + 4] + level[first + 5]);
        }
    }
    let side = [add(quadrants[0], quadrants[2]), add(quadrants[1], quadrants[3])];
    let stacked = [add(quadrants[0], quadrants[1]), add(quadrants[2], quadrants[3])];
    // The split whose halves differ more leaves less variance inside them.
    let is_side = distance(stacked).lanes_le(distance(side));
    let mut sums = side;
    for (half, stacked) in sums.iter_mut().zip(stacked) {
        for (sum, stacked) in half.iter_mut().zip(stacked) {
            *sum = sum.select(stacked, is_side);
        }
    }
    let (five, four) = (nearest_bases(&sums, 31.0), nearest_bases(&sums, 15.0));
    let mut is_near = one.lanes_le(one);
    for c in 0..3 {
        let difference = five[c + 3] - five[c];
        is_near = is_near & difference.lanes_le(zero.splat_like(3.0)) & zero.splat_like(-4.0).lanes_le(difference);
    }
    let mut state = zero;
    for (five, four) in five.into_iter().zip(four).rev() {
        // A digit to base 3: at 0, inside or at the limit.
        let base = five.select(four, is_near);
        let limit = zero.splat_like(31.0).select(zero.splat_like(15.0), is_near);
        state =
            state * zero.splat_like(3.0) + zero.select(one, base.is_zero()) + one.select(zero, limit.lanes_le(base));
    }
    let [first, second] = intensity_tables(levels, &sums, is_side);
    [zero.select(one, is_side), one.select(zero, is_near), state, first, second]
}

#[inline(always)]
fn add<F: Real>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn distance<F: Real>([a, b]: [[F; 3]; 2]) -> F {
    let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    x * x + y * y + z * z
}

/// Returns the means of both halves, scaled to 0..=`limit` and rounded.
#[inline(always)]
fn nearest_bases<F: Real>(sums: &[[F; 3]; 2], limit: f32) -> [F; 6] {
    let zero = sums[0][0].splat_like(0.0);
    let mut bases = [zero; 6];
    for (base, sum) in bases.iter_mut().zip(sums.as_flattened()) {
        // The floor of `exact`, whose fraction is a multiple of 1/2040.
        let exact = (*sum * zero.splat_like(limit) + zero.splat_like(1020.0)) / zero.splat_like(2040.0);
        *base = round(exact - zero.splat_like(0.5 - 1.0 / 4096.0));
    }
    bases
}

/// Returns the luma that transcoders choose selectors by, multiplied by 256.
#[inline(always)]
fn luma<F: Real>([r, g, b]: [F; 3]) -> F {
    r * r.splat_like(54.0) + g * r.splat_like(183.0) + b * r.splat_like(19.0)
}

/// Returns the intensity table of each half, chosen by its largest departure in luma.
#[inline(always)]
fn intensity_tables<F: Real>(levels: &[[F; 16]; 3], sums: &[[F; 3]; 2], is_side: F::Mask) -> [F; 2] {
    let zero = levels[0][0].splat_like(0.0);
    // The floors of the means, whose fractions are eighths.
    let means = [
        round(luma(sums[0]) * zero.splat_like(0.125) - zero.splat_like(0.4375)),
        round(luma(sums[1]) * zero.splat_like(0.125) - zero.splat_like(0.4375)),
    ];
    // The second quadrant belongs to the second half if halves stand side by side. The third quadrant belongs to the
    // second half if halves lie on top of each other.
    let of_quadrants = [means[0], means[1].select(means[0], is_side), means[0].select(means[1], is_side), means[1]];
    let mut reach = [zero; 4];
    for ((reach, mean), first) in reach.iter_mut().zip(of_quadrants).zip([0, 2, 8, 10]) {
        for i in [first, first + 1, first + 4, first + 5] {
            let departure = luma([levels[0][i], levels[1][i], levels[2][i]]) - mean;
            *reach = reach.max(departure.max(zero - departure));
        }
    }
    let first = reach[0].max(reach[2].select(reach[1], is_side));
    let second = reach[3].max(reach[1].select(reach[2], is_side));
    // 9/16 of the largest departure: the whole departure loses 1.5 dB of ETC1 on normals and gains 0.1 dB on ORM maps.
    [table_for(first * zero.splat_like(9.0 / 4096.0)), table_for(second * zero.splat_like(9.0 / 4096.0))]
}

/// Returns the table whose larger offset suits departures up to `reach`.
#[inline(always)]
fn table_for<F: Real>(reach: F) -> F {
    // The least whole numbers beyond the midpoints of the larger offsets of neighbouring tables.
    const LIMITS: [f32; 7] = [13.0, 24.0, 36.0, 52.0, 71.0, 94.0, 145.0];
    let (zero, one) = (reach.splat_like(0.0), reach.splat_like(1.0));
    let mut table = zero;
    for limit in LIMITS {
        table = table + one.select(zero, zero.splat_like(limit).lanes_le(reach));
    }
    table
}

/// Change of each ETC1 base by each bias: red, green and blue of the first subblock, then of the second.
const BIASES: [[i8; 6]; 32] = biases();

const fn biases() -> [[i8; 6]; 32] {
    let mut all = [[0; 6]; 32];
    // Most biases change both subblocks by their digits to base 3, minus 1.
    let mut bias = 0;
    while bias < 32 {
        let digits = [(bias % 3) as i8 - 1, (bias / 3 % 3) as i8 - 1, (bias / 9 % 3) as i8 - 1];
        all[bias] = [digits[0], digits[1], digits[2], digits[0], digits[1], digits[2]];
        bias += 1;
    }
    // These biases change one channel of one subblock.
    let down = [2, 5, 6, 18, 19, 20];
    let up = [7, 11, 15, 21, 24, 8];
    let mut at = 0;
    while at < 6 {
        all[down[at]] = [0; 6];
        all[down[at]][at] = -1;
        all[up[at]] = [0; 6];
        all[up[at]][at] = 1;
        at += 1;
    }
    // These biases change all channels of one subblock or of both.
    all[10] = [-2; 6];
    all[27] = [-1, -1, -1, 0, 0, 0];
    all[28] = [1, 1, 1, -1, -1, -1];
    all[29] = [0, 0, 0, 1, 1, 1];
    all[30] = [0, 0, 0, -1, -1, -1];
    all[31] = [1, 1, 1, 0, 0, 0];
    all
}

/// The bias that changes the bases least, for every combination of bases at 0 (digit 0 to base 3), inside (digit 1) and
/// at the limit (digit 2). Changes are shifted inwards at both ends.
pub(crate) static LEAST_BIAS: [u8; 729] = least_biases();

const fn least_biases() -> [u8; 729] {
    let mut table = [0; 729];
    let mut state = 0;
    while state < 729 {
        let mut best = i32::MAX;
        let mut bias = 0;
        while bias < 32 {
            let mut moved = 0;
            let mut at = 0;
            let mut rest = state;
            while at < 6 {
                let delta = BIASES[bias][at] as i32;
                moved += match rest % 3 {
                    0 if delta == -2 => 3,
                    0 => (delta + 1).abs(),
                    1 => delta.abs(),
                    _ => (delta - 1).abs(),
                };
                rest /= 3;
                at += 1;
            }
            if moved < best {
                best = moved;
                table[state] = bias as u8;
            }
            bias += 1;
        }
        state += 1;
    }
    table
}

/// The ETC1 block that a solid block transcodes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SolidEtc1 {
    /// Whether `base` has 5 bits a channel (differential) or 4 (individual).
    pub five_bits: bool,
    /// Intensity table, 0..=7.
    pub table: u8,
    /// Selector, 0..=3 from the darkest to the brightest.
    pub selector: u8,
    /// Base colour.
    pub base: [u8; 3],
}

/// Returns the ETC1 block nearest to one colour, among blocks with 5-bit bases and the two tables of smallest offsets.
pub(crate) fn solid_etc1(colour: [u8; 4]) -> SolidEtc1 {
    let mut best = SolidEtc1 { five_bits: true, table: 0, selector: 0, base: [0; 3] };
    let mut least = i32::MAX;
    for (table, [small, large]) in ETC1_OFFSETS[..2].iter().enumerate() {
        for (selector, offset) in [-large, -small, *small, *large].into_iter().enumerate() {
            let mut base = [0; 3];
            let mut error = 0;
            for c in 0..3 {
                let target = i32::from(colour[c]);
                let nearest = ((target - offset).clamp(0, 255) * 31 + 127) / 255;
                base[c] = nearest as u8;
                let decoded = ((nearest << 3 | nearest >> 2) + offset).clamp(0, 255);
                error += (decoded - target).pow(2);
            }
            if error < least {
                least = error;
                best = SolidEtc1 { five_bits: true, table: table as u8, selector: selector as u8, base };
            }
        }
    }
    best
}
