//! From sixteen bytes back to the block that they were packed from, for the opaque modes of colours that this encoder writes.

use super::line::{decode, ramp};
use super::pack::Block;
use super::rate::Lane;
use super::tables::{
    MODE_0, MODE_1, MODE_2, MODE_3, MODE_4, MODE_5, MODE_6, MODE_18, Mode, PATTERNS, Range, SOLID_CODE, THIRDS,
};

/// The opaque modes but the solid and the grey one.
static OPAQUE: [&Mode; 8] = [&MODE_0, &MODE_1, &MODE_2, &MODE_3, &MODE_4, &MODE_5, &MODE_6, &MODE_18];

/// What sixteen bytes hold.
pub(super) enum Unpacked {
    /// One opaque colour.
    Solid([u8; 3]),
    /// A block of an opaque mode.
    Block(Block),
}

impl Unpacked {
    /// The levels that the texels decode to.
    #[inline(always)]
    pub(super) fn levels(&self) -> [Lane; 3] {
        match self {
            Self::Solid(colour) => colour.map(|level| [level.into(); 16]),
            Self::Block(block) => block.levels(),
        }
    }
}

/// Reads `bytes`; none where they have alpha, a mode that this encoder does not write, or a pattern that does not exist.
pub(super) fn unpack(bytes: &[u8; 16]) -> Option<Unpacked> {
    let bits = u128::from_le_bytes(*bytes);
    let has_code = |(code, length): (u8, u8)| bits & ((1 << length) - 1) == u128::from(code);
    if has_code(SOLID_CODE) {
        let [r, g, b, a] = ((bits >> SOLID_CODE.1) as u32).to_le_bytes();
        return (a == 255).then_some(Unpacked::Solid([r, g, b]));
    }
    let mode = OPAQUE.into_iter().find(|mode| has_code(mode.code))?;
    let mut reader = Reader { bits, at: mode.header_bits() };
    let mut block = Block::empty(mode);
    block.pattern = match mode.subsets {
        1 => 0,
        2 => reader.take(5) as usize,
        _ => reader.take(4) as usize,
    };
    if mode.planes == 2 {
        block.selector = reader.take(2) as usize;
    }
    let patterns = if mode.subsets == 2 { PATTERNS.len() } else { THIRDS.len() };
    if block.pattern >= patterns || block.selector > 2 {
        return None;
    }
    block.read_endpoints(&mut reader);
    block.read_weights(&mut reader);
    Some(Unpacked::Block(block))
}

impl Mode {
    /// Bits of the mode's code and of its hints.
    pub fn header_bits(&self) -> u32 {
        let hints = if self.full_hints { 15 } else { 9 };
        u32::from(self.code.1) + hints + if self.has_alpha() { 8 } else { 0 }
    }

    /// The hints of a block of this mode, as [`Hints::bits`](super::hints::Hints::bits) gives them.
    pub fn hints_in(&self, bytes: &[u8; 16]) -> u128 {
        let below = (1 << self.header_bits()) - 1;
        (u128::from_le_bytes(*bytes) & below) >> self.code.1
    }
}

impl Block {
    fn read_endpoints(&mut self, reader: &mut Reader) {
        let range: &Range = self.mode.range;
        let count = 2 * self.mode.channels * self.mode.subsets;
        let (group, lengths) = self.mode.layout().groups();
        let mut codes = [0; 18];
        for group in codes[..count].chunks_mut(group) {
            let mut number = reader.take(lengths[group.len()]);
            for code in group {
                *code = (number % range.base) << range.bits;
                number /= range.base;
            }
        }
        for (k, code) in codes[..count].iter().enumerate() {
            let level = range.level_of(code | reader.take(range.bits));
            self.endpoints[k / (2 * self.mode.channels)][k / 2 % self.mode.channels][k % 2] = level;
        }
    }

    fn read_weights(&mut self, reader: &mut Reader) {
        let anchors: u16 = (0..self.mode.subsets).map(|subset| 1 << self.anchor(subset)).sum();
        for i in 0..16 {
            for plane in 0..self.mode.planes {
                let is_anchor = u32::from(anchors >> i & 1);
                self.weights[plane][i] = reader.take(self.mode.weight_bits - is_anchor) as u8;
            }
        }
    }

    /// The levels that the texels decode to.
    #[inline(always)]
    pub(super) fn levels(&self) -> [Lane; 3] {
        let mut levels = [[0.0; 16]; 3];
        for (c, levels) in levels.iter_mut().enumerate() {
            let weights = self.ramps(self.plane_of(c));
            for subset in 0..self.mode.subsets {
                let members = self.members(subset);
                let [low, high] = self.endpoints[subset][c].map(f32::from);
                for i in 0..16 {
                    let level = decode(low, high - low, weights[i]);
                    levels[i] = if members >> i & 1 == 1 { level } else { levels[i] };
                }
            }
        }
        levels
    }

    /// The weights of a plane, 0 to 64.
    #[inline(always)]
    pub(super) fn ramps(&self, plane: usize) -> Lane {
        let weights = &self.weights[plane];
        let of = |ramp: fn(f32) -> f32| weights.map(|w| ramp(w.into()));
        match self.mode.weight_bits {
            2 => of(ramp::<2, f32>),
            3 => of(ramp::<3, f32>),
            4 => of(ramp::<4, f32>),
            _ => of(ramp::<5, f32>),
        }
    }
}

struct Reader {
    bits: u128,
    at: u32,
}

impl Reader {
    fn take(&mut self, length: u32) -> u32 {
        let value = (self.bits >> self.at) as u32 & ((1 << length) - 1);
        self.at += length;
        value
    }
}
