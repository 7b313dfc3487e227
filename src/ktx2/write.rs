//! The container writer. KTX File Format Specification 2.0, sections named at the line.

use std::io::{self, Write};
use std::mem;
use std::num::NonZeroU8;

use ::ktx2::dfd::{Basic, Block, ChannelTypeQualifiers, DataFormatFlags, SampleInformation};
use ::ktx2::{ColorModel, ColorPrimaries, Header, Index, LevelIndex, SupercompressionScheme, TransferFunction};
use zstd::stream::write::Encoder;
use zstd::zstd_safe::{CParameter, Strategy};

use crate::codec::Format;
use crate::codec::uastc::Effort;
use crate::memory::{self, OutOfMemory};

/// An entry of the key/value data whose value is text.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// UTF-8 without NUL. Keys that start with `KTX` are Khronos's.
    pub key: String,
    /// UTF-8; a NUL is added.
    pub value: String,
}

/// A level as a file holds it: UASTC supercompressed with zstd, other formats as they are.
#[derive(Clone, Debug)]
pub struct StoredLevel {
    bytes: Vec<u8>,
    /// Bytes before supercompression.
    uncompressed: usize,
}

impl StoredLevel {
    /// Of a level as [`crate::codec::encode`] returns it; zstd searches as long as `effort` says.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn new(level: Vec<u8>, format: Format, effort: Effort) -> Result<Self, OutOfMemory> {
        let mut storing = Storing::new(level.len(), format, effort)?;
        storing.push(&level)?;
        storing.finish()
    }
}

/// A level that is stored band by band, so that it is never held as it was encoded.
pub struct Storing {
    stored: Stored,
    uncompressed: usize,
}

enum Stored {
    Plain(Vec<u8>),
    Zstd(Encoder<'static, Vec<u8>>),
}

impl Storing {
    /// Of a level that [`crate::codec::encode`] makes `uncompressed` bytes of; zstd searches as long as `effort` says.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn new(uncompressed: usize, format: Format, effort: Effort) -> Result<Self, OutOfMemory> {
        // MemoryBudget is memory only where it is written to, and what grows is copied.
        let room = memory::with_capacity(uncompressed)?;
        let zstd = |room| {
            let mut encoder = Encoder::new(room, zstd_level(effort))?;
            if effort == Effort::Fast {
                encoder.set_parameter(CParameter::Strategy(Strategy::ZSTD_fast))?;
            }
            encoder.set_pledged_src_size(Some(uncompressed as u64))?;
            Ok(encoder)
        };
        let stored = match format {
            Format::UastcRgb => Stored::Zstd(zstd(room).map_err(refused(uncompressed))?),
            _ => Stored::Plain(room),
        };
        Ok(Self { stored, uncompressed })
    }

    /// Adds the next rows of blocks.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn push(&mut self, band: &[u8]) -> Result<(), OutOfMemory> {
        match &mut self.stored {
            Stored::Plain(bytes) => bytes.extend_from_slice(band),
            Stored::Zstd(encoder) => encoder.write_all(band).map_err(refused(self.uncompressed))?,
        }
        Ok(())
    }

    /// The level, all of whose bytes have been added.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn finish(self) -> Result<StoredLevel, OutOfMemory> {
        let bytes = match self.stored {
            Stored::Plain(bytes) => bytes,
            Stored::Zstd(encoder) => encoder.finish().map_err(refused(self.uncompressed))?,
        };
        Ok(StoredLevel { bytes, uncompressed: self.uncompressed })
    }
}

/// What an error of the zstd encoder means, which writes as many bytes to memory as it was told: its own memory was refused.
fn refused(uncompressed: usize) -> impl Fn(io::Error) -> OutOfMemory {
    move |_| OutOfMemory { bytes: uncompressed as u64 }
}

/// A KTX2 file to be written: a 2-D texture with a full chain of levels.
#[derive(Clone, Debug)]
pub struct Ktx2Writer<'a> {
    /// How texels are stored.
    pub format: Format,
    /// Columns of level 0.
    pub width: u32,
    /// Rows of level 0.
    pub height: u32,
    /// Levels of that format, level 0 first.
    pub levels: Vec<StoredLevel>,
    /// Written sorted, beside `KTXorientation` = `rd`.
    pub keys: &'a [Key],
}

/// `Fast` is level 3 with one table of hashes instead of two: on the UASTC of `../shared/data` files are 0.7 % larger for 0.7 of
/// the time, on that of normals and roughness without any flat place 0.3 % for 0.8 (level 1: 6 % for 0.4 and 2 % for 0.6; level 5
/// takes 1.5 and 2.5 times as long as level 3 and makes files 1.6 and 1.9 % smaller; `zstd -b3 --zstd=strategy=1`). On three real assets
/// level 18 makes them 7 % smaller than level 5 at a twentieth of its speed.
fn zstd_level(effort: Effort) -> i32 {
    match effort {
        Effort::Fast => 3,
        Effort::Best => 18,
    }
}

impl Ktx2Writer<'_> {
    /// The bytes of the file.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn into_bytes(self) -> Result<Vec<u8>, OutOfMemory> {
        let Self { format, width, height, mut levels, keys } = self;
        let supercompressed = format == Format::UastcRgb;
        let (descriptor, type_size) = data_format_descriptor(format);
        let key_values = key_value_data(keys);
        let dfd_offset = Header::LENGTH + LevelIndex::LENGTH * levels.len();
        let kvd_offset = dfd_offset + descriptor.len();

        // "Mip Padding": levels are stored smallest first, each aligned to lcm(block bytes, 4) unless supercompressed.
        let alignment = if supercompressed { 1 } else { format.block_bytes().max(4) };
        let data_offset = kvd_offset + key_values.len();
        let mut index = Vec::with_capacity(levels.len());
        let mut end = data_offset;
        for StoredLevel { bytes, uncompressed } in levels.iter().rev() {
            let offset = end.next_multiple_of(alignment);
            end = offset + bytes.len();
            index.push(LevelIndex {
                byte_offset: offset as u64,
                byte_length: bytes.len() as u64,
                uncompressed_byte_length: *uncompressed as u64,
            });
        }

        let header = Header {
            format: format.vulkan(),
            type_size,
            pixel_width: width,
            pixel_height: height,
            pixel_depth: 0,
            layer_count: 0,
            face_count: 1,
            level_count: levels.len() as u32,
            supercompression_scheme: supercompressed.then_some(SupercompressionScheme::Zstandard),
            index: Index {
                dfd_byte_offset: dfd_offset as u32,
                dfd_byte_length: descriptor.len() as u32,
                kvd_byte_offset: kvd_offset as u32,
                kvd_byte_length: key_values.len() as u32,
                sgd_byte_offset: 0,
                sgd_byte_length: 0,
            },
        };
        // Level 0, which comes last, is most of the file: what comes before it is put there, so that new memory need not be cleared for all.
        let mut file = levels.first_mut().map(|level| mem::take(&mut level.bytes)).unwrap_or_default();
        let (length, start) = (file.len(), end - file.len());
        // The smaller levels, and level 0 once more where it has to move.
        memory::check((start + end) as u64)?;
        let mut before = Vec::with_capacity(start);
        before.extend_from_slice(&header.as_bytes());
        for level in index.iter().rev() {
            before.extend_from_slice(&level.as_bytes());
        }
        before.extend_from_slice(&descriptor);
        before.extend_from_slice(&key_values);
        for (stored, level) in levels.iter().rev().zip(&index) {
            before.resize(level.byte_offset as usize, 0);
            before.extend_from_slice(&stored.bytes);
        }
        file.resize(end, 0);
        file.copy_within(..length, start);
        file[..start].copy_from_slice(&before);
        Ok(file)
    }
}

/// "Data Format Descriptor": total size and one basic block; with it, the header's typeSize.
fn data_format_descriptor(format: Format) -> (Vec<u8>, u32) {
    let (mut basic, type_size) = match format.vulkan() {
        Some(vulkan) => Basic::from_format(vulkan).expect("the crate describes every format that is written"),
        None => (uastc_rgb(), 1),
    };
    // KHR_texture_basisu: data that are not colours have unspecified primaries and a linear transfer.
    basic.color_primaries = None;
    basic.transfer_function = Some(TransferFunction::Linear);
    let block = Block::Basic(basic).to_vec();
    let total = block.len() as u32 + 4;
    ([&total.to_le_bytes()[..], &block].concat(), type_size)
}

/// Khronos Data Format Specification 1.3, UASTC: one sample of 128 bits; channel 0 is RGB. The plane keeps its size under
/// supercompression since KTX 2.0.4.
fn uastc_rgb() -> Basic {
    let four = NonZeroU8::new(4).expect("4 is not 0");
    Basic {
        color_model: Some(ColorModel::UASTC),
        color_primaries: None::<ColorPrimaries>,
        transfer_function: Some(TransferFunction::Linear),
        flags: DataFormatFlags::STRAIGHT_ALPHA,
        texel_block_dimensions: [four, four, NonZeroU8::MIN, NonZeroU8::MIN],
        bytes_planes: [16, 0, 0, 0, 0, 0, 0, 0],
        sample_information: vec![SampleInformation {
            bit_offset: 0,
            bit_length: NonZeroU8::new(128).expect("128 is not 0"),
            channel_type: 0,
            channel_type_qualifiers: ChannelTypeQualifiers::empty(),
            sample_positions: [0; 4],
            lower: 0,
            upper: u32::MAX,
        }],
    }
}

/// "Key/Value Data": sorted by key in Unicode order, values NUL-terminated, entries padded to 4 bytes.
fn key_value_data(keys: &[Key]) -> Vec<u8> {
    let mut sorted: Vec<(&str, &str)> = vec![("KTXorientation", "rd")];
    sorted.extend(keys.iter().map(|k| (k.key.as_str(), k.value.as_str())));
    sorted.sort_unstable();
    let mut bytes = Vec::new();
    for (key, value) in sorted {
        let length = key.len() + value.len() + 2;
        bytes.extend_from_slice(&(length as u32).to_le_bytes());
        bytes.extend_from_slice(key.as_bytes());
        bytes.push(0);
        bytes.extend_from_slice(value.as_bytes());
        bytes.push(0);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    bytes
}
