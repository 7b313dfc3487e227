//! Decoding of the BC formats, block by block.

use crate::image::Samples;
use crate::ktx2::formats::BlockFormat;

/// Decodes `payload`, whose length has been checked, to an image of `size` texels.
pub(super) fn decode(payload: &[u8], size: (u32, u32), kind: BlockFormat) -> Samples {
    let image = BlockImage { payload, width: size.0 as usize, height: size.1 as usize, kind };
    match kind {
        BlockFormat::Bc1 { .. } => Samples::U8(image.decode(4, bcdec_rs::bc1)),
        BlockFormat::Bc2 => Samples::U8(image.decode(4, bcdec_rs::bc2)),
        BlockFormat::Bc3 => Samples::U8(image.decode(4, bcdec_rs::bc3)),
        BlockFormat::Bc7 => Samples::U8(image.decode(4, bcdec_rs::bc7)),
        BlockFormat::Bc4 { signed } => {
            let bc4 = |b: &[u8], to: &mut [f32], pitch| bcdec_rs::bc4_float(b, to, pitch, signed);
            to_samples(image.decode(1, bc4), signed)
        }
        BlockFormat::Bc5 { signed } => {
            let bc5 = |b: &[u8], to: &mut [f32], pitch| bcdec_rs::bc5_float(b, to, pitch, signed);
            to_samples(image.decode(2, bc5), signed)
        }
        BlockFormat::Bc6h { signed } => {
            let bc6h = |b: &[u8], to: &mut [f32], pitch| bcdec_rs::bc6h_float(b, to, pitch, signed);
            Samples::F32(image.decode(3, bc6h))
        }
    }
}

struct BlockImage<'a> {
    payload: &'a [u8],
    width: usize,
    height: usize,
    kind: BlockFormat,
}

impl BlockImage<'_> {
    /// Decodes each block with `block`, which takes the block's bytes, 4 rows of texels of `stored` channels, and the
    /// pitch of these rows. Texels outside the image, and channels that the format does not have, are dropped.
    fn decode<T: Copy + Default>(&self, stored: usize, block: impl Fn(&[u8], &mut [T], usize)) -> Vec<T> {
        let (width, kept) = (self.width, self.kind.channels());
        let mut values = vec![T::default(); width * self.height * kept];
        let blocks = self.payload.chunks_exact(self.kind.bytes() * width.div_ceil(4));
        for (rows, blocks) in values.chunks_mut(4 * width * kept).zip(blocks) {
            for (across, bytes) in blocks.chunks_exact(self.kind.bytes()).enumerate() {
                let mut texels = [T::default(); 64];
                block(bytes, &mut texels, 4 * stored);
                let lines = rows.chunks_exact_mut(width * kept);
                for (row, line) in lines.zip(texels.chunks_exact(4 * stored)) {
                    let row = row.chunks_exact_mut(kept).skip(4 * across);
                    for (to, from) in row.zip(line.chunks_exact(stored)) {
                        to.copy_from_slice(&from[..kept]);
                    }
                }
            }
        }
        values
    }
}

/// Returns signed values as floats in [-1, 1], and unsigned values rounded to 16 bits: 8 bits cannot hold sevenths and
/// fifths of the way between two 8-bit values.
fn to_samples(values: Vec<f32>, signed: bool) -> Samples {
    if signed {
        return Samples::F32(values);
    }
    let rounded = values.iter().map(|&v| (v * 65535.0 + 0.5) as u16);
    Samples::U16(rounded.collect())
}
