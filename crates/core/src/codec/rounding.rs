//! How far decoded values may lie from encoded ones, by format. The checker derives its bounds from these facts.

/// The number of levels that the endpoints of a block can have, by the bytes of the block.
pub type EndpointLevels = fn(&[u8; 16]) -> f64;

/// How a format rounds values.
#[derive(Clone, Copy, Debug)]
pub enum Rounding {
    /// Blocks of 4x4 texels: endpoints are rounded, and texels are rounded to colours between the endpoints.
    Blocks {
        /// How endpoints are rounded.
        endpoints: Endpoints,
        /// How the colours between the endpoints are chosen.
        weights: Weights,
    },
    /// Integers: the error is a share of the range.
    Integers,
    /// Floats: the error is a share of the value.
    Floats,
}

/// How the endpoints of blocks are rounded.
#[derive(Clone, Copy, Debug)]
pub enum Endpoints {
    /// The mode of each block of 16 bytes gives the number of levels.
    ByMode(EndpointLevels),
    /// All blocks have this number of levels.
    Levels(f64),
}

/// How weights choose colours between two endpoints.
#[derive(Clone, Copy, Debug)]
pub enum Weights {
    /// Every channel has its own weights.
    Separate {
        /// Steps between the endpoints: one less than a weight has values.
        steps: f64,
    },
    /// Two planes of weights: one for the channel that varies most, and one for all other channels.
    TwoPlanes {
        /// Steps between the endpoints: one less than a weight has values.
        steps: f64,
    },
    /// All channels share one weight.
    Shared,
}

impl Rounding {
    /// UASTC (Basis Universal, "UASTC LDR 4x4 Texture Specification", mode 6): two planes of four weights.
    pub(super) const UASTC: Self =
        Self::Blocks { endpoints: Endpoints::ByMode(uastc_levels), weights: Weights::TwoPlanes { steps: 3.0 } };

    /// BC4 and BC5 (Khronos Data Format 1.3, chapter 20): endpoints of 8 bits, and eight weights for every channel.
    pub(super) const BC4: Self =
        Self::Blocks { endpoints: Endpoints::Levels(256.0), weights: Weights::Separate { steps: 7.0 } };

    /// BC7: three channels share one weight.
    pub(super) const BC7: Self = Self::Blocks { endpoints: Endpoints::ByMode(bc7_levels), weights: Weights::Shared };
}

/// Returns the number of endpoint levels of a UASTC block. A prefix code of two to seven bits gives the block's mode.
/// Blocks of one colour store that colour with 8 bits.
fn uastc_levels(block: &[u8; 16]) -> f64 {
    /// Code, its length in bits, and levels of each mode, in the order of the modes (specification, "Block modes").
    const MODES: [(u8, u32, u32); 19] = [
        (0x01, 4, 192),
        (0x35, 6, 256),
        (0x1d, 5, 16),
        (0x03, 5, 12),
        (0x13, 5, 40),
        (0x0b, 5, 256),
        (0x1b, 5, 160),
        (0x07, 5, 12),
        (0x17, 5, 256),
        (0x0f, 5, 16),
        (0x02, 3, 48),
        (0x00, 2, 48),
        (0x06, 3, 192),
        (0x1f, 5, 256),
        (0x0d, 5, 256),
        (0x05, 7, 256),
        (0x15, 6, 256),
        (0x25, 6, 256),
        (0x09, 4, 32),
    ];
    let mode = MODES.iter().find(|(code, length, _)| block[0] & ((1 << length) - 1) as u8 == *code);
    f64::from(mode.map_or(12, |(.., levels)| *levels))
}

/// Returns the number of endpoint levels of a BC7 block. Its mode is the number of zero bits before the first one bit
/// (Khronos Data Format 1.3, table 117; the bits of the colours plus the bit that endpoints share).
fn bc7_levels(block: &[u8; 16]) -> f64 {
    const BITS: [u32; 8] = [5, 7, 5, 8, 5, 7, 8, 6];
    let bits = BITS.get(block[0].trailing_zeros() as usize).copied().unwrap_or(5);
    f64::from(1_u32 << bits)
}
