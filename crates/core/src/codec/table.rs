//! The table of payloads: one row has all facts of a format except its decoder, which is in `ktx2`: `basis.rs` (UASTC),
//! `blocks.rs` (BC1 to BC7) or `uncompressed.rs` (floats).

use std::num::NonZeroU8;

use ktx2::dfd::{Basic, ChannelTypeQualifiers, DataFormatFlags, SampleInformation};
use ktx2::{ColorModel, ColorPrimaries, TransferFunction};

use crate::codec::encode::{bc, half, lower_rate, uastc_blocks};
use crate::codec::error::EncodeError;
use crate::codec::format::{PayloadFormat, Target};
use crate::codec::quantise::Texels;
use crate::codec::rounding::Rounding;
use crate::codec::uastc::{Effort, Metric};

/// Encodes one level.
type Encode = fn(&Texels<'_>, PayloadFormat, Metric, Effort) -> Result<Vec<u8>, EncodeError>;

/// Rewrites encoded blocks so that zstd makes them smaller. The last argument is the loss that is allowed, in dB.
type LowerRate = fn(&mut [u8], &Texels<'_>, Metric, f64) -> Result<(), EncodeError>;

/// The facts of a format.
pub struct Codec {
    /// The format.
    pub format: PayloadFormat,
    /// The target that it belongs to.
    pub target: Target,
    /// The largest number of channels that the target stores in this format.
    pub channels: u32,
    /// Whether the target stores normals in it: x, y and z or, in a format of two channels, x and y. Readers rebuild z
    /// from x and y.
    pub holds_normals: bool,
    /// How a KTX2 file names it.
    pub identity: Identity,
    /// Whether values are sRGB colours, whose alpha is linear.
    pub is_srgb: bool,
    /// The Vulkan format of the same blocks with sRGB colours, which other writers use.
    pub srgb: Option<ktx2::Format>,
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
    /// Rewrites blocks for `--rdo`; `None` if `--rdo` does not change the format.
    pub lower_rate: Option<LowerRate>,
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

/// All formats. Those of a target are in the order of their channels.
static TABLE: [Codec; 9] = [
    UASTC,
    Codec {
        format: PayloadFormat::UastcSrgb,
        holds_normals: false,
        is_srgb: true,
        identity: Identity::Transcodable(uastc_srgb),
        ..UASTC
    },
    Codec {
        format: PayloadFormat::UastcSrgbAlpha,
        channels: 4,
        holds_normals: false,
        is_srgb: true,
        identity: Identity::Transcodable(uastc_srgb_alpha),
        ..UASTC
    },
    Codec {
        format: PayloadFormat::Bc4,
        channels: 1,
        identity: Identity::Vulkan(ktx2::Format::BC4_UNORM_BLOCK),
        srgb: None,
        block_bytes: 8,
        rounding: Rounding::BC4,
        ..BC
    },
    Codec {
        format: PayloadFormat::Bc5,
        channels: 2,
        holds_normals: true,
        identity: Identity::Vulkan(ktx2::Format::BC5_UNORM_BLOCK),
        srgb: None,
        rounding: Rounding::BC4,
        ..BC
    },
    BC,
    Codec {
        format: PayloadFormat::R16Float,
        channels: 1,
        holds_normals: false,
        identity: Identity::Vulkan(ktx2::Format::R16_SFLOAT),
        block_bytes: 2,
        encode: half::<1>,
        ..FLOAT
    },
    Codec {
        format: PayloadFormat::Rg16Float,
        channels: 2,
        holds_normals: false,
        identity: Identity::Vulkan(ktx2::Format::R16G16_SFLOAT),
        block_bytes: 4,
        encode: half::<2>,
        ..FLOAT
    },
    FLOAT,
];

/// Opaque UASTC, with the facts that all formats of [`Target::Basis`] share.
const UASTC: Codec = Codec {
    format: PayloadFormat::UastcRgb,
    target: Target::Basis,
    channels: 3,
    holds_normals: true,
    identity: Identity::Transcodable(uastc_rgb),
    is_srgb: false,
    srgb: None,
    block_edge: 4,
    block_bytes: 16,
    is_normalised: true,
    is_supercompressed: true,
    rounding: Rounding::UASTC,
    lower_rate: Some(lower_rate),
    encode: uastc_blocks,
};

/// BC7, with the facts that all formats of [`Target::Bc`] share.
const BC: Codec = Codec {
    format: PayloadFormat::Bc7,
    target: Target::Bc,
    channels: 3,
    holds_normals: false,
    identity: Identity::Vulkan(ktx2::Format::BC7_UNORM_BLOCK),
    is_srgb: false,
    srgb: Some(ktx2::Format::BC7_SRGB_BLOCK),
    block_edge: 4,
    block_bytes: 16,
    is_normalised: true,
    is_supercompressed: false,
    rounding: Rounding::BC7,
    lower_rate: None,
    encode: bc,
};

/// Four half floats, with the facts that all formats of [`Target::Float`] share.
const FLOAT: Codec = Codec {
    format: PayloadFormat::Rgba16Float,
    target: Target::Float,
    channels: 3,
    holds_normals: true,
    identity: Identity::Vulkan(ktx2::Format::R16G16B16A16_SFLOAT),
    is_srgb: false,
    srgb: None,
    block_edge: 1,
    block_bytes: 8,
    is_normalised: false,
    is_supercompressed: false,
    rounding: Rounding::Floats,
    lower_rate: None,
    encode: half::<4>,
};

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

/// Returns the descriptor of opaque sRGB colours in UASTC.
fn uastc_srgb() -> Basic {
    Basic {
        color_primaries: Some(ColorPrimaries::BT709),
        transfer_function: Some(TransferFunction::SRGB),
        ..uastc_rgb()
    }
}

/// Returns the descriptor of sRGB colours with alpha in UASTC: channel 3 is RGBA.
fn uastc_srgb_alpha() -> Basic {
    let mut basic = uastc_srgb();
    basic.sample_information.iter_mut().for_each(|sample| sample.channel_type = 3);
    basic
}

impl Target {
    /// Returns the format for texels of `channels` (1 to 3) channels.
    pub fn format(self, channels: u32) -> PayloadFormat {
        let mut rows = TABLE.iter().filter(|codec| codec.target == self);
        // A test holds that every target has a format for 1 to 3 channels.
        rows.find(|codec| codec.channels >= channels).map_or(PayloadFormat::UastcRgb, |codec| codec.format)
    }

    /// Returns the format for sRGB colours, with or without alpha; `None` if the target has none.
    pub fn colour_format(self, has_alpha: bool) -> Option<PayloadFormat> {
        let channels = if has_alpha { 4 } else { 3 };
        let is_it = |codec: &&Codec| codec.target == self && codec.is_srgb && codec.channels == channels;
        TABLE.iter().find(is_it).map(|codec| codec.format)
    }

    /// Returns the format for normals.
    pub fn normal_format(self) -> PayloadFormat {
        let row = TABLE.iter().find(|codec| codec.target == self && codec.holds_normals);
        // A test holds that every target has a format for normals.
        row.map_or(PayloadFormat::UastcRgb, |codec| codec.format)
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
    /// Returns the facts of all formats.
    pub fn all() -> &'static [Self] {
        &TABLE
    }

    /// Returns the facts of the format that a KTX2 file names, if it is one that Roughcast writes, or its sRGB form.
    /// `format` is the Vulkan format of the header, and `model` the colour model of the descriptor. All formats of
    /// UASTC round alike, so the first of them stands for all.
    pub fn of_file(format: Option<ktx2::Format>, model: Option<ColorModel>) -> Option<&'static Self> {
        TABLE.iter().find(|codec| match codec.identity {
            Identity::Vulkan(vulkan) => format.is_some() && (format == Some(vulkan) || format == codec.srgb),
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

    /// Returns whether texels have alpha.
    pub fn has_alpha(self) -> bool {
        self.codec().channels > 3
    }

    /// Returns whether normals in this format have a z. Readers of formats with two channels rebuild z.
    pub fn has_z(self) -> bool {
        self.codec().channels > 2
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
