//! The bits of an entropy-coded segment and the Huffman codes in them (ITU-T T.81, C.2 and F.2.2).

/// Why a segment cannot be followed further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The segment ends where more bits are needed.
    Ended,
    /// The bits are no code, or a code that must not come there.
    NoCode,
}

/// Longest code that is looked up at once: nearly all codes of photographs are as short.
const LOOKAHEAD: u32 = 9;

/// A Huffman table.
pub(super) struct Table {
    /// By the next [`LOOKAHEAD`] bits: the symbol and the length of its code, which is 0 where the code is longer.
    short: Vec<(u8, u8)>,
    /// By length, one more than the last code of it.
    ends: [u32; 17],
    /// By length, what is added to a code of it to find its symbol.
    offsets: [i32; 17],
    symbols: Vec<u8>,
}

impl Table {
    /// Builds the table from the number of codes of each length and the symbols in the order of their codes. `None` when there
    /// are more codes than their lengths allow.
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

/// Reads the bits of the segment that begins at a place of a file. It ends at the next marker.
pub(super) struct Bits<'a> {
    bytes: &'a [u8],
    /// Where the next byte is read.
    at: usize,
    /// Bits that are read but not used, the next one at the top.
    buffer: u64,
    count: u32,
}

impl<'a> Bits<'a> {
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at, buffer: 0, count: 0 }
    }

    /// The next byte without its stuffing, and how many bytes it takes in the file (T.81, B.1.1.5).
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

    /// Passes over `count` bits.
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

    /// Ends the segment: returns where the next marker is, and how many whole bytes were not used that are no filling.
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
        // A row of zeros or of ones is filling; both together are data.
        (self.at, if left == 0 && filling.contains(&0) { 0 } else { left + filling[0] + filling[1] })
    }
}

/// Returns the next marker from `at` on, and where its segment begins. Bytes 0xff may fill the space before it (B.1.1.2).
pub(super) fn next_marker(bytes: &[u8], at: usize) -> Option<(u8, usize)> {
    let rest = bytes.get(at..)?;
    let first = rest.iter().position(|&byte| byte == 0xff)?;
    let code = first + rest[first..].iter().position(|&byte| byte != 0xff)?;
    Some((rest[code], at + code + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Codes 0, 10, 110 and a code of 12 bits, 1110 0000 0000.
    fn table() -> Table {
        let mut counts = [0; 16];
        (counts[0], counts[1], counts[2], counts[11]) = (1, 1, 1, 1);
        Table::new(&counts, &[5, 6, 7, 8]).unwrap()
    }

    #[test]
    fn codes_of_every_length_are_found() {
        // 0 10 110 1110_0000_0000, then 0 and seven ones.
        let bytes = [0b0101_1011, 0b1000_0000, 0b0001_1111, 0b1100_0000];
        let mut bits = Bits::new(&bytes, 0);
        let table = table();
        assert_eq!([5, 6, 7, 8, 5].map(Ok), std::array::from_fn(|_| bits.symbol(&table)));
        assert_eq!(bits.symbol(&table), Err(Fault::Ended));
        assert_eq!(Bits::new(&[0xfe; 4], 0).symbol(&table), Err(Fault::NoCode));
    }

    #[test]
    fn stuffing_is_left_out_and_markers_end_the_bits() {
        let bytes = [0xab, 0xff, 0x00, 0xcd, 0xff, 0xd9, 0x12];
        let mut bits = Bits::new(&bytes, 0);
        assert_eq!(bits.number(16), Ok(0xabff));
        assert_eq!(bits.number(8), Ok(0xcd));
        assert_eq!(bits.number(1), Err(Fault::Ended));
        let mut bits = Bits::new(&bytes, 0);
        assert_eq!(bits.skip(24), Ok(()));
        assert_eq!(bits.skip(1), Err(Fault::Ended));
        assert_eq!(bits.end(), (4, 0));
    }

    #[test]
    fn what_is_left_is_counted_unless_it_is_filling() {
        for (bytes, left) in [
            (&[0x7f, 0xff, 0xd9][..], 0),
            (&[0x7f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xd9], 0),
            (&[0x7f, 0xff, 0, 0xff, 0, 0xff, 0xd9], 0),
            (&[0x7f, 0x12, 0x34, 0xff, 0xd9], 2),
            (&[0x7f, 0xff, 0, 0, 0xff, 0xd9], 2),
        ] {
            let mut bits = Bits::new(bytes, 0);
            bits.skip(3).unwrap();
            assert_eq!(bits.end(), (bytes.len() - 2, left), "{bytes:02x?}");
        }
    }

    #[test]
    fn more_codes_than_their_lengths_allow_are_refused() {
        let mut counts = [0; 16];
        counts[0] = 3;
        assert!(Table::new(&counts, &[1, 2, 3]).is_none());
        counts = [255; 16];
        assert!(Table::new(&counts, &[0; 255 * 16]).is_none());
        counts = [0; 16];
        counts[3] = 2;
        assert!(Table::new(&counts, &[1]).is_none());
    }
}
