//! What blocks and texels a texture is made of.

/// The family of payloads to write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Target {
    /// UASTC LDR 4x4 with zstd: the one payload that every glTF engine takes.
    #[default]
    Basis,
    /// BC4, BC5 and BC7: desktop GPUs, no transcoding.
    Bc,
    /// Half floats: no quantising to 8 bits.
    Float,
}

impl Target {
    /// The format for texels of `channels` (1 to 3) channels.
    pub fn format(self, channels: u32) -> Format {
        match (self, channels) {
            (Self::Basis, _) => Format::UastcRgb,
            (Self::Bc, 1) => Format::Bc4,
            (Self::Bc, 2) => Format::Bc5,
            (Self::Bc, _) => Format::Bc7,
            (Self::Float, 1) => Format::R16Float,
            (Self::Float, 2) => Format::Rg16Float,
            (Self::Float, _) => Format::Rgba16Float,
        }
    }
}

/// How texels are stored. All are linear data, never sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// UASTC LDR 4x4, opaque RGB.
    UastcRgb,
    /// One channel, 8 bytes per 4x4 block.
    Bc4,
    /// Two channels, 16 bytes per 4x4 block.
    Bc5,
    /// Opaque RGB, 16 bytes per 4x4 block.
    Bc7,
    /// One half float.
    R16Float,
    /// Two half floats.
    Rg16Float,
    /// Four half floats; the last is 1.
    Rgba16Float,
}

impl Format {
    /// The Vulkan format; none for UASTC, which is transcoded.
    pub fn vulkan(self) -> Option<::ktx2::Format> {
        match self {
            Self::UastcRgb => None,
            Self::Bc4 => Some(::ktx2::Format::BC4_UNORM_BLOCK),
            Self::Bc5 => Some(::ktx2::Format::BC5_UNORM_BLOCK),
            Self::Bc7 => Some(::ktx2::Format::BC7_UNORM_BLOCK),
            Self::R16Float => Some(::ktx2::Format::R16_SFLOAT),
            Self::Rg16Float => Some(::ktx2::Format::R16G16_SFLOAT),
            Self::Rgba16Float => Some(::ktx2::Format::R16G16B16A16_SFLOAT),
        }
    }

    /// Bytes of a 4x4 block, or of a texel where there are no blocks.
    pub fn block_bytes(self) -> usize {
        match self {
            Self::UastcRgb | Self::Bc5 | Self::Bc7 => 16,
            Self::Bc4 | Self::Rgba16Float => 8,
            Self::Rg16Float => 4,
            Self::R16Float => 2,
        }
    }

    /// Whether texels come in blocks of 4x4.
    pub fn is_block(self) -> bool {
        matches!(self, Self::UastcRgb | Self::Bc4 | Self::Bc5 | Self::Bc7)
    }

    /// Whether values are quantised to [0, 1] before encoding.
    pub fn is_normalised(self) -> bool {
        self.is_block()
    }

    /// Bytes of a level of `width` x `height` texels.
    pub fn level_bytes(self, width: u32, height: u32) -> usize {
        let (columns, rows) = if self.is_block() { (width.div_ceil(4), height.div_ceil(4)) } else { (width, height) };
        columns as usize * rows as usize * self.block_bytes()
    }
}
