//! An estimate of how many bits zstd needs for a block.
//!
//! The model follows RFC 8878: literals cost their entropy (section 4.2), and a match costs codes for its lengths and
//! its offset (section 3.1.1.3.2.1). A match at the last offset is cheap, and a match that continues costs nearly
//! nothing.

/// Bits of the three codes of a match without the bits of its offset. File sizes hardly depend on this number.
const SEQUENCE: f32 = 9.0;
/// Bits of a match at the offset of the match before.
const REPEATED: f32 = 7.0;
/// Length in bytes of the shortest match that zstd finds at level 5.
pub(super) const SHORTEST_MATCH: u32 = 5;

/// What the bits of the next block depend on.
#[derive(Clone, Copy, Default)]
pub(super) struct MatchState {
    /// Offset of the last match, in blocks; 0 before the first match.
    last: u32,
    /// Whether the last match reaches the end of the last block.
    is_open: bool,
}

impl MatchState {
    /// Returns the state after a literal.
    pub fn closed(self) -> Self {
        Self { is_open: false, ..self }
    }

    /// Returns the bits of a match `offset` blocks back.
    #[inline(always)]
    pub fn bits_of_match(self, offset: u32) -> f32 {
        match (self.last == offset, self.is_open) {
            (true, true) => 0.5,
            (true, false) => REPEATED,
            // An offset of n blocks is one of 16 n bytes.
            (false, _) => SEQUENCE + (4 + offset.ilog2()) as f32,
        }
    }
}

/// The bits of literals in the blocks of one image.
pub(super) struct BitModel {
    /// Bits of every byte as a literal.
    literal: [f32; 256],
}

impl BitModel {
    /// Derives the model from the bytes of all blocks.
    pub fn new(blocks: &[u8]) -> Self {
        let mut counts = [1u64; 256];
        for &byte in blocks {
            counts[usize::from(byte)] += 1;
        }
        let total = counts.iter().sum::<u64>() as f64;
        Self { literal: counts.map(|count| libm::log2(total / count as f64) as f32) }
    }

    /// Returns the bits of `bytes` as literals.
    pub fn literals(&self, bytes: &[u8]) -> f32 {
        bytes.iter().map(|&byte| self.literal[usize::from(byte)]).sum()
    }

    /// Returns the bits of `bytes` if they may match those of the block `earlier`, which stands `offset` blocks back,
    /// and the state after them.
    pub fn with_matches(
        &self,
        bytes: &[u8; 16],
        earlier: &[u8; 16],
        offset: u32,
        state: MatchState,
    ) -> (f32, MatchState) {
        let differ = u128::from_le_bytes(*bytes) ^ u128::from_le_bytes(*earlier);
        let (mut bits, mut after) = (0.0, state);
        let mut at = 0;
        while at < 16 {
            let run = (differ >> (8 * at)).trailing_zeros().min(128 - 8 * at) / 8;
            let literals = self.literals(&bytes[at as usize..(at + run) as usize]);
            let cost = after.bits_of_match(offset);
            if run > 0 && (run >= SHORTEST_MATCH || at == 0 && cost < 1.0) && cost < literals {
                bits += cost;
                after = MatchState { last: offset, is_open: true };
            } else {
                bits += literals;
                after = if run > 0 { after.closed() } else { after };
            }
            at += run;
            if at < 16 {
                bits += self.literal[usize::from(bytes[at as usize])];
                after = after.closed();
                at += 1;
            }
        }
        (bits, after)
    }
}
