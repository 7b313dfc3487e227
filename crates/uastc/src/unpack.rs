//! Unpacks sixteen bytes to a block.

use crate::lanes::ScalarGrid;
use crate::line::decode;
use crate::pack::Block;
use crate::tables::{ALL, Mode, PATTERNS_3, Range, SOLID_CODE};

/// An unpacked block.
pub(crate) enum Unpacked {
    /// A block of mode 8: one colour for all texels.
    Solid([u8; 4]),
    /// A block of any other mode.
    Block(Block),
}

impl Unpacked {
    /// Decodes red, green and blue of the texels of a block without alpha.
    #[inline(always)]
    pub(crate) fn levels(&self) -> [ScalarGrid; 3] {
        match self {
            Self::Solid([r, g, b, _]) => [r, g, b].map(|&level| [level.into(); 16]),
            Self::Block(block) => block.levels(),
        }
    }

    /// Returns whether the block stores red, green and blue and no alpha.
    fn is_rgb(&self) -> bool {
        match self {
            Self::Solid([.., alpha]) => *alpha == 255,
            Self::Block(block) => block.mode.channels == 3,
        }
    }
}

/// Unpacks a block of RGB. Returns `None` if the block has alpha, is of grey and alpha (modes 15 to 17) or is invalid.
pub(crate) fn unpack_rgb(bytes: &[u8; 16]) -> Option<Unpacked> {
    unpack(bytes).filter(Unpacked::is_rgb)
}

/// Unpacks a block. Returns `None` if its mode is reserved or its pattern does not exist.
pub(crate) fn unpack(bytes: &[u8; 16]) -> Option<Unpacked> {
    let bits = u128::from_le_bytes(*bytes);
    let has_code = |(code, length): (u8, u8)| bits & ((1 << length) - 1) == u128::from(code);
    if has_code(SOLID_CODE) {
        return Some(Unpacked::Solid(((bits >> SOLID_CODE.1) as u32).to_le_bytes()));
    }
    let mode = ALL.into_iter().find(|mode| has_code(mode.code))?;
    let mut reader = Reader { bits, at: mode.header_bits() };
    let mut block = Block::empty(mode);
    block.pattern = match mode.subsets {
        1 => 0,
        2 => reader.read(5) as usize,
        _ => reader.read(4) as usize,
    };
    let patterns = if mode.subsets == 2 { mode.patterns.len() } else { PATTERNS_3.len() };
    if block.pattern >= patterns {
        return None;
    }
    if mode.planes == 2 {
        // Mode 17 stores no selector: alpha always has the second plane.
        block.selector = if mode.channels == 2 { 3 } else { reader.read(2) as usize };
    }
    block.read_endpoints(&mut reader);
    block.read_weights(&mut reader);
    Some(Unpacked::Block(block))
}

impl Mode {
    /// Returns the number of bits of the mode's code and hints.
    pub fn header_bits(&self) -> u32 {
        let hints = if self.full_hints { 15 } else { 9 };
        u32::from(self.code.1) + hints + if self.has_alpha() { 8 } else { 0 }
    }

    /// Returns the hints in a block of this mode, in the form of [`Hints::bits`](crate::hints::Hints::bits).
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
            let mut number = reader.read(lengths[group.len()]);
            for code in group {
                *code = (number % range.base) << range.bits;
                number /= range.base;
            }
        }
        for (k, code) in codes[..count].iter().enumerate() {
            let level = range.level_of(code | reader.read(range.bits));
            self.endpoints[k / (2 * self.mode.channels)][k / 2 % self.mode.channels][k % 2] = level;
        }
    }

    fn read_weights(&mut self, reader: &mut Reader) {
        let anchors: u16 = (0..self.mode.subsets).map(|subset| 1 << self.anchor(subset)).sum();
        for i in 0..16 {
            for plane in 0..self.mode.planes {
                let is_anchor = u32::from(anchors >> i & 1);
                self.weights[plane][i] = reader.read(self.mode.weight_bits - is_anchor) as u8;
            }
        }
    }

    /// Decodes red, green and blue of the texels.
    #[inline(always)]
    pub(crate) fn levels(&self) -> [ScalarGrid; 3] {
        let mut levels = [[0.0; 16]; 3];
        for (c, levels) in levels.iter_mut().enumerate() {
            *levels = self.channel(c, self.plane_of(c));
        }
        levels
    }

    /// Decodes the stored channel `c` with the weights of `plane`.
    #[inline(always)]
    pub(crate) fn channel(&self, c: usize, plane: usize) -> ScalarGrid {
        let weights = self.ramps(plane);
        let mut levels = [0.0; 16];
        for subset in 0..self.mode.subsets {
            let members = self.members(subset);
            let [low, high] = self.endpoints[subset][c].map(f32::from);
            for i in 0..16 {
                let level = decode(low, high - low, weights[i]);
                levels[i] = if members >> i & 1 == 1 { level } else { levels[i] };
            }
        }
        levels
    }

    /// Returns the weights of a plane, 0 to 64.
    #[inline(always)]
    pub(crate) fn ramps(&self, plane: usize) -> ScalarGrid {
        let ramp = self.mode.ramp();
        self.weights[plane].map(|index| ramp.weight(f32::from(index)))
    }
}

/// Reads fields of bits, from the lowest bit upwards.
struct Reader {
    bits: u128,
    at: u32,
}

impl Reader {
    fn read(&mut self, length: u32) -> u32 {
        let value = (self.bits >> self.at) as u32 & ((1 << length) - 1);
        self.at += length;
        value
    }
}
