//! The table of payloads, which other modules ask. Two facts are elsewhere: which formats leave out z
//! (`material/mip_chain.rs`, `select/shown.rs`), and how `check` bounds each rounding (`check/storage.rs`).

use std::num::NonZeroU8;

use ktx2::dfd::{Basic, ChannelTypeQualifiers, DataFormatFlags, SampleInformation};
use ktx2::{ColorModel, TransferFunction};

use crate::codec::encode::{bc, half, uastc_blocks};
use crate::codec::error::EncodeError;
use crate::codec::format::{PayloadFormat, Target};
use crate::codec::quantise::Texels;
use crate::codec::uastc::{Effort, Metric};

/// Encodes one level.
type Encode = fn(&Texels<'_>, PayloadFormat, Metric, Effort) -> Result<Vec<u8>, EncodeError>;

/// The facts of a format.
pub struct Codec {
    /// The format.
    pub format: PayloadFormat,
    /// The target that it belongs to.
    pub target: Target,
    /// Most channels of texels that the target stores in it.
    pub channels: u32,
    /// How a KTX2 file names it.
    pub identity: Identity,
    /// Columns and rows of a texel block; 1 if there are no blocks.
    pub block_edge: u32,
    /// Bytes of a block, or of a texel if there are no blocks.
    pub block_bytes: usize,
    /// Whether values are quantised to [0, 1] before encoding; others are stored as floats.
    pub is_normalised: bool,
    /// Whether levels are compressed with zstd.
    pub is_supercompressed: bool,
    /// How far decoded values may lie from the encoded ones.
    pub rounding: Rounding,
    encode: Encode,
}

/// How a KTX2 file names a format.
#[derive(Clone, Copy)]
pub enum Identity {
    /// By the format of Vulkan, from which the data format descriptor follows.
    Vulkan(ktx2::Format),
    /// By the data format descriptor alone: loaders transcode the payload.
    Transcodable(fn() -> Basic),
}

/// Which rounding a format has; `check` has the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// Endpoints and weights by the mode of each UASTC block.
    Uastc,
    /// Endpoints by the mode of each BC7 block; all channels share one weight.
    Bc7,
    /// Eight weights for every channel of a block: BC4 and BC5.
    SeparateChannels,
    /// Half floats: a share of the value.
    Float,
}

/// All formats. Those of a target are in the order of their channels.
static TABLE: [Codec; 7] = [
    Codec {
        format: PayloadFormat::UastcRgb,
        target: Target::Basis,
        channels: 3,
        identity: Identity::Transcodable(uastc_rgb),
        block_edge: 4,
        block_bytes: 16,
        is_normalised: true,
        is_supercompressed: true,
        rounding: Rounding::Uastc,
        encode: uastc_blocks,
    },
    bc_row(PayloadFormat::Bc4, 1, ktx2::Format::BC4_UNORM_BLOCK, 8, Rounding::SeparateChannels),
    bc_row(PayloadFormat::Bc5, 2, ktx2::Format::BC5_UNORM_BLOCK, 16, Rounding::SeparateChannels),
    bc_row(PayloadFormat::Bc7, 3, ktx2::Format::BC7_UNORM_BLOCK, 16, Rounding::Bc7),
    float_row(PayloadFormat::R16Float, 1, ktx2::Format::R16_SFLOAT, 2, half::<1>),
    float_row(PayloadFormat::Rg16Float, 2, ktx2::Format::R16G16_SFLOAT, 4, half::<2>),
    float_row(PayloadFormat::Rgba16Float, 3, ktx2::Format::R16G16B16A16_SFLOAT, 8, half::<4>),
];

/// Returns the row of a format of [`Target::Bc`].
const fn bc_row(
    format: PayloadFormat,
    channels: u32,
    vulkan: ktx2::Format,
    block_bytes: usize,
    rounding: Rounding,
) -> Codec {
    Codec {
        format,
        target: Target::Bc,
        channels,
        identity: Identity::Vulkan(vulkan),
        block_edge: 4,
        block_bytes,
        is_normalised: true,
        is_supercompressed: false,
        rounding,
        encode: bc,
    }
}

/// Returns the row of a format of [`Target::Float`].
const fn float_row(
    format: PayloadFormat,
    channels: u32,
    vulkan: ktx2::Format,
    block_bytes: usize,
    encode: Encode,
) -> Codec {
    Codec {
        format,
        target: Target::Float,
        channels,
        identity: Identity::Vulkan(vulkan),
        block_edge: 1,
        block_bytes,
        is_normalised: false,
        is_supercompressed: false,
        rounding: Rounding::Float,
        encode,
    }
}

/// Returns the data format descriptor of opaque UASTC (Khronos Data Format Specification 1.3, UASTC): one sample of 128
/// bits, of which channel 0 is RGB. The plane keeps its size under supercompression since KTX 2.0.4.
fn uastc_rgb() -> Basic {
    let four = NonZeroU8::MIN.saturating_add(3);
    Basic {
        color_model: Some(ColorModel::UASTC),
        color_primaries: None,
        transfer_function: Some(TransferFunction::Linear),
        flags: DataFormatFlags::STRAIGHT_ALPHA,
        texel_block_dimensions: [four, four, NonZeroU8::MIN, NonZeroU8::MIN],
        bytes_planes: [16, 0, 0, 0, 0, 0, 0, 0],
        sample_information: vec![SampleInformation {
            bit_offset: 0,
            bit_length: NonZeroU8::MIN.saturating_add(127),
            channel_type: 0,
            channel_type_qualifiers: ChannelTypeQualifiers::empty(),
            sample_positions: [0; 4],
            lower: 0,
            upper: u32::MAX,
        }],
    }
}

impl Target {
    /// Returns the format for texels of `channels` (1 to 3) channels.
    pub fn format(self, channels: u32) -> PayloadFormat {
        let mut rows = TABLE.iter().filter(|codec| codec.target == self);
        // A test holds that every target has a format for 1 to 3 channels.
        rows.find(|codec| codec.channels >= channels).map_or(PayloadFormat::UastcRgb, |codec| codec.format)
    }

    /// Checks that this build can encode the target.
    ///
    /// # Errors
    /// [`EncodeError::WithoutBc`] for `bc` without the feature.
    pub fn check_available(self) -> Result<(), EncodeError> {
        if self == Self::Bc && !cfg!(feature = "bc") { Err(EncodeError::WithoutBc) } else { Ok(()) }
    }
}

impl Codec {
    /// Returns the facts of the format that a KTX2 file names, if it is one that Roughcast writes. `format` is the
    /// Vulkan format of the header, and `model` the colour model of the descriptor.
    pub fn of_file(format: Option<ktx2::Format>, model: Option<ColorModel>) -> Option<&'static Self> {
        TABLE.iter().find(|codec| match codec.identity {
            Identity::Vulkan(vulkan) => format == Some(vulkan),
            Identity::Transcodable(descriptor) => format.is_none() && model == descriptor().color_model,
        })
    }
}

impl PayloadFormat {
    /// Returns the facts of the format.
    pub fn codec(self) -> &'static Codec {
        // A test holds that every format has a row.
        TABLE.iter().find(|codec| codec.format == self).unwrap_or(&TABLE[0])
    }

    /// Returns the Vulkan format; `None` for formats that are transcoded.
    pub fn vulkan(self) -> Option<ktx2::Format> {
        match self.codec().identity {
            Identity::Vulkan(format) => Some(format),
            Identity::Transcodable(_) => None,
        }
    }

    /// Returns the bytes of a block, or of a texel if there are no blocks.
    pub fn block_bytes(self) -> usize {
        self.codec().block_bytes
    }

    /// Returns whether texels are stored in blocks of 4x4.
    pub fn is_block(self) -> bool {
        self.codec().block_edge > 1
    }

    /// Returns whether values are quantised to [0, 1] before encoding.
    pub fn is_normalised(self) -> bool {
        self.codec().is_normalised
    }

    /// Returns the bytes of a level of `width` x `height` texels.
    pub fn level_bytes(self, width: u32, height: u32) -> usize {
        let Codec { block_edge, block_bytes, .. } = *self.codec();
        width.div_ceil(block_edge) as usize * height.div_ceil(block_edge) as usize * block_bytes
    }
}

/// Returns the bytes of one level, not supercompressed. UASTC is fitted by `metric`; other encoders do not know
/// metrics.
///
/// # Errors
///
/// [`EncodeError`] for block formats whose encoder is missing or fails, and for values that half floats cannot
/// represent.
pub fn encode(
    texels: &Texels<'_>,
    format: PayloadFormat,
    metric: Metric,
    effort: Effort,
) -> Result<Vec<u8>, EncodeError> {
    (format.codec().encode)(texels, format, metric, effort)
}

#[cfg(test)]
mod tests;
