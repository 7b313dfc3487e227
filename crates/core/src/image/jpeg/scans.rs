//! Checks that the scans of a JPEG hold the complete image, by following their codes without decoding texels.
//!
//! Decoders fill missing blocks with grey without an error, as ITU-T T.81 allows. Following the codes counts the blocks
//! that are present. Section and figure numbers are those of T.81.

use crate::image::jpeg::bits::{Bits, Fault, Table, next_marker};
use crate::image::jpeg::damage::Damage;
use crate::image::jpeg::frame::Frame;
use crate::image::jpeg::scan_codes::{Band, ScanCodes};

/// Checks that the scans of a JPEG hold every block of its image. Returns the number of bytes of coefficients that a
/// decoder must keep until the last scan, which is 0 if one scan holds all coefficients.
pub(super) fn check(bytes: &[u8]) -> Result<u64, Damage> {
    const END: u8 = 0xd9;
    let mut reader = Reader { bytes, tables: Default::default(), interval: 0, frame: None, scans: 0 };
    let mut at = 0;
    loop {
        let (marker, body) = next_marker(bytes, at).ok_or(Damage::NoEnd)?;
        // Stuffing, restarts, start of image and TEM carry no segment.
        if matches!(marker, 0x00 | 0x01 | 0xd0..=0xd8) {
            at = body;
            continue;
        }
        if marker == END {
            break;
        }
        let length = bytes.get(body..body + 2).and_then(|length| length.first_chunk()).ok_or(Damage::NoEnd)?;
        at = body + usize::from(u16::from_be_bytes(*length)).max(2);
        let body = bytes.get(body + 2..at).ok_or(Damage::NoEnd)?;
        match marker {
            0xc0..=0xc2 if reader.frame.is_none() => reader.frame = Some(Frame::read(body, marker == 0xc2)?),
            0xc4 => reader.define_tables(body)?,
            0xda => at = reader.scan(body, at)?,
            0xdd => reader.interval = body.first_chunk().map_or(0, |n| u16::from_be_bytes(*n).into()),
            _ => {}
        }
    }
    match reader.frame {
        Some(frame) if !frame.is_complete() => Err(Damage::MissingScans),
        Some(frame) if frame.is_progressive || reader.scans > 1 => Ok(frame.blocks * 64 * size_of::<i16>() as u64),
        Some(_) => Ok(0),
        None => Err(Damage::Malformed("no frame header")),
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    /// By class (DC, AC) and number.
    tables: [[Option<Table>; 4]; 2],
    /// MCUs between restart markers; 0 for none.
    interval: u64,
    frame: Option<Frame>,
    /// Scans that have begun.
    scans: usize,
}

/// The most scans that are followed. Progressive files have about ten scans. A hostile file could have very many scans
/// that cost time and hardly a byte.
const MOST_SCANS: usize = 100;

impl Reader<'_> {
    /// Reads the Huffman tables of a segment (B.2.4.2).
    fn define_tables(&mut self, mut body: &[u8]) -> Result<(), Damage> {
        const BAD: Damage = Damage::Malformed("Huffman table");
        while let Some((&[place, ref counts @ ..], rest)) = body.split_first_chunk::<17>() {
            let count = counts.iter().copied().map(usize::from).sum();
            let (symbols, next) = rest.split_at_checked(count).ok_or(BAD)?;
            let table =
                self.tables.get_mut(usize::from(place >> 4)).and_then(|class| class.get_mut(usize::from(place & 15)));
            *table.ok_or(BAD)? = Some(Table::new(counts, symbols).ok_or(BAD)?);
            body = next;
        }
        Ok(())
    }

    /// Follows the scan with the header `body`, whose data begin at `at`. Returns the end of these data.
    // One function of more than 60 lines, because all its steps borrow the frame, the tables and the members of the
    // scan.
    fn scan(&mut self, body: &[u8], at: usize) -> Result<usize, Damage> {
        const BAD: Damage = Damage::Malformed("scan header");
        self.scans += 1;
        if self.scans > MOST_SCANS {
            return Err(Damage::Malformed("more scans than any encoder writes"));
        }
        let frame = self.frame.as_mut().ok_or(Damage::Malformed("a scan before the frame header"))?;
        let (&count, rest) = body.split_first().ok_or(BAD)?;
        let (listed, rest) = rest.split_at_checked(2 * usize::from(count)).ok_or(BAD)?;
        let &[first, last, bits] = rest.first_chunk().ok_or(BAD)?;
        let band = match frame.is_progressive {
            true => Band { first, last, is_refined: bits >> 4 != 0, lowest: bits & 15 },
            false => Band { first: 0, last: 63, is_refined: false, lowest: 0 },
        };
        // DC alone, or AC of one component (G.1.1.1.1).
        let is_allowed = match band.first {
            0 => band.last == 0 || !frame.is_progressive,
            first => count == 1 && first <= band.last && band.last <= 63,
        };
        let mut members = Vec::new();
        for &[id, tables] in listed.as_chunks::<2>().0 {
            let component = frame.components.iter().position(|component| component.id == id).ok_or(BAD)?;
            members.push((component, usize::from(tables >> 4), usize::from(tables & 15)));
        }
        if !is_allowed || members.is_empty() {
            return Err(BAD);
        }
        let mut walk =
            ScanCodes { bits: Bits::new(self.bytes, at), dc: &self.tables[0], ac: &self.tables[1], band, run: 0 };
        let (across, down) = match members.as_slice() {
            [(only, ..)] => frame.components[*only].own,
            _ => frame.mcus,
        };
        let per_mcu = |&(index, ..): &(usize, usize, usize)| match (members.len(), frame.components[index].sampling) {
            (1, _) => 1,
            (_, (h, v)) => (h * v) as u64,
        };
        let expected = (across * down) as u64 * members.iter().map(per_mcu).sum::<u64>();
        let (scan, mut found) = (self.scans, 0);
        for mcu in 0..across * down {
            if self.interval > 0 && mcu > 0 && (mcu as u64).is_multiple_of(self.interval) {
                walk.restart(self.bytes).map_err(|fault| fault.of(scan, found, expected))?;
            }
            let (x, y) = (mcu % across, mcu / across);
            for &(index, dc, ac) in &members {
                let component = &mut frame.components[index];
                let (h, v) = if members.len() == 1 { (1, 1) } else { component.sampling };
                for place in 0..h * v {
                    let block = (y * v + place / h) * component.stride + x * h + place % h;
                    walk.block(component, block, dc, ac).map_err(|fault| fault.of(scan, found, expected))?;
                    found += 1;
                }
            }
        }
        for (index, ..) in members {
            frame.components[index].send(band.first, band.last, band.lowest);
        }
        match walk.bits.end() {
            // A run of blocks must end with the scan (G.1.2.2).
            _ if walk.run > 0 => Err(Damage::NoCode { scan, block: found }),
            (at, 0) => Ok(at),
            (_, bytes) => Err(Damage::TooLong { scan, bytes }),
        }
    }
}

impl Fault {
    /// Returns the damage that the fault means in `scan` after `found` of `expected` blocks.
    fn of(self, scan: usize, found: u64, expected: u64) -> Damage {
        match self {
            Self::Ended => Damage::Short { scan, found, expected },
            Self::NoCode => Damage::NoCode { scan, block: found },
        }
    }
}
