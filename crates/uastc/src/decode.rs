//! Decodes blocks to texels.

use crate::BLOCK_BYTES;
use crate::lanes::Texels;
use crate::pack::Block;
use crate::unpack::{Unpacked, unpack};

/// Decodes one block to its 16 RGBA8 texels, row 0 first.
///
/// All modes of the format are decoded, including the modes with alpha, which [`Encoder`](crate::Encoder) does not
/// write. Blocks are decoded as linear data. The format decodes sRGB images by a slightly different rule, as ASTC does.
///
/// Returns `None` if the bytes are not a valid block: the mode is reserved or the pattern does not exist.
pub fn decode_block(block: &[u8; BLOCK_BYTES]) -> Option<[[u8; 4]; 16]> {
    Some(match unpack(block)? {
        Unpacked::Solid(colour) => [colour; 16],
        Unpacked::Block(block) => block.texels(),
    })
}

impl Block {
    fn texels(&self) -> Texels {
        // Two channels are grey and alpha.
        let stored = if self.mode.channels == 2 { [0, 0, 0, 1] } else { [0, 1, 2, 3] };
        let mut texels = [[255; 4]; 16];
        for (c, stored) in stored.into_iter().enumerate().filter(|&(_, stored)| stored < self.mode.channels) {
            let levels = self.channel(stored, self.plane_of(c));
            for (texel, level) in texels.iter_mut().zip(levels) {
                texel[c] = level as u8;
            }
        }
        texels
    }
}
