//! The constants of the UASTC LDR 4x4 format: modes, endpoint ranges and partition patterns.
//!
//! The source is the "UASTC LDR 4x4 Texture Specification" (BinomialLLC/basis_universal wiki). The endpoint ranges are
//! those of the Khronos Data Format Specification 1.3, section 23.12 "Endpoint unquantization" (ASTC).

use crate::ramp::Ramp;

/// Number of modes of the format.
pub(crate) const MODES: usize = 19;

/// A mode of the format.
pub(crate) struct Mode {
    /// Number in the specification.
    pub number: u8,
    /// Prefix code and its length in bits.
    pub code: (u8, u8),
    /// Colour channels that the endpoints carry: 2 (grey and alpha), 3 (RGB) or 4 (RGBA).
    pub channels: usize,
    /// Number of subsets of texels, each with its own pair of endpoints.
    pub subsets: usize,
    /// The two-subset patterns of the mode: bit i is the subset of texel i, row 0 first.
    pub patterns: &'static [u16],
    /// Number of weight planes. The second plane holds the weights of one selected channel.
    pub planes: usize,
    /// Bits of one weight.
    pub weight_bits: u32,
    /// How the endpoints are quantised.
    pub range: &'static Range,
    /// Whether the hints hold the BC1 hint 1 bit and the 5-bit ETC1 bias.
    pub full_hints: bool,
}

/// The layout of a mode's blocks as plain numbers, which a compiler can evaluate as constants.
#[derive(Clone, Copy)]
pub(crate) struct Layout {
    /// As [`Mode::channels`].
    pub channels: usize,
    /// As [`Mode::subsets`].
    pub subsets: usize,
    /// As [`Mode::planes`].
    pub planes: usize,
    /// As [`Mode::weight_bits`].
    pub weight_bits: u32,
    /// As [`Range::bits`] of the endpoints.
    pub bits: u32,
    /// As [`Range::base`] of the endpoints.
    pub base: u32,
}

impl Layout {
    /// Returns the size of groups of trits or quints, and the bits of a group by the number of its members.
    ///
    /// Five trits share 8 bits and three quints share 7 bits. The last, incomplete group has as many bits as its
    /// largest value needs.
    #[inline(always)]
    pub fn groups(self) -> (usize, &'static [u32]) {
        match self.base {
            3 => (5, &[0, 2, 4, 5, 7, 8]),
            5 => (3, &[0, 3, 5, 7]),
            // A range without trits and quints has one group of no bits.
            _ => (18, &[0; 19]),
        }
    }
}

impl Mode {
    /// Returns the layout of the mode's blocks.
    pub const fn layout(&self) -> Layout {
        let Self { channels, subsets, planes, weight_bits, range: Range { bits, base, .. }, .. } = *self;
        Layout { channels, subsets, planes, weight_bits, bits: *bits, base: *base }
    }

    /// Returns the weights that indices of the mode stand for.
    pub fn ramp(&self) -> &'static Ramp {
        Ramp::of(self.weight_bits)
    }

    /// Returns whether blocks carry alpha.
    pub fn has_alpha(&self) -> bool {
        self.channels != 3
    }
}

const fn rgb(number: u8, code: (u8, u8), weight_bits: u32, range: &'static Range) -> Mode {
    let patterns = &PATTERNS_2;
    Mode { number, code, channels: 3, subsets: 1, patterns, planes: 1, weight_bits, range, full_hints: true }
}

const fn rgba(number: u8, code: (u8, u8), weight_bits: u32, range: &'static Range, full_hints: bool) -> Mode {
    Mode { channels: 4, full_hints, ..rgb(number, code, weight_bits, range) }
}

/// Mode 0: RGB, 16 weights.
pub(crate) static MODE_0: Mode = rgb(0, (0x1, 4), 4, &RANGE_192);
/// Mode 1: RGB, 4 weights, exact endpoints.
pub(crate) static MODE_1: Mode = rgb(1, (0x35, 6), 2, &RANGE_256);
/// Mode 2: RGB, two subsets of 8 weights.
pub(crate) static MODE_2: Mode = Mode { subsets: 2, ..rgb(2, (0x1d, 5), 3, &RANGE_16) };
/// Mode 3: RGB, three subsets of 4 weights.
pub(crate) static MODE_3: Mode = Mode { subsets: 3, ..rgb(3, (0x3, 5), 2, &RANGE_12) };
/// Mode 4: RGB, two subsets of 4 weights.
pub(crate) static MODE_4: Mode = Mode { subsets: 2, ..rgb(4, (0x13, 5), 2, &RANGE_40) };
/// Mode 5: RGB, 8 weights, exact endpoints.
pub(crate) static MODE_5: Mode = rgb(5, (0xb, 5), 3, &RANGE_256);
/// Mode 6: RGB, two planes of 4 weights.
pub(crate) static MODE_6: Mode = Mode { planes: 2, ..rgb(6, (0x1b, 5), 2, &RANGE_160) };
/// Mode 7: RGB, two subsets of 4 weights, in patterns of its own.
static MODE_7: Mode = Mode { subsets: 2, patterns: &MODE_7_PATTERNS, ..rgb(7, (0x7, 5), 2, &RANGE_40) };
/// Mode 9: RGBA, two subsets of 4 weights.
pub(crate) static MODE_9: Mode = Mode { subsets: 2, ..rgba(9, (0xf, 5), 2, &RANGE_16, true) };
/// Mode 10: RGBA, 16 weights.
pub(crate) static MODE_10: Mode = rgba(10, (0x2, 3), 4, &RANGE_48, false);
/// Mode 11: RGBA, two planes of 4 weights.
pub(crate) static MODE_11: Mode = Mode { planes: 2, ..rgba(11, (0x0, 2), 2, &RANGE_48, false) };
/// Mode 12: RGBA, 8 weights.
pub(crate) static MODE_12: Mode = rgba(12, (0x6, 3), 3, &RANGE_192, false);
/// Mode 13: RGBA, two planes of 2 weights, exact endpoints.
pub(crate) static MODE_13: Mode = Mode { planes: 2, ..rgba(13, (0x1f, 5), 1, &RANGE_256, true) };
/// Mode 14: RGBA, 4 weights, exact endpoints.
pub(crate) static MODE_14: Mode = rgba(14, (0xd, 5), 2, &RANGE_256, true);
/// Mode 15: grey and alpha, 16 weights, exact endpoints.
pub(crate) static MODE_15: Mode = Mode { channels: 2, ..rgb(15, (0x5, 7), 4, &RANGE_256) };
/// Mode 16: grey and alpha, two subsets of 4 weights, exact endpoints.
static MODE_16: Mode = Mode { channels: 2, subsets: 2, ..rgb(16, (0x15, 6), 2, &RANGE_256) };
/// Mode 17: grey and alpha, a plane of 4 weights for each, exact endpoints.
static MODE_17: Mode = Mode { channels: 2, planes: 2, ..rgb(17, (0x25, 6), 2, &RANGE_256) };
/// Mode 18: RGB, 32 weights.
pub(crate) static MODE_18: Mode = rgb(18, (0x9, 4), 5, &RANGE_32);

/// All modes except mode 8, ordered by how often the encoder chooses them.
pub(crate) static ALL: [&Mode; MODES - 1] = [
    &MODE_0, &MODE_4, &MODE_5, &MODE_6, &MODE_18, &MODE_1, &MODE_2, &MODE_3, &MODE_15, &MODE_7, &MODE_9, &MODE_10,
    &MODE_11, &MODE_12, &MODE_13, &MODE_14, &MODE_16, &MODE_17,
];

/// Prefix code of mode 8, in which all texels have one colour.
pub(crate) const SOLID_CODE: (u8, u8) = (0x17, 5);

/// A range of quantised endpoints (a range of ASTC's bounded integer sequence encoding).
pub(crate) struct Range {
    /// Plain bits of a value.
    pub bits: u32,
    /// 3 with a trit above the bits, 5 with a quint, 1 with neither.
    pub base: u32,
    /// Nearest code of every 8-bit level.
    pub code: [u8; 256],
    /// The level that the nearest code stands for.
    pub level: [u8; 256],
    /// The next level of the range below and above each level, or the level itself at either end.
    pub neighbour: [[u8; 256]; 2],
}

static RANGE_12: Range = Range::new(2, 3);
static RANGE_16: Range = Range::new(4, 1);
static RANGE_32: Range = Range::new(5, 1);
static RANGE_40: Range = Range::new(3, 5);
static RANGE_48: Range = Range::new(4, 3);
static RANGE_160: Range = Range::new(5, 5);
static RANGE_192: Range = Range::new(6, 3);
static RANGE_256: Range = Range::new(8, 1);

impl Range {
    const fn new(bits: u32, base: u32) -> Self {
        let mut range = Self { bits, base, code: [0; 256], level: [0; 256], neighbour: [[0; 256]; 2] };
        let mut target = 0;
        while target < 256 {
            let mut best = u32::MAX;
            let mut code = 0;
            while code < base << bits {
                let level = unquantize(code, bits, base);
                let error = level.abs_diff(target as u32);
                if error < best {
                    best = error;
                    range.code[target] = code as u8;
                    range.level[target] = level as u8;
                }
                code += 1;
            }
            target += 1;
        }
        let mut level = 0;
        while level < 256 {
            let own = range.level[level];
            let (mut below, mut above) = (level, level);
            while below > 0 && range.level[below] >= own {
                below -= 1;
            }
            while above < 255 && range.level[above] <= own {
                above += 1;
            }
            range.neighbour[0][level] = if range.level[below] < own { range.level[below] } else { own };
            range.neighbour[1][level] = if range.level[above] > own { range.level[above] } else { own };
            level += 1;
        }
        range
    }

    /// Returns the level of `code`.
    pub fn level_of(&self, code: u32) -> u8 {
        unquantize(code, self.bits, self.base) as u8
    }
}

/// Returns the level, 0..=255, of an endpoint code (Khronos Data Format 1.3, section 23.12, table 121).
const fn unquantize(code: u32, bits: u32, base: u32) -> u32 {
    let low = code & ((1 << bits) - 1);
    if base == 1 {
        // Bit replication: ranges of bits alone have 4 or more bits here.
        return if bits == 8 { low } else { (low << (8 - bits)) | (low >> (2 * bits - 8)) };
    }
    // The names are those of the specification: a is bit 0 copied to nine bits, b the scattered upper bits, and c the
    // step of one trit or quint d.
    let a = if low & 1 == 1 { 0x1ff } else { 0 };
    let upper = low >> 1;
    let (b, c) = match (base, bits) {
        (3, 2) => (upper << 8 | upper << 4 | upper << 2 | upper << 1, 93),
        (3, 4) => (upper << 6 | upper, 22),
        (3, 6) => (upper << 4 | upper >> 4, 5),
        (5, 3) => (upper << 7 | upper << 1 | upper >> 1, 26),
        (5, 5) => (upper << 5 | upper >> 3, 6),
        _ => panic!("not a range of this encoder"),
    };
    let d = code >> bits;
    (a & 0x80) | (((d * c + b) ^ a) >> 2)
}

/// The two-subset patterns that ASTC and BC7 share, in the order of the format's pattern index: bit i is the subset of
/// texel i, row 0 first.
pub(crate) static PATTERNS_2: [u16; 30] = [
    0xcccc, 0x8888, 0x1111, 0xecc8, 0x377f, 0xfeec, 0x0137, 0x137f, 0xc800, 0x0013, 0xfe80, 0x17ff, 0x0017, 0x00ff,
    0xfff0, 0x0fff, 0xff71, 0x8eff, 0x08ce, 0x008c, 0x7310, 0xceff, 0x7331, 0x088c, 0xceef, 0x6666, 0xf00f, 0x5555,
    0x0f0f, 0x36c9,
];

/// The two-subset patterns of ASTC that three-subset patterns of BC7 contain, in the order of mode 7's pattern index.
pub(crate) static MODE_7_PATTERNS: [u16; 19] = [
    0x00f0, 0x4444, 0x0133, 0xcc80, 0xf0ff, 0x2222, 0xffc8, 0xccce, 0x3c03, 0x00ee, 0x7700, 0x3003, 0x00ce, 0xff80,
    0x6fff, 0x1333, 0x11ff, 0x136c, 0x00ef,
];

/// The three-subset patterns that ASTC and BC7 share, in the order of the format's pattern index: bit i of member s
/// is set if texel i belongs to subset s.
pub(crate) static PATTERNS_3: [[u16; 3]; 11] = [
    [0x00ff, 0x3300, 0xcc00],
    [0x0f00, 0x00ff, 0xf000],
    [0x0ff0, 0x000f, 0xf000],
    [0xff00, 0x000f, 0x00f0],
    [0x8888, 0x3333, 0x4444],
    [0x1111, 0x6666, 0x8888],
    [0x1111, 0xcccc, 0x2222],
    [0x00ee, 0xee00, 0x1111],
    [0x2222, 0x4444, 0x9999],
    [0x00f0, 0xf00f, 0x0f00],
    [0x3333, 0x0cc0, 0xc00c],
];
