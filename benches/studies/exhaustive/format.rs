//! The blocks that UASTC has for opaque colours, described by the tables of an independent decoder.

use basisu::uastc::bise::{astc_get_levels, unquant_astc_endpoint_val};
use basisu::uastc::patterns::{ASTC_BC7_PATTERNS2, ASTC_BC7_PATTERNS3, BC7_3_ASTC2_PATTERNS2};
use basisu::uastc::tables::{ENDPOINT_RANGES, WEIGHT_BITS};
use basisu::uastc::unpack::{UnpackedUastcBlock, unpack_to_block};

/// The modes that store red, green and blue and no alpha, without the mode of one colour.
const MODES: [u8; 9] = [0, 1, 2, 3, 4, 5, 6, 7, 18];

/// A mode with its pattern of subsets, or with the channel of its second plane of weights.
pub struct Kind {
    /// The mode's number in the specification.
    pub mode: u8,
    /// The index of the pattern; 0 for modes of one subset.
    pub pattern: usize,
    /// The channel of the second plane.
    pub selector: Option<usize>,
    /// The texels of each subset.
    pub subsets: Vec<Vec<usize>>,
    /// The levels that endpoints may have, in ascending order.
    pub levels: Vec<u8>,
    /// The weights of a palette's entries, 0 to 64: of the selected channel and of the others.
    pub weights: Vec<[u8; 2]>,
}

/// Indices of endpoints into [`Kind::levels`]: low and high of each channel.
pub type Ends = [[u8; 2]; 3];

/// Returns all kinds of blocks.
pub fn kinds() -> Vec<Kind> {
    let kinds = MODES.into_iter().flat_map(|mode| match mode {
        2 | 4 => patterned(mode, &ASTC_BC7_PATTERNS2, 2),
        3 => patterned(mode, &ASTC_BC7_PATTERNS3, 3),
        7 => patterned(mode, &BC7_3_ASTC2_PATTERNS2, 2),
        6 => (0..3).map(|selector| kind(mode, 0, Some(selector), vec![(0..16).collect()])).collect(),
        _ => vec![kind(mode, 0, None, vec![(0..16).collect()])],
    });
    kinds.collect()
}

fn patterned(mode: u8, patterns: &[[u8; 16]], subsets: u8) -> Vec<Kind> {
    let members = |pattern: &[u8; 16], subset| (0..16).filter(|&i| pattern[i] == subset).collect();
    let subsets_of = |pattern: &[u8; 16]| (0..subsets).map(|subset| members(pattern, subset)).collect();
    patterns.iter().enumerate().map(|(k, pattern)| kind(mode, k, None, subsets_of(pattern))).collect()
}

fn kind(mode: u8, pattern: usize, selector: Option<usize>, subsets: Vec<Vec<usize>>) -> Kind {
    let range = u32::from(ENDPOINT_RANGES[usize::from(mode)]);
    let mut levels: Vec<u8> =
        (0..astc_get_levels(range)).map(|code| unquant_astc_endpoint_val(code, range) as u8).collect();
    levels.sort_unstable();
    let ramp = ramp(WEIGHT_BITS[usize::from(mode)]);
    let weights = match selector {
        None => ramp.iter().map(|&weight| [weight; 2]).collect(),
        Some(_) => ramp.iter().flat_map(|&single| ramp.iter().map(move |&others| [single, others])).collect(),
    };
    Kind { mode, pattern, selector, subsets, levels, weights }
}

/// Returns the weights of `bits` bits, as section 23.14 of the Khronos Data Format Specification expands them.
fn ramp(bits: u8) -> Vec<u8> {
    let top = (1_u32 << bits) - 1;
    let weight = |index: u32| {
        let replicated = match bits {
            2 => index * 0b01_0101,
            3 => index * 0b00_1001,
            4 => index << 2 | index >> 2,
            _ => index << 1 | index >> 4,
        };
        replicated + u32::from(replicated > 32)
    };
    (0..=top).map(|index| weight(index) as u8).collect()
}

impl Kind {
    /// Returns the level of channel `c` at an entry's weights.
    pub fn level(&self, ends: &Ends, c: usize, weights: [u8; 2]) -> u8 {
        let [low, high] = ends[c].map(|end| u32::from(self.levels[usize::from(end)]) * 257);
        let weight = u32::from(weights[usize::from(self.selector != Some(c))]);
        ((((64 - weight) * low + weight * high + 32) >> 6) >> 8) as u8
    }

    /// Returns the endpoints of `bytes` by subset if the block is of this kind.
    pub fn ends_of(&self, bytes: &[u8; 16]) -> Option<Vec<Ends>> {
        let block: UnpackedUastcBlock = unpack_to_block(bytes, false, false)?;
        let selector = block.astc.dual_plane.then_some(block.astc.ccs as usize);
        let pattern = if self.subsets.len() > 1 { block.common_pattern as usize } else { 0 };
        if block.mode != u32::from(self.mode) || selector != self.selector || pattern != self.pattern {
            return None;
        }
        let range = u32::from(ENDPOINT_RANGES[usize::from(self.mode)]);
        let end = |subset: usize, c: usize, end: usize| {
            let code = block.astc.endpoints[6 * subset + 2 * c + end];
            let level = unquant_astc_endpoint_val(code.into(), range) as u8;
            self.levels.partition_point(|&other| other < level) as u8
        };
        let ends = |subset| [0, 1, 2].map(|c| [end(subset, c, 0), end(subset, c, 1)]);
        Some((0..self.subsets.len()).map(ends).collect())
    }

    /// Returns the index of the level nearest to `level`.
    pub fn nearest(&self, level: f32) -> u8 {
        let at = self.levels.partition_point(|&other| f32::from(other) < level).min(self.levels.len() - 1);
        let is_below = at > 0 && level - f32::from(self.levels[at - 1]) < f32::from(self.levels[at]) - level;
        (at - usize::from(is_below)) as u8
    }
}
