//! A stand-in for `ktx create --generate-mipmap --encode uastc --uastc-quality 0 --zstd 5`, which is in no registry: the same
//! decoding, mips, encoder and supercompression, by the `png` crate, boxes and basis_universal's level 0.

use std::path::Path;

use roughcast::pyramid::level_sizes;
use roughcast::texture::Format;
use roughcast::texture::ktx2::{Ktx2Writer, StoredLevel};
use roughcast::texture::uastc::Effort;
use serde_json::{Value, json};

use crate::Failure;
use crate::basisu::{self, Interface};
use crate::encoders::{Encoder, read};

/// Packs `image` to `out`.
///
/// # Errors
/// Where a file cannot be read or written, or a level not encoded.
pub fn measure(image: &Path, out: &Path) -> Result<Value, Failure> {
    basisu::prepare();
    let (mut texels, width, height) = read(image)?;
    let sizes = level_sizes(width, height);
    let mut levels = Vec::with_capacity(sizes.len());
    for (index, &(width, height)) in sizes.iter().enumerate() {
        if let Some(finer) = index.checked_sub(1) {
            texels = halved(&texels, sizes[finer], (width, height));
        }
        let blocks = Encoder::Basisu(0, Interface::Plain).blocks(&texels, width, height)?;
        // `Fast` is zstd 5.
        levels.push(StoredLevel::new(blocks, Format::UastcRgb, Effort::Fast));
    }
    let file = Ktx2Writer { format: Format::UastcRgb, width, height, levels: &levels, keys: &[] }.to_bytes();
    std::fs::write(out, &file)?;
    Ok(json!({ "bytes": file.len() }))
}

/// Boxes of 2 x 2 texels; the last column and row of odd sizes are left out.
fn halved(rgba: &[u8], (fine_width, fine_height): (u32, u32), (width, height): (u32, u32)) -> Vec<u8> {
    let texel = |x: u32, y: u32| {
        let at = 4 * (y.min(fine_height - 1) as usize * fine_width as usize + x.min(fine_width - 1) as usize);
        &rgba[at..at + 4]
    };
    let mut out = Vec::with_capacity(width as usize * height as usize * 4);
    for y in 0..height {
        for x in 0..width {
            let parts =
                [texel(2 * x, 2 * y), texel(2 * x + 1, 2 * y), texel(2 * x, 2 * y + 1), texel(2 * x + 1, 2 * y + 1)];
            out.extend([0, 1, 2, 3].map(|c| ((parts.iter().map(|p| u32::from(p[c])).sum::<u32>() + 2) / 4) as u8));
        }
    }
    out
}
