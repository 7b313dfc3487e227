//! Packs a fitted block into its sixteen bytes.
//!
//! The bit layout is that of the "UASTC LDR 4x4 Texture Specification", sections "Block layout" and "Endpoint
//! packing". Fields follow each other from bit 0 of byte 0 upwards.

use crate::bit_writer::BitWriter;
use crate::hints::{Hints, SolidEtc1};
use crate::tables::{Layout, MODE_0, MODE_4, MODE_5, MODE_6, MODE_18, Mode, PATTERNS_3, SOLID_CODE};

/// A block of any mode except the solid mode.
#[derive(Clone)]
pub(crate) struct Block {
    pub mode: &'static Mode,
    /// Index into [`Mode::patterns`] or, with three subsets, [`PATTERNS_3`]; 0 if the mode has one subset.
    pub pattern: usize,
    /// The channel of the second plane; 0 if the mode has one plane.
    pub selector: usize,
    /// Low and high endpoint of each subset and channel, as levels of the mode's range.
    pub endpoints: [[[u8; 2]; 4]; 3],
    /// Weight indices of each plane and texel.
    pub weights: [[u8; 16]; 2],
    /// Sum of squared differences from the source over the channels that count.
    pub error: f32,
}

impl Block {
    /// Creates a block of `mode` whose numbers are all 0.
    pub fn empty(mode: &'static Mode) -> Self {
        Self { mode, pattern: 0, selector: 0, endpoints: [[[0; 2]; 4]; 3], weights: [[0; 16]; 2], error: 0.0 }
    }

    /// Returns the texels of a subset as bits, bit i for texel i.
    pub fn members(&self, subset: usize) -> u16 {
        match (self.mode.subsets, subset) {
            (1, _) => 0xffff,
            (2, 0) => !self.mode.patterns[self.pattern],
            (2, _) => self.mode.patterns[self.pattern],
            _ => PATTERNS_3[self.pattern][subset],
        }
    }

    /// Returns the anchor of a subset: the texel whose weights are stored without their top bit.
    pub fn anchor(&self, subset: usize) -> u32 {
        self.members(subset).trailing_zeros()
    }

    /// Returns the plane of channel `c`.
    pub fn plane_of(&self, c: usize) -> usize {
        usize::from(self.mode.planes == 2 && c == self.selector)
    }

    /// Makes the top bit of every anchor weight 0, because the format does not store this bit.
    ///
    /// Where the bit is 1, the weights of the subset and plane are mirrored and their endpoints exchanged. The weight
    /// ramps are symmetric, so the decoded colours do not change.
    #[inline(always)]
    fn mirror_anchors(&mut self, Layout { planes, subsets, weight_bits, .. }: Layout) {
        let top = (1u8 << weight_bits) - 1;
        for plane in 0..planes {
            // Sixteen bits for each channel.
            let selected = 0xffff << (16 * self.selector);
            let channels = match (planes, plane) {
                (1, _) => u64::MAX,
                (_, 0) => !selected,
                _ => selected,
            };
            for subset in 0..subsets {
                let (members, anchor) = match subsets {
                    1 => (u128::MAX, 0),
                    _ => (bytes_of(self.members(subset)), self.anchor(subset) as usize & 15),
                };
                // Masks instead of branches: half of all anchors are above the middle, which no processor predicts.
                let is_high = self.weights[plane][anchor] > top / 2;
                let weights = u128::from_le_bytes(self.weights[plane]);
                let members = members & u128::from_le_bytes([top; 16]);
                self.weights[plane] = (weights ^ members & u128::from(is_high).wrapping_neg()).to_le_bytes();
                let ends = &mut self.endpoints[subset];
                let pairs = ends.as_flattened().iter().rev().fold(0u64, |pairs, &end| pairs << 8 | u64::from(end));
                let exchanged = (pairs & 0x00ff_00ff_00ff_00ff) << 8 | pairs >> 8 & 0x00ff_00ff_00ff_00ff;
                let pairs = pairs ^ (pairs ^ exchanged) & channels & u64::from(is_high).wrapping_neg();
                ends.as_flattened_mut().copy_from_slice(&pairs.to_le_bytes());
            }
        }
    }

    /// Packs the block into its sixteen bytes.
    #[inline(always)]
    pub fn pack(self, hints: &Hints) -> [u8; 16] {
        let mode = self.mode;
        // Constant layouts compile to code without loops for the modes that quick searches choose most.
        match mode.number {
            0 => self.pack_in(const { MODE_0.layout() }, hints),
            4 => self.pack_in(const { MODE_4.layout() }, hints),
            5 => self.pack_in(const { MODE_5.layout() }, hints),
            6 => self.pack_in(const { MODE_6.layout() }, hints),
            18 => self.pack_in(const { MODE_18.layout() }, hints),
            _ => self.pack_in(mode.layout(), hints),
        }
    }

    /// Packs a block whose mode has the given `layout`.
    #[inline(always)]
    fn pack_in(mut self, layout: Layout, hints: &Hints) -> [u8; 16] {
        self.mirror_anchors(layout);
        let mode = self.mode;
        let mut out = BitWriter::default();
        out.push(mode.code.0.into(), mode.code.1.into());
        hints.write(mode, &mut out);
        match layout.subsets {
            1 => {}
            2 => out.push(self.pattern as u64, 5),
            _ => out.push(self.pattern as u64, 4),
        }
        if layout.planes == 2 {
            out.push(self.selector as u64, 2);
        }
        self.write_endpoints(layout, &mut out);
        self.write_weights(layout, &mut out);
        out.get().to_le_bytes()
    }

    #[inline(always)]
    fn write_endpoints(&self, layout: Layout, out: &mut BitWriter) {
        let Layout { channels, subsets, bits, base, .. } = layout;
        let code = &self.mode.range.code;
        let (group, lengths) = layout.groups();
        let mut codes = [0; 18];
        let mut count = 0;
        for subset in &self.endpoints[..subsets] {
            for &level in subset[..channels].as_flattened() {
                codes[count] = u64::from(code[usize::from(level)]);
                count += 1;
            }
        }
        let codes = &codes[..count];
        for group in codes.chunks(group) {
            let upper = group.iter().rev();
            let number = upper.fold(0, |sum, code| sum * u64::from(base) + (code >> bits));
            out.push(number, lengths[group.len()]);
        }
        // Two halves, each of which fits a word: at most eight endpoints of eight bits, or nine of two bits.
        for codes in codes.chunks(count / 2) {
            let lower = codes.iter().rev();
            let word = lower.fold(0, |word, code| word << bits | (code & ((1 << bits) - 1)));
            out.push(word, codes.len() as u32 * bits);
        }
    }

    #[inline(always)]
    fn write_weights(&self, Layout { planes, subsets, weight_bits: bits, .. }: Layout, out: &mut BitWriter) {
        let mut weights = self.weights[0];
        let mut width = bits;
        if planes == 2 {
            for (weight, second) in weights.iter_mut().zip(self.weights[1]) {
                *weight |= second << bits;
            }
            width = 2 * bits;
        }
        let (low, high) = weights.split_at(8);
        let half = 8 * width;
        let mut all = u128::from(close_up(low, width)) | u128::from(close_up(high, width)) << half;
        // Removes the top bits of anchors, the last anchor first.
        if planes == 2 {
            all = without_bit(all, 2 * bits - 1);
        }
        let mut anchors = [0; 3];
        let anchors = &mut anchors[..subsets];
        if subsets > 1 {
            for (subset, anchor) in anchors.iter_mut().enumerate() {
                *anchor = self.anchor(subset);
            }
            anchors.sort_unstable();
        }
        for anchor in anchors.iter().rev() {
            all = without_bit(all, anchor * bits + bits - 1);
        }
        out.push_last(all);
    }
}

/// Returns a word whose byte i is 255 if bit i of `members` is set, and 0 otherwise.
#[inline(always)]
fn bytes_of(members: u16) -> u128 {
    // Each of eight bits moves to a byte of its own. The addition sets the top bit of every byte that is not 0.
    let half = |bits: u16| {
        let apart = (u64::from(bits & 255) * 0x0101_0101_0101_0101) & 0x8040_2010_0804_0201;
        ((apart + 0x7f7f_7f7f_7f7f_7f7f) >> 7 & 0x0101_0101_0101_0101) * 255
    };
    u128::from(half(members)) | u128::from(half(members >> 8)) << 64
}

/// Packs eight weights of `width` bits, one in each byte, without gaps.
#[inline(always)]
fn close_up(weights: &[u8], mut width: u32) -> u64 {
    let mut word = weights.iter().rev().fold(0, |word, &weight| word << 8 | u64::from(weight));
    // Each step moves odd lanes down to even lanes and doubles the lanes.
    for (lane, ones) in [(8, 0x0001_0001_0001_0001), (16, 0x0000_0001_0000_0001), (32, 1)] {
        let even = ((1 << width) - 1) * ones;
        word = (word & even) | (word >> (lane - width) & (even << width));
        width *= 2;
    }
    word
}

/// Removes bit `at` from `word` and moves the bits above it down.
#[inline(always)]
fn without_bit(word: u128, at: u32) -> u128 {
    let below = (1 << at) - 1;
    (word & below) | (word >> 1 & !below)
}

/// Packs a block of one colour (mode 8), which stores the colour exactly.
pub(crate) fn pack_solid(colour: [u8; 4], etc1: SolidEtc1) -> [u8; 16] {
    let mut out = BitWriter::default();
    out.push(SOLID_CODE.0.into(), SOLID_CODE.1.into());
    out.push(u32::from_le_bytes(colour).into(), 32);
    out.push(etc1.five_bits.into(), 1);
    out.push(etc1.table.into(), 3);
    out.push(etc1.selector.into(), 2);
    for base in etc1.base {
        out.push(base.into(), 5);
    }
    out.get().to_le_bytes()
}
