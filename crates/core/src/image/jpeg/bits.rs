//! Reads the bits of an entropy-coded segment and their Huffman codes (ITU-T T.81, C.2 and F.2.2).

/// Why a segment cannot be followed further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The segment ends where more bits are needed.
    Ended,
    /// The bits are not a code, or a code that is not allowed there.
    NoCode,
}

/// The longest code that is looked up in one step. Nearly all codes of photographs are this short.
const LOOKAHEAD: u32 = 9;

/// A Huffman table.
pub(super) struct Table {
    /// By the next [`LOOKAHEAD`] bits: the symbol and the length of its code, which is 0 if the code is longer.
    short: Vec<(u8, u8)>,
    /// By length: one more than the last code of this length.
    ends: [u32; 17],
    /// By length: the number that is added to a code of this length to find the index of its symbol.
    offsets: [i32; 17],
    symbols: Vec<u8>,
}

impl Table {
    /// Builds the table from the number of codes of each length and the symbols in the order of their codes. Returns
    /// `None` if there are more codes than their lengths allow.
    pub(super) fn new(counts: &[u8; 16], symbols: &[u8]) -> Option<Self> {
        let mut short = vec![(0, 0); 1 << LOOKAHEAD];
        let (mut ends, mut offsets) = ([0; 17], [0; 17]);
        let (mut code, mut index) = (0u32, 0usize);
        for (length, &count) in (1u32..).zip(counts) {
            let count = usize::from(count);
            offsets[length as usize] = index as i32 - code as i32;
            if let Some(unused) = LOOKAHEAD.checked_sub(length) {
                for (code, &symbol) in (code..).zip(symbols.get(index..index + count)?) {
                    let first = (code << unused) as usize;
                    short.get_mut(first..first + (1 << unused))?.fill((symbol, length as u8));
                }
            }
            (code, index) = (code + count as u32, index + count);
            if code > 1 << length {
                return None;
            }
            ends[length as usize] = code;
            code <<= 1;
        }
        Some(Self { short, ends, offsets, symbols: symbols.get(..index)?.to_vec() })
    }
}

/// Reads the bits of an entropy-coded segment, which ends at the next marker.
pub(super) struct Bits<'a> {
    bytes: &'a [u8],
    /// Position of the next byte in the file.
    at: usize,
    /// Bits that are read but not used, the next bit at the top.
    buffer: u64,
    count: u32,
}

impl<'a> Bits<'a> {
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at, buffer: 0, count: 0 }
    }

    /// Returns the next byte without its stuffing, and the number of its bytes in the file (T.81, B.1.1.5).
    fn next_byte(&self) -> Option<(u8, usize)> {
        match *self.bytes.get(self.at)? {
            0xff => (self.bytes.get(self.at + 1) == Some(&0)).then_some((0xff, 2)),
            byte => Some((byte, 1)),
        }
    }

    fn fill(&mut self) {
        while self.count <= 56 {
            let Some((byte, length)) = self.next_byte() else { return };
            self.buffer |= u64::from(byte) << (56 - self.count);
            self.count += 8;
            self.at += length;
        }
    }

    /// Skips `count` bits.
    pub(super) fn skip(&mut self, mut count: u32) -> Result<(), Fault> {
        while count > 0 {
            if self.count < count {
                self.fill();
            }
            let part = count.min(32);
            self.count = self.count.checked_sub(part).ok_or(Fault::Ended)?;
            self.buffer <<= part;
            count -= part;
        }
        Ok(())
    }

    /// Returns the number in the next `count` bits, 16 at most.
    pub(super) fn number(&mut self, count: u32) -> Result<u32, Fault> {
        if count == 0 {
            return Ok(0);
        }
        self.fill();
        let number = self.buffer >> (64 - count);
        self.skip(count)?;
        Ok(number as u32)
    }

    /// Returns the symbol of the next code.
    #[inline]
    pub(super) fn symbol(&mut self, table: &Table) -> Result<u8, Fault> {
        if self.count < 16 {
            self.fill();
        }
        let (symbol, length) = table.short[(self.buffer >> (64 - LOOKAHEAD)) as usize];
        if length > 0 {
            self.skip(length.into())?;
            return Ok(symbol);
        }
        for length in LOOKAHEAD + 1..=16 {
            let code = (self.buffer >> (64 - length)) as u32;
            if code < table.ends[length as usize] {
                self.skip(length)?;
                let index = code as i32 + table.offsets[length as usize];
                return usize::try_from(index).ok().and_then(|i| table.symbols.get(i).copied()).ok_or(Fault::NoCode);
            }
        }
        Err(if self.count < 16 { Fault::Ended } else { Fault::NoCode })
    }

    /// Ends the segment. Returns the position of the next marker, and the number of unused whole bytes that are not
    /// filling.
    pub(super) fn end(&mut self) -> (usize, usize) {
        let padding = self.count % 8;
        (self.buffer, self.count) = (self.buffer << padding, self.count - padding);
        let (mut left, mut filling) = (0, [0; 2]);
        loop {
            self.fill();
            if self.count == 0 {
                break;
            }
            match self.buffer >> 56 {
                0x00 => filling[0] += 1,
                0xff => filling[1] += 1,
                _ => left += 1,
            }
            (self.buffer, self.count) = (self.buffer << 8, self.count - 8);
        }
        // Zeros alone or ones alone are filling. Zeros and ones together are data.
        (self.at, if left == 0 && filling.contains(&0) { 0 } else { left + filling[0] + filling[1] })
    }
}

/// Returns the next marker from `at` on, and where its segment begins. Bytes 0xff may fill the space before it
/// (B.1.1.2).
pub(super) fn next_marker(bytes: &[u8], at: usize) -> Option<(u8, usize)> {
    let rest = bytes.get(at..)?;
    let first = rest.iter().position(|&byte| byte == 0xff)?;
    let code = first + rest[first..].iter().position(|&byte| byte != 0xff)?;
    Some((rest[code], at + code + 1))
}

#[cfg(test)]
mod tests;
