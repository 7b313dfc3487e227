//! Transcoding hints: what the block says to whoever turns it into ETC1, ETC2 or BC1.
//!
//! A transcoder accepts any value here; good values keep its quick paths close to the source.
//! Source: "UASTC LDR 4x4 Texture Specification", sections "ETC1 hints", "ETC2 hints" and "BC1
//! hints". The hints are taken from the source texels, whose averages the decoded ones share up
//! to rounding.

use super::lanes::Texels;
use super::pack::{Bits, SolidEtc1};
use super::tables::Mode;

/// ETC1 intensity tables: the smaller and the larger offset, of either sign.
pub(super) const ETC1_OFFSETS: [[i32; 2]; 8] =
    [[2, 8], [5, 17], [9, 29], [13, 42], [18, 60], [24, 80], [33, 106], [47, 183]];

/// Hints of a block that is not solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Hints {
    /// The weights of the block make good BC1 selectors.
    pub bc1_selectors: bool,
    /// ETC1 subblocks lie on top of each other (else side by side).
    pub flip: bool,
    /// ETC1 bases are one 5-bit colour and a difference (else two 4-bit colours).
    pub differential: bool,
    /// ETC1 intensity table per subblock.
    pub tables: [u8; 2],
    /// How the ETC1 bases depart from the rounded averages.
    pub bias: u8,
    /// EAC table (low four bits) and multiplier, 1 or more, of the alpha channel.
    pub eac: u8,
}

impl Hints {
    /// Appends the fields that `mode` has.
    pub fn write(&self, mode: &Mode, out: &mut Bits) {
        // BC1 hint 0 (endpoints rounded to 5:6:5 as they are) is never better than fitting them.
        out.push(0, 1);
        if mode.full_hints {
            out.push(self.bc1_selectors.into(), 1);
        }
        out.push(self.flip.into(), 1);
        out.push(self.differential.into(), 1);
        out.push(self.tables[0].into(), 3);
        out.push(self.tables[1].into(), 3);
        if mode.full_hints {
            out.push(self.bias.into(), 5);
        }
        if mode.has_alpha() {
            out.push(self.eac.into(), 8);
        }
    }

    /// The fields as they stand in a block of `mode`, after its code.
    pub fn bits(&self, mode: &Mode) -> u128 {
        let mut out = Bits::default();
        self.write(mode, &mut out);
        out.get()
    }

    /// Hints for a block of `mode` made from `texels`.
    #[inline(always)]
    pub fn of(texels: &Texels, mode: &Mode) -> Self {
        let mut hints = Self { bc1_selectors: mode.subsets == 1 && mode.planes == 1, ..Self::default() };
        if mode.has_alpha() {
            hints.eac = eac(texels);
        }
        let quadrants = quadrant_sums(texels);
        let side = [add(quadrants[0], quadrants[2]), add(quadrants[1], quadrants[3])];
        let stacked = [add(quadrants[0], quadrants[1]), add(quadrants[2], quadrants[3])];
        // The split whose halves differ more leaves less variance inside them.
        hints.flip = distance(stacked) > distance(side);
        let sums = if hints.flip { stacked } else { side };

        let bases = sums.map(|sum| sum.map(|s| (s * 31 + 1020) / 2040));
        hints.differential = (0..3).all(|c| (-4..=3).contains(&(bases[1][c] as i32 - bases[0][c] as i32)));
        hints.bias = if hints.differential {
            bias_for(bases, 31)
        } else {
            bias_for(sums.map(|sum| sum.map(|s| (s * 15 + 1020) / 2040)), 15)
        };
        hints.tables = intensity_tables(texels, hints.flip, sums);
        hints
    }
}

fn add(a: [u32; 3], b: [u32; 3]) -> [u32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn distance([a, b]: [[u32; 3]; 2]) -> u32 {
    (0..3).map(|c| a[c].abs_diff(b[c]).pow(2)).sum()
}

/// Sums of red, green and blue over the four 2x2 quadrants, row 0 first.
#[inline(always)]
fn quadrant_sums(texels: &Texels) -> [[u32; 3]; 4] {
    // Four channels of 16 bits in one word: four texels sum to 1020 at most.
    let spread = |i: usize| {
        let v = u64::from(u32::from_le_bytes(texels[i]));
        let v = (v | v << 16) & 0x0000_ffff_0000_ffff;
        (v | v << 8) & 0x00ff_00ff_00ff_00ff
    };
    [0, 2, 8, 10].map(|i| {
        let sum = spread(i) + spread(i + 1) + spread(i + 4) + spread(i + 5);
        [0, 16, 32].map(|shift| (sum >> shift) as u32 & 0xffff)
    })
}

/// 1 for the texels of the second half of a block, split side by side or, flipped, one above the other.
const SECOND_HALF: [[i32; 16]; 2] =
    [[0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1], [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1]];

/// The intensity table of each half, from its largest departure in luma.
#[inline(always)]
fn intensity_tables(texels: &Texels, flip: bool, sums: [[u32; 3]; 2]) -> [u8; 2] {
    // Luma weights of the transcoder's choice of selectors, in 1/256.
    let luma = |[r, g, b]: [i32; 3]| r * 54 + g * 183 + b * 19;
    let [first, second] = sums.map(|sum| luma(sum.map(|s| s as i32)) / 8);
    let mut reach = [[0; 16]; 2];
    for (i, texel) in texels.iter().enumerate() {
        let texel = u32::from_le_bytes(*texel);
        let own = luma([0, 8, 16].map(|shift| (texel >> shift & 255) as i32));
        let is_second = SECOND_HALF[usize::from(flip)][i];
        reach[0][i] = (own - first).abs() * (1 - is_second);
        reach[1][i] = (own - second).abs() * is_second;
    }
    // 9/16 of the reach: full reach loses 1.5 dB of ETC1 on normals and gains 0.1 on ORM maps.
    reach.map(|reach| table_for(reach.into_iter().fold(0, i32::max) * 9 / 16 / 256))
}

/// The table whose larger offset suits departures up to `reach`.
fn table_for(reach: i32) -> u8 {
    // Half way between the larger offsets of neighbouring tables.
    const LIMITS: [i32; 7] = [12, 23, 35, 51, 70, 93, 144];
    LIMITS.iter().map(|&limit| u8::from(reach > limit)).sum()
}

/// Departure of each ETC1 base (first subblock's RGB, then the second's) under each bias.
const BIASES: [[i8; 6]; 32] = biases();

const fn biases() -> [[i8; 6]; 32] {
    let mut all = [[0; 6]; 32];
    // As a rule the digits of the bias to base 3, less 1, hold for both subblocks.
    let mut bias = 0;
    while bias < 32 {
        let digits = [(bias % 3) as i8 - 1, (bias / 3 % 3) as i8 - 1, (bias / 9 % 3) as i8 - 1];
        all[bias] = [digits[0], digits[1], digits[2], digits[0], digits[1], digits[2]];
        bias += 1;
    }
    // These move one channel of one subblock.
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
    // And these all channels of one or both.
    all[10] = [-2; 6];
    all[27] = [-1, -1, -1, 0, 0, 0];
    all[28] = [1, 1, 1, -1, -1, -1];
    all[29] = [0, 0, 0, 1, 1, 1];
    all[30] = [0, 0, 0, -1, -1, -1];
    all[31] = [1, 1, 1, 0, 0, 0];
    all
}

/// For every combination of bases at 0 (digit 0 to base 3), inside (1) and at the limit (2), the
/// bias that moves them least: departures are shifted inwards at both ends.
static LEAST_BIAS: [u8; 729] = least_biases();

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

/// The bias that keeps `bases` (0..=`limit`) nearest to themselves.
fn bias_for(bases: [[u32; 3]; 2], limit: u32) -> u8 {
    let state = bases
        .iter()
        .flatten()
        .rev()
        .fold(0, |state, &base| state * 3 + usize::from(base > 0) + usize::from(base == limit));
    LEAST_BIAS[state]
}

/// EAC table and multiplier that span the range of alpha.
fn eac(texels: &Texels) -> u8 {
    // Table 11 has evenly spread offsets, -10 to 9.
    let alpha = texels.map(|t| t[3]);
    let low = alpha.iter().copied().min().unwrap_or(255);
    let high = alpha.iter().copied().max().unwrap_or(255);
    let multiplier = ((u32::from(high - low) + 9) / 19).clamp(1, 15) as u8;
    multiplier << 4 | 11
}

/// The ETC1 block nearest to one colour, among those with 5-bit bases and the two gentlest tables.
pub(super) fn solid_etc1(colour: [u8; 4]) -> SolidEtc1 {
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
