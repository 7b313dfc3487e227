//! About how many bits zstd takes for a block.
//!
//! The model knows what RFC 8878 stores: literals by their entropy (4.2), and sequences with codes for lengths and the
//! offset (3.1.1.3.2.1), where the last offset is cheap to use again and a match that goes on costs nothing more.

/// Bits of the three codes of a sequence, beside those of the offset itself; files hardly depend on it.
const SEQUENCE: f32 = 9.0;
/// Bits of a sequence whose offset is the last one.
const REPEATED: f32 = 7.0;
/// Shortest match that level 5 of zstd finds.
pub(super) const LEAST: u32 = 5;

/// What decides on the bits of the next block.
#[derive(Clone, Copy, Default)]
pub(super) struct State {
    /// Offset of the last match, in blocks; 0 before the first.
    last: u32,
    /// Whether that match reaches to the end of the last block.
    is_open: bool,
}

impl State {
    /// Returns the state after bytes that are literals.
    pub fn closed(self) -> Self {
        Self { is_open: false, ..self }
    }

    /// Returns the bits of a match `offset` blocks back.
    #[inline(always)]
    pub fn of_match(self, offset: u32) -> f32 {
        match (self.last == offset, self.is_open) {
            (true, true) => 0.5,
            (true, false) => REPEATED,
            // An offset of n blocks is one of 16 n bytes.
            (false, _) => SEQUENCE + (4 + offset.ilog2()) as f32,
        }
    }
}

/// The costs of a level.
pub(super) struct Bits {
    /// Bits of every byte as a literal.
    literal: [f32; 256],
}

impl Bits {
    /// Derives the costs from the bytes of all blocks.
    pub fn of(blocks: &[u8]) -> Self {
        let mut counts = [1u64; 256];
        for &byte in blocks {
            counts[usize::from(byte)] += 1;
        }
        let total = counts.iter().sum::<u64>() as f64;
        Self { literal: counts.map(|count| libm::log2(total / count as f64) as f32) }
    }

    /// Returns the bits of `bytes` without a match.
    pub fn alone(&self, bytes: &[u8]) -> f32 {
        bytes.iter().map(|&byte| self.literal[usize::from(byte)]).sum()
    }

    /// Returns the bits of `bytes` after `state` if they may match those of `donor`, `offset` blocks back, and the next
    /// state.
    pub fn with(&self, bytes: &[u8; 16], donor: &[u8; 16], offset: u32, state: State) -> (f32, State) {
        let differ = u128::from_le_bytes(*bytes) ^ u128::from_le_bytes(*donor);
        let (mut bits, mut after) = (0.0, state);
        let mut at = 0;
        while at < 16 {
            let run = (differ >> (8 * at)).trailing_zeros().min(128 - 8 * at) / 8;
            let literals = self.alone(&bytes[at as usize..(at + run) as usize]);
            let cost = after.of_match(offset);
            if run > 0 && (run >= LEAST || at == 0 && cost < 1.0) && cost < literals {
                bits += cost;
                after = State { last: offset, is_open: true };
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
