//! How Vulkan formats and the colour models of Basis Universal are decoded.

use ktx2::{ColorModel, Format, dfd};

use crate::ktx2::blocks::{self, BlockFormat};

/// A texel block: its size in texels and in bytes.
pub(super) struct Block {
    pub width: u32,
    pub height: u32,
    pub bytes: u64,
}

/// How a format that can be decoded stores its texels.
pub(super) enum Coding {
    /// Each texel by itself.
    Texels(Texel),
    /// Blocks of 4 x 4.
    Blocks(&'static BlockFormat),
    /// Basis Universal UASTC LDR, with the channels to keep.
    Uastc(&'static [usize]),
    /// Basis Universal ETC1S, with the channels to keep.
    Etc1s(&'static [usize]),
}

/// A format without blocks.
pub(super) struct Texel {
    pub channels: u32,
    pub values: Values,
    /// Whether blue precedes red.
    pub blue_first: bool,
}

/// How the values of a texel are stored. Signed, half and packed values are decoded to floats.
#[derive(Clone, Copy)]
pub(super) enum Values {
    Unorm8,
    Snorm8,
    Unorm16,
    Snorm16,
    Half,
    Float,
    /// `E5B9G9R9`: three 9-bit mantissas and an exponent in 32 bits.
    SharedExponent,
    /// `B10G11R11`: three small floats in 32 bits.
    PackedFloat,
}

impl Texel {
    fn bytes(&self) -> u64 {
        let channels = u64::from(self.channels);
        match self.values {
            Values::Unorm8 | Values::Snorm8 => channels,
            Values::Unorm16 | Values::Snorm16 | Values::Half => channels * 2,
            Values::Float => channels * 4,
            Values::SharedExponent | Values::PackedFloat => 4,
        }
    }
}

impl Coding {
    /// Returns the coding of a Vulkan format or, without a format, of the descriptor's colour model.
    pub(super) fn of(format: Option<Format>, basic: Option<&dfd::Basic>) -> Option<Coding> {
        match format {
            Some(format) => of_vulkan(format),
            None => of_model(basic?),
        }
    }

    /// Returns the most bytes that a level of `width` x `height` texels takes while it is decoded, without its payload.
    pub(super) fn decoded_bytes(&self, width: u32, height: u32) -> u64 {
        let texel_bytes = match self {
            Coding::Texels(Texel { channels, values: Values::Unorm8, .. }) => u64::from(*channels),
            Coding::Texels(Texel { channels, values: Values::Unorm16, .. }) => 2 * u64::from(*channels),
            Coding::Texels(texel) => 4 * u64::from(texel.channels),
            Coding::Blocks(format) => format.channel_bytes * format.channels as u64,
            Coding::Uastc(channels) => channels.len() as u64,
            // The transcoder's four channels and the kept channels.
            Coding::Etc1s(channels) => 4 + channels.len() as u64,
        };
        u64::from(width) * u64::from(height) * texel_bytes
    }

    pub(super) fn channels(&self) -> u32 {
        match self {
            Coding::Texels(texel) => texel.channels,
            Coding::Blocks(format) => format.channels as u32,
            Coding::Uastc(channels) | Coding::Etc1s(channels) => channels.len() as u32,
        }
    }
}

/// Returns the texel block of a file: by definition for formats that are decoded, from the descriptor for all others.
/// Older writers set `bytesPlane0` to 0 under supercompression; the size is then taken from the samples.
pub(super) fn block_of(format: Option<Format>, basic: Option<&dfd::Basic>) -> Option<Block> {
    let block = |edge: u32, bytes: u64| Block { width: edge, height: edge, bytes };
    match Coding::of(format, basic) {
        Some(Coding::Texels(texel)) => Some(block(1, texel.bytes())),
        Some(Coding::Blocks(format)) => Some(block(4, format.bytes as u64)),
        Some(Coding::Uastc(_)) => Some(block(4, 16)),
        Some(Coding::Etc1s(_)) | None => {
            let basic = basic?;
            let bits = basic.sample_information.iter();
            let bits = bits.map(|s| u64::from(s.bit_offset) + u64::from(s.bit_length.get()));
            let bytes = match basic.bytes_planes[0] {
                0 => bits.max().unwrap_or(0).div_ceil(8),
                bytes => bytes.into(),
            };
            let [width, height, ..] = basic.texel_block_dimensions;
            (bytes > 0).then(|| Block { width: u32::from(width.get()), height: u32::from(height.get()), bytes })
        }
    }
}

/// Maps the channel identifiers of Basis Universal to codings (Khronos Data Format 1.3, sections 5.6.13 and 5.6.14).
fn of_model(basic: &dfd::Basic) -> Option<Coding> {
    let channels: Vec<u8> = basic.sample_information.iter().map(|sample| sample.channel_type).collect();
    match (basic.color_model?, channels.as_slice()) {
        (ColorModel::UASTC, [0]) => Some(Coding::Uastc(&[0, 1, 2])),
        (ColorModel::UASTC, [3]) => Some(Coding::Uastc(&[0, 1, 2, 3])),
        (ColorModel::UASTC, [4]) => Some(Coding::Uastc(&[0])),
        (ColorModel::UASTC, [5]) => Some(Coding::Uastc(&[0, 3])),
        (ColorModel::UASTC, [6]) => Some(Coding::Uastc(&[0, 1])),
        (ColorModel::ETC1S, [0]) => Some(Coding::Etc1s(&[0, 1, 2])),
        (ColorModel::ETC1S, [0, 15]) => Some(Coding::Etc1s(&[0, 1, 2, 3])),
        (ColorModel::ETC1S, [3]) => Some(Coding::Etc1s(&[0])),
        (ColorModel::ETC1S, [3, 4]) => Some(Coding::Etc1s(&[0, 3])),
        _ => None,
    }
}

fn of_vulkan(format: Format) -> Option<Coding> {
    use Values::{Float, Half, PackedFloat, SharedExponent, Snorm8, Snorm16, Unorm8, Unorm16};
    let texel = |channels, values| Some(Coding::Texels(Texel { channels, values, blue_first: false }));
    let blue_first = |channels| Some(Coding::Texels(Texel { channels, values: Unorm8, blue_first: true }));
    let blocks = |format| Some(Coding::Blocks(format));
    match format {
        Format::R8_UNORM | Format::R8_SRGB => texel(1, Unorm8),
        Format::R8G8_UNORM | Format::R8G8_SRGB => texel(2, Unorm8),
        Format::R8G8B8_UNORM | Format::R8G8B8_SRGB => texel(3, Unorm8),
        Format::R8G8B8A8_UNORM | Format::R8G8B8A8_SRGB => texel(4, Unorm8),
        Format::B8G8R8_UNORM | Format::B8G8R8_SRGB => blue_first(3),
        Format::B8G8R8A8_UNORM | Format::B8G8R8A8_SRGB => blue_first(4),
        Format::R8_SNORM => texel(1, Snorm8),
        Format::R8G8_SNORM => texel(2, Snorm8),
        Format::R8G8B8_SNORM => texel(3, Snorm8),
        Format::R8G8B8A8_SNORM => texel(4, Snorm8),
        Format::R16_UNORM => texel(1, Unorm16),
        Format::R16G16_UNORM => texel(2, Unorm16),
        Format::R16G16B16_UNORM => texel(3, Unorm16),
        Format::R16G16B16A16_UNORM => texel(4, Unorm16),
        Format::R16_SNORM => texel(1, Snorm16),
        Format::R16G16_SNORM => texel(2, Snorm16),
        Format::R16G16B16_SNORM => texel(3, Snorm16),
        Format::R16G16B16A16_SNORM => texel(4, Snorm16),
        Format::R16_SFLOAT => texel(1, Half),
        Format::R16G16_SFLOAT => texel(2, Half),
        Format::R16G16B16_SFLOAT => texel(3, Half),
        Format::R16G16B16A16_SFLOAT => texel(4, Half),
        Format::R32_SFLOAT => texel(1, Float),
        Format::R32G32_SFLOAT => texel(2, Float),
        Format::R32G32B32_SFLOAT => texel(3, Float),
        Format::R32G32B32A32_SFLOAT => texel(4, Float),
        Format::E5B9G9R9_UFLOAT_PACK32 => texel(3, SharedExponent),
        Format::B10G11R11_UFLOAT_PACK32 => texel(3, PackedFloat),
        Format::BC1_RGB_UNORM_BLOCK | Format::BC1_RGB_SRGB_BLOCK => blocks(&blocks::BC1_RGB),
        Format::BC1_RGBA_UNORM_BLOCK | Format::BC1_RGBA_SRGB_BLOCK => blocks(&blocks::BC1_RGBA),
        Format::BC2_UNORM_BLOCK | Format::BC2_SRGB_BLOCK => blocks(&blocks::BC2),
        Format::BC3_UNORM_BLOCK | Format::BC3_SRGB_BLOCK => blocks(&blocks::BC3),
        Format::BC4_UNORM_BLOCK => blocks(&blocks::BC4_UNORM),
        Format::BC4_SNORM_BLOCK => blocks(&blocks::BC4_SNORM),
        Format::BC5_UNORM_BLOCK => blocks(&blocks::BC5_UNORM),
        Format::BC5_SNORM_BLOCK => blocks(&blocks::BC5_SNORM),
        Format::BC6H_UFLOAT_BLOCK => blocks(&blocks::BC6H_UFLOAT),
        Format::BC6H_SFLOAT_BLOCK => blocks(&blocks::BC6H_SFLOAT),
        Format::BC7_UNORM_BLOCK | Format::BC7_SRGB_BLOCK => blocks(&blocks::BC7),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
