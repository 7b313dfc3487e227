//! Encodes BC4, BC5 and BC7 with crate `ctt` (Intel's and bc7enc's kernels).

use ctt::encoders::Encoder;
use ctt::{
    AlphaMode, ColorSpace, Container, ConvertSettings, FormatDesc, ImageRef, PipelineOutput, Quality, SurfaceRef,
    TargetFormat, TextureKind,
};

use crate::codec::error::EncodeError;
use crate::codec::format::PayloadFormat;
use crate::codec::quantise::Texels;
use crate::codec::uastc::Effort;

/// Encodes one level. `format` is one of the BC formats.
pub fn encode(texels: &Texels<'_>, format: PayloadFormat, effort: Effort) -> Result<Vec<u8>, EncodeError> {
    let (width, height) = (texels.width, texels.height);
    let failed = |reason: String| EncodeError::Encoder { format, width, height, reason };
    let vulkan = format.vulkan().ok_or_else(|| failed("not a BC format".into()))?;
    let rgba = texels.to_rgba8(false);
    let surface = SurfaceRef { data: &rgba, width, height, depth: 1, stride: width * 4, slice_stride: 0 };
    let image = ImageRef {
        surfaces: vec![vec![surface]],
        kind: TextureKind::Texture2D,
        desc: FormatDesc {
            format: ctt::Format::R8G8B8A8_UNORM,
            color_space: ColorSpace::Linear,
            alpha: AlphaMode::Opaque,
        },
    };
    let settings = ConvertSettings {
        format: Some(TargetFormat::Compressed { format: vulkan, encoder: Encoder::Auto }),
        container: Container::Raw,
        quality: match effort {
            Effort::Fast => Quality::Fast,
            Effort::Best => Quality::Slow,
        },
        ..Default::default()
    };
    let output = ctt::convert(image, settings).map_err(|e| failed(e.to_string()))?;
    let PipelineOutput::Raw(image) = output else {
        return Err(failed("the encoder wrapped the blocks in a container".into()));
    };
    let surface = image.surfaces.into_iter().flatten().next();
    surface.map(|s| s.data).ok_or_else(|| failed("the encoder returned nothing".into()))
}
