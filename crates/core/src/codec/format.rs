//! Targets that users ask for, and the texel formats that each consists of. [`super::table`] has the facts.

/// The kind of payload to write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Target {
    /// UASTC LDR 4x4 with zstd: the one payload that every glTF engine reads.
    #[default]
    #[cfg_attr(feature = "cli", value(help = "UASTC LDR 4x4 with zstd: every engine"))]
    Basis,
    /// BC4, BC5 and BC7: desktop GPUs, no transcoding.
    #[cfg_attr(feature = "cli", value(help = "BC4, BC5, BC7: desktop GPUs"))]
    Bc,
    /// Half floats: values are not quantised to 8 bits.
    #[cfg_attr(feature = "cli", value(help = "Half floats"))]
    Float,
}

impl Target {
    /// Returns the name, as the command line has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Basis => "basis",
            Self::Bc => "bc",
            Self::Float => "float",
        }
    }
}

/// How texels are stored. Formats hold linear data, unless their names say sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PayloadFormat {
    /// UASTC LDR 4x4, opaque RGB.
    UastcRgb,
    /// UASTC LDR 4x4, opaque sRGB colours.
    UastcSrgb,
    /// UASTC LDR 4x4, sRGB colours with straight alpha.
    UastcSrgbAlpha,
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
