//! Writing of KTX2 files. Quoted titles are sections of the KTX File Format Specification 2.0.

use std::io::{self, Write};
use std::mem;

use ::ktx2::dfd::{Basic, Block};
use ::ktx2::{Header, Index, LevelIndex, SupercompressionScheme, TransferFunction};
use zstd::stream::write::Encoder;
use zstd::zstd_safe::{CParameter, Strategy};

use crate::codec::uastc::Effort;
use crate::codec::{Identity, PayloadFormat};
use crate::memory::{self, OutOfMemory};

/// An entry of the key/value data whose value is text.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// UTF-8 without NUL. Keys that begin with `KTX` are reserved by Khronos.
    pub key: String,
    /// UTF-8. The writer adds a NUL.
    pub value: String,
}

/// A level as it is stored in a file: UASTC is supercompressed with zstd, other formats are not compressed.
#[derive(Clone, Debug)]
pub struct StoredLevel {
    bytes: Vec<u8>,
    /// Bytes before supercompression.
    uncompressed: usize,
}

impl StoredLevel {
    /// Stores a level that [`crate::codec::encode`] returned. `effort` decides how long zstd searches.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn new(level: Vec<u8>, format: PayloadFormat, effort: Effort) -> Result<Self, OutOfMemory> {
        let mut writer = LevelWriter::new(level.len(), format, effort)?;
        writer.push(&level)?;
        writer.finish()
    }
}

/// Stores a level band by band, so that the whole encoded level is never in memory.
pub struct LevelWriter {
    stored: Stored,
    uncompressed: usize,
}

enum Stored {
    Plain(Vec<u8>),
    Zstd(Encoder<'static, Vec<u8>>),
}

impl LevelWriter {
    /// Begins a level of `uncompressed` bytes as [`crate::codec::encode`] makes them. `effort` decides how long zstd
    /// searches.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn new(uncompressed: usize, format: PayloadFormat, effort: Effort) -> Result<Self, OutOfMemory> {
        // The whole length is reserved: pages that are not written take no memory, while a buffer that grows is copied.
        let buffer = memory::with_capacity(uncompressed)?;
        let zstd = |buffer| {
            let mut encoder = Encoder::new(buffer, zstd_level(effort))?;
            if effort == Effort::Fast {
                encoder.set_parameter(CParameter::Strategy(Strategy::ZSTD_fast))?;
            }
            encoder.set_pledged_src_size(Some(uncompressed as u64))?;
            Ok(encoder)
        };
        let stored = match format.codec().is_supercompressed {
            true => Stored::Zstd(zstd(buffer).map_err(out_of_memory(uncompressed))?),
            false => Stored::Plain(buffer),
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
            Stored::Zstd(encoder) => encoder.write_all(band).map_err(out_of_memory(self.uncompressed))?,
        }
        Ok(())
    }

    /// Ends the level, all of whose bytes have been added.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn finish(self) -> Result<StoredLevel, OutOfMemory> {
        let bytes = match self.stored {
            Stored::Plain(bytes) => bytes,
            Stored::Zstd(encoder) => encoder.finish().map_err(out_of_memory(self.uncompressed))?,
        };
        Ok(StoredLevel { bytes, uncompressed: self.uncompressed })
    }
}

/// Maps an error of the zstd encoder. The encoder writes to memory and gets the length it was promised, so the only
/// error is that its own memory was refused.
fn out_of_memory(uncompressed: usize) -> impl Fn(io::Error) -> OutOfMemory {
    move |_| OutOfMemory { bytes: uncompressed as u64 }
}

/// A KTX2 file to be written: a 2D texture with a full mip chain.
#[derive(Clone, Debug)]
pub struct Ktx2Writer<'a> {
    /// The format of the texels.
    pub format: PayloadFormat,
    /// Columns of level 0.
    pub width: u32,
    /// Rows of level 0.
    pub height: u32,
    /// Levels in this format, level 0 first.
    pub levels: Vec<StoredLevel>,
    /// Keys to write beside `KTXorientation` = `rd`. The writer sorts them.
    pub keys: &'a [Key],
}

/// Returns the zstd level of an effort.
///
/// `Fast` is level 3 with one hash table instead of two (`zstd -b3 --zstd=strategy=1`), measured against plain level 3.
/// On the UASTC of real materials, files are 0.7 % larger for 0.7 of the time. On normals and roughness without any
/// flat area, files are 0.3 % larger for 0.8 of the time. Level 1 makes files 6 % and 2 % larger for 0.4 and 0.6 of the
/// time. Level 5 makes files 1.6 and 1.9 % smaller for 1.5 and 2.5 times the time.
///
/// `Best` is level 18: on three real assets, files are 7 % smaller than with level 5 at a twentieth of its speed.
fn zstd_level(effort: Effort) -> i32 {
    match effort {
        Effort::Fast => 3,
        Effort::Best => 18,
    }
}

impl Ktx2Writer<'_> {
    /// Returns the bytes of the file.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn into_bytes(self) -> Result<Vec<u8>, OutOfMemory> {
        let descriptor = data_format_descriptor(self.format).0;
        let key_values = key_value_data(self.keys);
        let data_offset = Header::LENGTH + LevelIndex::LENGTH * self.levels.len() + descriptor.len() + key_values.len();
        let (index, end) = self.level_index(data_offset);
        let header = self.header(descriptor.len(), key_values.len());

        // Level 0 comes last and is most of the file. Its buffer becomes the file, and the start is put in front, so
        // that only the start needs new memory.
        let mut levels = self.levels;
        let mut file = levels.first_mut().map(|level| mem::take(&mut level.bytes)).unwrap_or_default();
        let (length, start_length) = (file.len(), end - file.len());
        // The start, and the whole file in case level 0 has to move.
        memory::check((start_length + end) as u64)?;
        let mut start = Vec::with_capacity(start_length);
        start.extend_from_slice(&header.as_bytes());
        for level in index.iter().rev() {
            start.extend_from_slice(&level.as_bytes());
        }
        start.extend_from_slice(&descriptor);
        start.extend_from_slice(&key_values);
        for (stored, level) in levels.iter().rev().zip(&index) {
            start.resize(level.byte_offset as usize, 0);
            start.extend_from_slice(&stored.bytes);
        }
        file.resize(end, 0);
        file.copy_within(..length, start_length);
        file[..start_length].copy_from_slice(&start);
        Ok(file)
    }

    fn is_supercompressed(&self) -> bool {
        self.format.codec().is_supercompressed
    }

    /// Returns the level index, smallest level first, for levels that begin after `data_offset`, and the file's length.
    ///
    /// "Mip Padding": levels are stored smallest first. Unless they are supercompressed, each is aligned to the least
    /// common multiple of 4 and the bytes of a texel block.
    fn level_index(&self, data_offset: usize) -> (Vec<LevelIndex>, usize) {
        let alignment = if self.is_supercompressed() { 1 } else { self.format.block_bytes().max(4) };
        let mut index = Vec::with_capacity(self.levels.len());
        let mut end = data_offset;
        for StoredLevel { bytes, uncompressed } in self.levels.iter().rev() {
            let offset = end.next_multiple_of(alignment);
            end = offset + bytes.len();
            index.push(LevelIndex {
                byte_offset: offset as u64,
                byte_length: bytes.len() as u64,
                uncompressed_byte_length: *uncompressed as u64,
            });
        }
        (index, end)
    }

    /// Returns the header of a file whose descriptor and key/value data have these lengths in bytes.
    fn header(&self, descriptor_length: usize, key_value_length: usize) -> Header {
        let descriptor_offset = Header::LENGTH + LevelIndex::LENGTH * self.levels.len();
        let scheme = self.is_supercompressed().then_some(SupercompressionScheme::Zstandard);
        Header {
            format: self.format.vulkan(),
            type_size: data_format_descriptor(self.format).1,
            pixel_width: self.width,
            pixel_height: self.height,
            pixel_depth: 0,
            layer_count: 0,
            face_count: 1,
            level_count: self.levels.len() as u32,
            supercompression_scheme: scheme,
            index: Index {
                dfd_byte_offset: descriptor_offset as u32,
                dfd_byte_length: descriptor_length as u32,
                kvd_byte_offset: (descriptor_offset + descriptor_length) as u32,
                kvd_byte_length: key_value_length as u32,
                sgd_byte_offset: 0,
                sgd_byte_length: 0,
            },
        }
    }
}

/// Returns the "Data Format Descriptor", total size and one basic block, and the `typeSize` of the header.
fn data_format_descriptor(format: PayloadFormat) -> (Vec<u8>, u32) {
    let codec = format.codec();
    let (mut basic, type_size) = match codec.identity {
        // Only formats of the table in `codec` get here, and a test writes a file of each of them.
        Identity::Vulkan(vulkan) => {
            Basic::from_format(vulkan).expect("the crate describes every format that is written")
        }
        Identity::Transcodable(descriptor) => (descriptor(), 1),
    };
    // KHR_texture_basisu: data that is not colour has unspecified primaries and a linear transfer function.
    if !codec.is_srgb {
        basic.color_primaries = None;
        basic.transfer_function = Some(TransferFunction::Linear);
    }
    let block = Block::Basic(basic).to_vec();
    let total = block.len() as u32 + 4;
    ([&total.to_le_bytes()[..], &block].concat(), type_size)
}

/// Returns the "Key/Value Data": sorted by key in Unicode order, values ending in NUL, entries padded to 4 bytes.
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

#[cfg(test)]
mod tests;
