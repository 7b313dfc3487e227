//! What may be wrong with the scans of a JPEG.

use crate::memory::OutOfMemory;

/// Why the scans do not hold the image.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(super) enum Damage {
    /// No end-of-image marker.
    #[error("no end-of-image marker")]
    NoEnd,
    /// A scan ends before its last block.
    #[error("the data of scan {scan} ends after {found} of {expected} blocks")]
    Short { scan: usize, found: u64, expected: u64 },
    /// Scans are missing.
    #[error("scans are missing at the end")]
    MissingScans,
    /// Bits that no encoder writes.
    #[error("no code at block {block} of scan {scan}")]
    NoCode { scan: usize, block: u64 },
    /// More data than blocks.
    #[error("{bytes} bytes of data too many in scan {scan}")]
    TooLong { scan: usize, bytes: usize },
    /// A segment that breaks the rules.
    #[error("{0}")]
    Malformed(&'static str),
    /// The notes on coefficients do not fit into memory.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

impl Damage {
    /// Whether the end of the file, or of what was kept of it, explains the damage.
    pub(super) fn is_cut(&self) -> bool {
        matches!(self, Self::NoEnd | Self::Short { .. } | Self::MissingScans)
    }
}
