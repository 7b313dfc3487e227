//! KTX2 files made by hand, so that every byte is known.

use ktx2::dfd::{Basic, ChannelTypeQualifiers, DataFormatFlags, SampleInformation};
use ktx2::{ColorModel, Format, SupercompressionScheme, TransferFunction};

/// The parts of a file. Levels are given as they are stored.
pub(super) struct File<'a> {
    pub format: Option<Format>,
    pub size: (u32, u32),
    pub scheme: Option<SupercompressionScheme>,
    pub descriptor: Basic,
    /// Stored bytes and uncompressed length of each level, largest first.
    pub levels: Vec<(Vec<u8>, u64)>,
    pub key_values: &'a [(&'a str, &'a [u8])],
    pub global: &'a [u8],
}

impl File<'_> {
    pub fn encode(&self) -> Vec<u8> {
        let block = ktx2::dfd::Block::Basic(self.descriptor.clone()).to_vec();
        let mut descriptor = (block.len() as u32 + 4).to_le_bytes().to_vec();
        descriptor.extend(block);
        let mut pairs = Vec::new();
        for (key, value) in self.key_values {
            pairs.extend((key.len() as u32 + 1 + value.len() as u32).to_le_bytes());
            pairs.extend(key.as_bytes());
            pairs.push(0);
            pairs.extend(*value);
            pairs.resize(pairs.len().next_multiple_of(4), 0);
        }
        let descriptor_at = ktx2::Header::LENGTH + ktx2::LevelIndex::LENGTH * self.levels.len();
        let pairs_at = descriptor_at + descriptor.len();
        let global_at = (pairs_at + pairs.len()).next_multiple_of(8);
        let header = ktx2::Header {
            format: self.format,
            type_size: 1,
            pixel_width: self.size.0,
            pixel_height: self.size.1,
            pixel_depth: 0,
            layer_count: 0,
            face_count: 1,
            level_count: self.levels.len() as u32,
            supercompression_scheme: self.scheme,
            index: ktx2::Index {
                dfd_byte_offset: descriptor_at as u32,
                dfd_byte_length: descriptor.len() as u32,
                kvd_byte_offset: pairs_at as u32,
                kvd_byte_length: pairs.len() as u32,
                sgd_byte_offset: global_at as u64,
                sgd_byte_length: self.global.len() as u64,
            },
        };
        let mut offset = global_at + self.global.len();
        let mut offsets = vec![0; self.levels.len()];
        // The smallest level comes first in the file.
        for (level, (stored, _)) in self.levels.iter().enumerate().rev() {
            offsets[level] = offset.next_multiple_of(16);
            offset = offsets[level] + stored.len();
        }
        let mut file = header.as_bytes().to_vec();
        for (&offset, (stored, length)) in offsets.iter().zip(&self.levels) {
            let level = ktx2::LevelIndex {
                byte_offset: offset as u64,
                byte_length: stored.len() as u64,
                uncompressed_byte_length: *length,
            };
            file.extend(level.as_bytes());
        }
        file.extend(descriptor);
        file.extend(pairs);
        file.resize(global_at, 0);
        file.extend(self.global);
        for (&offset, (stored, _)) in offsets.iter().zip(&self.levels).rev() {
            file.resize(offset, 0);
            file.extend(stored);
        }
        file
    }
}

/// Returns a descriptor with one sample for each of `channels`, in blocks of `edge` x `edge` texels.
pub(super) fn descriptor(model: ColorModel, channels: &[u8], edge: u8, bytes: u8) -> Basic {
    let edge = edge.try_into().unwrap();
    let one = 1.try_into().unwrap();
    let sample = |&channel_type: &u8| SampleInformation {
        bit_offset: 0,
        bit_length: 8.try_into().unwrap(),
        channel_type,
        channel_type_qualifiers: ChannelTypeQualifiers::empty(),
        sample_positions: [0; 4],
        lower: 0,
        upper: 255,
    };
    Basic {
        color_model: Some(model),
        color_primaries: None,
        transfer_function: Some(TransferFunction::Linear),
        flags: DataFormatFlags::empty(),
        texel_block_dimensions: [edge, edge, one, one],
        bytes_planes: [bytes, 0, 0, 0, 0, 0, 0, 0],
        sample_information: channels.iter().map(sample).collect(),
    }
}

/// Returns a file of a Vulkan format without supercompression.
pub(super) fn plain(format: Format, size: (u32, u32), levels: &[&[u8]]) -> File<'static> {
    File {
        format: Some(format),
        size,
        scheme: None,
        descriptor: descriptor(ColorModel::RGBSDA, &[0], 1, 1),
        levels: levels.iter().map(|level| (level.to_vec(), level.len() as u64)).collect(),
        key_values: &[],
        global: &[],
    }
}

/// Returns a texel of the image from which [`ETC1S`] was encoded.
pub(super) fn etc1s_texel(x: u32, y: u32) -> [u8; 4] {
    [(x * 20) as u8, (y * 20) as u8, 128, (x * y + 60) as u8]
}

/// An ETC1S file of 12 x 12 texels with alpha and a full mip chain. The reference encoder, `basisu_c_sys` 0.9.1, made
/// it with linear defaults and `GEN_MIPS_CLAMP` from the texels of [`etc1s_texel`].
#[rustfmt::skip]
pub(super) const ETC1S: &[u8] = &[
    171, 75, 84, 88, 32, 50, 48, 187, 13, 10, 26, 10, 0, 0, 0, 0, 1, 0, 0, 0, 12, 0, 0, 0, 12, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 1, 0, 0, 0, 4, 0, 0, 0, 1, 0, 0, 0, 176, 0, 0, 0, 60, 0, 0, 0, 236, 0, 0, 0, 36, 0, 0, 0, 16, 1, 0, 0, 0,
    0, 0, 0, 71, 1, 0, 0, 0, 0, 0, 0, 104, 2, 0, 0, 0, 0, 0, 0, 17, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 95, 2,
    0, 0, 0, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 91, 2, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 87, 2, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 60, 0, 0, 0, 0, 0,
    0, 0, 2, 0, 56, 0, 163, 1, 1, 0, 3, 3, 0, 0, 8, 8, 0, 0, 0, 0, 0, 0, 0, 0, 63, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255,
    255, 255, 64, 0, 63, 15, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255, 31, 0, 0, 0, 75, 84, 88, 119, 114, 105, 116,
    101, 114, 0, 66, 97, 115, 105, 115, 32, 85, 110, 105, 118, 101, 114, 115, 97, 108, 32, 50, 46, 53, 48, 0, 0, 24, 0,
    22, 0, 89, 0, 0, 0, 85, 0, 0, 0, 53, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 0, 0, 0, 8, 0, 0, 0, 9, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 31, 192, 219, 0, 1, 0, 0, 65, 58, 56, 40, 24, 245,
    64, 32, 192, 27, 0, 1, 0, 4, 97, 19, 42, 204, 59, 4, 153, 75, 10, 32, 98, 64, 0, 0, 0, 48, 168, 29, 16, 35, 4, 96,
    2, 128, 0, 0, 64, 0, 12, 219, 19, 244, 30, 4, 112, 1, 6, 60, 35, 0, 134, 49, 35, 192, 23, 91, 235, 140, 196, 173,
    218, 181, 134, 228, 117, 119, 36, 73, 34, 41, 119, 151, 41, 243, 223, 23, 119, 51, 136, 7, 226, 6, 16, 64, 48, 20,
    134, 191, 255, 9, 133, 83, 164, 118, 134, 48, 128, 34, 6, 112, 167, 64, 101, 136, 140, 98, 15, 133, 12, 160, 72,
    238, 12, 164, 60, 63, 63, 63, 157, 80, 11, 24, 7, 32, 120, 167, 224, 55, 73, 228, 217, 80, 231, 160, 130, 188, 106,
    159, 28, 218, 42, 187, 205, 236, 144, 180, 244, 109, 19, 240, 195, 8, 184, 8, 215, 151, 226, 94, 171, 148, 255, 125,
    0, 0, 193, 68, 0, 0, 0, 0, 0, 0, 242, 223, 39, 8, 6, 48, 7, 96, 0, 128, 96, 32, 0, 246, 152, 16, 97, 16, 159, 3, 52,
    18, 36, 0, 32, 208, 80, 94, 177, 180, 228, 6, 42, 0, 152, 0, 0, 0, 0, 0, 0, 64, 0, 1, 231, 4, 71, 2, 183, 4, 151, 0,
    31, 8, 182, 8, 175, 254, 182, 90, 50, 11, 253, 192, 181, 112, 228, 117, 0, 206, 240, 185, 210, 85, 204, 84, 125, 67,
];
