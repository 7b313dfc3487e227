//! Follows the codes of one scan, block by block (ITU-T T.81, F.2.2 and G.2). Figure numbers are those of T.81.

use crate::image::jpeg::bits::{Bits, Fault, Table, next_marker};
use crate::image::jpeg::frame::Component;

/// The coefficients that a scan sends (B.2.3).
#[derive(Clone, Copy)]
pub(super) struct Band {
    /// The first coefficient.
    pub first: u8,
    /// The last one.
    pub last: u8,
    /// Whether earlier scans have sent higher bits.
    pub is_refined: bool,
    /// The lowest bit that is sent.
    pub lowest: u8,
}

/// The state of following one scan.
pub(super) struct ScanCodes<'a> {
    /// The remaining data of the scan.
    pub bits: Bits<'a>,
    /// Huffman tables of DC coefficients, by their numbers.
    pub dc: &'a [Option<Table>; 4],
    /// Huffman tables of AC coefficients, by their numbers.
    pub ac: &'a [Option<Table>; 4],
    /// Which coefficients the scan sends.
    pub band: Band,
    /// Blocks that still belong to a run without new coefficients (EOBRUN, G.1.2.2).
    pub run: u32,
}

fn table(tables: &[Option<Table>; 4], number: usize) -> Result<&Table, Fault> {
    tables.get(number).and_then(Option::as_ref).ok_or(Fault::NoCode)
}

impl<'a> ScanCodes<'a> {
    /// Skips a restart marker and the filling before it.
    pub(super) fn restart(&mut self, bytes: &'a [u8]) -> Result<(), Fault> {
        let (at, left) = self.bits.end();
        if left > 0 || self.run > 0 {
            return Err(Fault::NoCode);
        }
        let (marker, next) = next_marker(bytes, at).ok_or(Fault::Ended)?;
        if !matches!(marker, 0xd0..=0xd7) {
            return Err(Fault::Ended);
        }
        (self.bits, self.run) = (Bits::new(bytes, next), 0);
        Ok(())
    }

    pub(super) fn block(&mut self, component: &mut Component, block: usize, dc: usize, ac: usize) -> Result<(), Fault> {
        let Band { first, last, is_refined, .. } = self.band;
        if first == 0 {
            if is_refined {
                return self.bits.skip(1);
            }
            let length = self.bits.symbol(table(self.dc, dc)?)?;
            self.value(length)?;
            if last == 0 {
                return Ok(());
            }
            return self.coefficients(table(self.ac, ac)?);
        }
        let nonzero = component.nonzero.get_mut(block).ok_or(Fault::NoCode)?;
        let table = table(self.ac, ac)?;
        if is_refined { self.refined(table, nonzero) } else { self.first_bits(table, nonzero) }
    }

    /// Skips a value of `length` bits.
    fn value(&mut self, length: u8) -> Result<(), Fault> {
        if length > 15 { Err(Fault::NoCode) } else { self.bits.skip(length.into()) }
    }

    /// Skips the AC coefficients of a sequential block (figure F.13).
    fn coefficients(&mut self, table: &Table) -> Result<(), Fault> {
        let mut k = 1;
        while k < 64 {
            let symbol = self.bits.symbol(table)?;
            match (symbol >> 4, symbol & 15) {
                (15, 0) => k += 16,
                (_, 0) => break,
                (zeros, length) => {
                    k += u32::from(zeros) + 1;
                    if k > 64 {
                        return Err(Fault::NoCode);
                    }
                    self.value(length)?;
                }
            }
        }
        Ok(())
    }

    /// Skips the first bits of AC coefficients of a progressive block (figure G.3).
    fn first_bits(&mut self, table: &Table, nonzero: &mut u64) -> Result<(), Fault> {
        if self.run > 0 {
            self.run -= 1;
            return Ok(());
        }
        let mut k = self.band.first;
        while k <= self.band.last {
            let symbol = self.bits.symbol(table)?;
            match (symbol >> 4, symbol & 15) {
                (15, 0) => k += 16,
                (length, 0) => {
                    self.run = self.run_of(length)? - 1;
                    break;
                }
                (zeros, length) => {
                    k += zeros;
                    if k > self.band.last {
                        return Err(Fault::NoCode);
                    }
                    self.value(length)?;
                    *nonzero |= 1 << k;
                    k += 1;
                }
            }
        }
        Ok(())
    }

    /// Returns the number of blocks without new coefficients, including the current block.
    fn run_of(&mut self, length: u8) -> Result<u32, Fault> {
        Ok((1 << length) + self.bits.number(length.into())?)
    }

    /// Skips one more bit of AC coefficients (figure G.7). Each coefficient that is not 0 has such a bit, also where
    /// coefficients are skipped.
    fn refined(&mut self, table: &Table, nonzero: &mut u64) -> Result<(), Fault> {
        let Band { first, last, .. } = self.band;
        let mut k = first;
        while self.run == 0 && k <= last {
            let symbol = self.bits.symbol(table)?;
            let (mut zeros, length) = (symbol >> 4, symbol & 15);
            match (zeros, length) {
                (15, 0) => {}
                (length, 0) => {
                    self.run = self.run_of(length)?;
                    break;
                }
                (_, 1) => self.bits.skip(1)?,
                _ => return Err(Fault::NoCode),
            }
            while k <= last {
                if *nonzero >> k & 1 == 1 {
                    self.bits.skip(1)?;
                } else if zeros == 0 {
                    break;
                } else {
                    zeros -= 1;
                }
                k += 1;
            }
            if length == 1 {
                if k > last {
                    return Err(Fault::NoCode);
                }
                *nonzero |= 1 << k;
            }
            k += 1;
        }
        if self.run > 0 {
            let rest = (!0 << k) & (!0 >> (63 - last));
            self.bits.skip((*nonzero & rest).count_ones())?;
            self.run -= 1;
        }
        Ok(())
    }
}
