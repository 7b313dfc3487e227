//! Fields of bits in a block.

/// Collects fields of bits, from the lowest bit upwards.
#[derive(Default)]
pub(crate) struct BitWriter {
    bits: u128,
    len: u32,
}

impl BitWriter {
    /// Appends the `len` low bits of `value`. All other bits of `value` must be 0.
    #[inline(always)]
    pub fn push(&mut self, value: u64, len: u32) {
        self.bits |= u128::from(value) << self.len;
        self.len += len;
    }

    /// Appends the last field, which may be longer than 64 bits.
    #[inline(always)]
    pub fn push_last(&mut self, value: u128) {
        self.bits |= value << self.len;
    }

    /// Returns all bits that were appended.
    #[inline(always)]
    pub fn get(&self) -> u128 {
        self.bits
    }
}
