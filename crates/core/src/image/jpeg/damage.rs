//! Damage that is found in the scans of a JPEG.

use crate::memory::OutOfMemory;

/// Why the scans do not hold the complete image.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(super) enum Damage {
    /// The end-of-image marker is missing.
    #[error("no end-of-image marker")]
    NoEnd,
    /// A scan ends before its last block.
    #[error("the data of scan {scan} ends after {found} of {expected} blocks")]
    Short { scan: usize, found: u64, expected: u64 },
    /// Scans are missing.
    #[error("scans are missing at the end")]
    MissingScans,
    /// A scan contains bits that are not a valid code.
    #[error("no code at block {block} of scan {scan}")]
    NoCode { scan: usize, block: u64 },
    /// A scan has more data than its blocks need.
    #[error("{bytes} bytes of data too many in scan {scan}")]
    TooLong { scan: usize, bytes: usize },
    /// A segment is malformed.
    #[error("{0}")]
    Malformed(&'static str),
    /// The record of received coefficients does not fit into memory.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

impl Damage {
    /// Returns whether a file that was cut off explains the damage.
    pub(super) fn is_cut(&self) -> bool {
        matches!(self, Self::NoEnd | Self::Short { .. } | Self::MissingScans)
    }
}
