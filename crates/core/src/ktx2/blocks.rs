//! Decoding of BC1 to BC7, block by block: one row for each format.

use crate::image::Samples;

/// A format of blocks of 4 x 4 texels that can be decoded.
pub(super) struct BlockFormat {
    /// Bytes of a block.
    pub bytes: usize,
    /// Channels of a decoded texel.
    pub channels: usize,
    /// Most bytes that a channel of a texel takes while a level is decoded.
    pub channel_bytes: u64,
    decode: fn(&BlockImage<'_>) -> Samples,
}

/// BC1 without alpha.
pub(super) static BC1_RGB: BlockFormat = eight_bits(8, 3, |image| image.rgba8(bcdec_rs::bc1));
/// BC1 with one bit of alpha.
pub(super) static BC1_RGBA: BlockFormat = eight_bits(8, 4, |image| image.rgba8(bcdec_rs::bc1));
/// BC2.
pub(super) static BC2: BlockFormat = eight_bits(16, 4, |image| image.rgba8(bcdec_rs::bc2));
/// BC3.
pub(super) static BC3: BlockFormat = eight_bits(16, 4, |image| image.rgba8(bcdec_rs::bc3));
/// BC7.
pub(super) static BC7: BlockFormat = eight_bits(16, 4, |image| image.rgba8(bcdec_rs::bc7));

/// BC4. Values are decoded to floats of 4 bytes and then rounded to 2 bytes.
pub(super) static BC4_UNORM: BlockFormat =
    BlockFormat { bytes: 8, channels: 1, channel_bytes: 6, decode: |image| unsigned(image.decode(1, bc4::<false>)) };
/// BC4 of signed values.
pub(super) static BC4_SNORM: BlockFormat =
    BlockFormat { bytes: 8, channels: 1, channel_bytes: 6, decode: |image| Samples::F32(image.decode(1, bc4::<true>)) };
/// BC5. Values are decoded to floats of 4 bytes and then rounded to 2 bytes.
pub(super) static BC5_UNORM: BlockFormat =
    BlockFormat { bytes: 16, channels: 2, channel_bytes: 6, decode: |image| unsigned(image.decode(2, bc5::<false>)) };
/// BC5 of signed values.
pub(super) static BC5_SNORM: BlockFormat = BlockFormat {
    bytes: 16,
    channels: 2,
    channel_bytes: 6,
    decode: |image| Samples::F32(image.decode(2, bc5::<true>)),
};
/// BC6H.
pub(super) static BC6H_UFLOAT: BlockFormat = BlockFormat {
    bytes: 16,
    channels: 3,
    channel_bytes: 4,
    decode: |image| Samples::F32(image.decode(3, bc6h::<false>)),
};
/// BC6H of signed values.
pub(super) static BC6H_SFLOAT: BlockFormat = BlockFormat {
    bytes: 16,
    channels: 3,
    channel_bytes: 4,
    decode: |image| Samples::F32(image.decode(3, bc6h::<true>)),
};

/// Returns the row of a format that is decoded to RGBA8, of which the first `channels` channels are kept.
const fn eight_bits(bytes: usize, channels: usize, decode: fn(&BlockImage<'_>) -> Samples) -> BlockFormat {
    BlockFormat { bytes, channels, channel_bytes: 1, decode }
}

fn bc4<const SIGNED: bool>(block: &[u8], to: &mut [f32], pitch: usize) {
    bcdec_rs::bc4_float(block, to, pitch, SIGNED);
}

fn bc5<const SIGNED: bool>(block: &[u8], to: &mut [f32], pitch: usize) {
    bcdec_rs::bc5_float(block, to, pitch, SIGNED);
}

fn bc6h<const SIGNED: bool>(block: &[u8], to: &mut [f32], pitch: usize) {
    bcdec_rs::bc6h_float(block, to, pitch, SIGNED);
}

/// Decodes `payload`, whose length has been checked, to an image of `size` texels.
pub(super) fn decode(payload: &[u8], size: (u32, u32), format: &BlockFormat) -> Samples {
    (format.decode)(&BlockImage { payload, width: size.0 as usize, height: size.1 as usize, format })
}

/// The blocks of an image.
struct BlockImage<'a> {
    payload: &'a [u8],
    width: usize,
    height: usize,
    format: &'a BlockFormat,
}

impl BlockImage<'_> {
    /// Decodes each block with `block`, which writes RGBA8.
    fn rgba8(&self, block: impl Fn(&[u8], &mut [u8], usize)) -> Samples {
        Samples::U8(self.decode(4, block))
    }

    /// Decodes each block with `block`, which takes the block's bytes, 4 rows of texels of `stored` channels, and the
    /// pitch of these rows. Texels outside the image, and channels that the format does not have, are dropped.
    fn decode<T: Copy + Default>(&self, stored: usize, block: impl Fn(&[u8], &mut [T], usize)) -> Vec<T> {
        let (width, kept) = (self.width, self.format.channels);
        let mut values = vec![T::default(); width * self.height * kept];
        let blocks = self.payload.chunks_exact(self.format.bytes * width.div_ceil(4));
        for (rows, blocks) in values.chunks_mut(4 * width * kept).zip(blocks) {
            for (across, bytes) in blocks.chunks_exact(self.format.bytes).enumerate() {
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

/// Returns values rounded to 16 bits: 8 bits cannot hold sevenths and fifths of the way between two 8-bit values.
fn unsigned(values: Vec<f32>) -> Samples {
    let rounded = values.iter().map(|&v| (v * 65535.0 + 0.5) as u16);
    Samples::U16(rounded.collect())
}
