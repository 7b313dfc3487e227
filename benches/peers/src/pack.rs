//! A stand-in for `ktx create --generate-mipmap --encode uastc --uastc-quality 0 --zstd 5`, which no registry has. It
//! uses the `png` crate, box-filtered mips, basis_universal's level 0, and zstd as in Roughcast's `fast`.

use std::path::Path;

use rayon::prelude::*;
use roughcast::codec::PayloadFormat;
use roughcast::codec::uastc::Effort;
use roughcast::ktx2::{Ktx2Writer, StoredLevel};
use roughcast::mip::level_sizes;
use serde_json::{Value, json};

use crate::Failure;
use crate::basisu::{self, Interface};
use crate::encoders::{Encoder, read};

/// Packs `image` to `out`.
///
/// # Errors
/// When a file cannot be read or written, or a level cannot be encoded.
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
        levels.push(StoredLevel::new(blocks, PayloadFormat::UastcRgb, Effort::Fast).unwrap());
    }
    let file = Ktx2Writer { format: PayloadFormat::UastcRgb, width, height, levels, keys: &[] }.into_bytes().unwrap();
    std::fs::write(out, &file)?;
    Ok(json!({ "bytes": file.len() }))
}

/// Averages boxes of 2 x 2 texels. The last column and row of odd sizes are left out.
fn halved(rgba: &[u8], (fine_width, fine_height): (u32, u32), (width, _): (u32, u32)) -> Vec<u8> {
    let (texels, fine_width, fine_height) = (rgba.as_chunks::<4>().0, fine_width as usize, fine_height as usize);
    let width = width as usize;
    let mut out = vec![[0; 4]; width * (fine_height / 2).max(1)];
    out.par_chunks_exact_mut(width).enumerate().for_each(|(y, out)| {
        let [above, below] = [2 * y, (2 * y + 1).min(fine_height - 1)].map(|y| &texels[y * fine_width..][..fine_width]);
        for (x, out) in out.iter_mut().enumerate() {
            let (left, right) = (2 * x, (2 * x + 1).min(fine_width - 1));
            for c in 0..4 {
                let sum = [above[left], above[right], below[left], below[right]].map(|texel| u32::from(texel[c]));
                out[c] = ((sum.iter().sum::<u32>() + 2) / 4) as u8;
            }
        }
    });
    out.into_flattened()
}
