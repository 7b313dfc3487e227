//! PNG files of 8 bits: fallbacks and extracted levels.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use crate::texture::uastc::Effort;

/// A PNG of opaque RGBA8 texels, stored as RGB. For a 4096^2 normal and roughness map zlib's default effort takes 7.8 CPU
/// seconds, about as long as all the rest of the bake; the fast one takes 1.1 for files an eighth larger.
///
/// # Errors
/// What the encoder says.
pub fn encode_png(rgba: &[u8], width: u32, height: u32, effort: Effort) -> Result<Vec<u8>, String> {
    let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|t| [t[0], t[1], t[2]]).collect();
    let mut file = Vec::new();
    let compression = match effort {
        Effort::Fast => CompressionType::Fast,
        Effort::Best => CompressionType::Default,
    };
    PngEncoder::new_with_quality(&mut file, compression, FilterType::Adaptive)
        .write_image(&rgb, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| e.to_string())?;
    Ok(file)
}
