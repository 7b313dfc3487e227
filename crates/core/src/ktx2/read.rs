//! Reading of KTX 2.0: the header as it is stored, and levels decoded to images.
//!
//! Section numbers are those of the KTX File Format Specification, version 2.0.

use std::borrow::Cow;
use std::io;

use ktx2::{Header, ParseError, Reader, SupercompressionScheme, dfd};

use crate::codec::Identity;
use crate::foreign::Foreign;
use crate::image::{Image, Samples};
use crate::ktx2::error::ReadError;
use crate::ktx2::formats::{Coding, block_of};
use crate::ktx2::{basis, blocks, inflate, uncompressed};
use crate::memory::{self, OutOfMemory};

/// A parsed KTX2 file. Parsing allocates nothing that a hostile header could make large.
pub struct Ktx2<'a> {
    bytes: &'a [u8],
    reader: Reader<&'a [u8]>,
    levels: Vec<Level>,
    max_texels: u64,
}

/// Where a mip level is in the file (3.9.7).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    /// Offset from the start of the file, in bytes.
    pub offset: u64,
    /// Length as stored, in bytes.
    pub length: u64,
    /// Length after decompression, in bytes; 0 for BasisLZ.
    pub uncompressed_length: u64,
}

impl<'a> Ktx2<'a> {
    /// Parses the header, the level index, the data format descriptor and the key/value data. Checks that all sections
    /// are inside the file.
    ///
    /// # Errors
    /// [`ReadError::NotKtx2`], [`ReadError::Foreign`], [`ReadError::Truncated`], [`ReadError::Malformed`],
    /// [`ReadError::TooManyKeys`].
    pub fn parse(bytes: &'a [u8]) -> Result<Ktx2<'a>, ReadError> {
        if !bytes.starts_with(&ktx2::MAGIC) {
            return Err(Foreign::detect(bytes).map_or(ReadError::NotKtx2, |found| ReadError::Foreign { found }));
        }
        let failed = |error| from_parser(&error, bytes);
        let start = bytes.first_chunk().ok_or(ParseError::UnexpectedEnd);
        let header = start.and_then(Header::from_bytes).map_err(failed)?;
        let largest = header.pixel_width.max(header.pixel_height).max(header.pixel_depth);
        if header.level_count > largest.ilog2() + 1 {
            return Err(malformed("more levels than the size has"));
        }
        if !matches!(header.face_count, 1 | 6) {
            return Err(malformed("neither 1 nor 6 faces"));
        }
        check_descriptor(bytes)?;
        check_key_count(bytes)?;
        let reader = Reader::new(bytes).map_err(failed)?;
        let entries = bytes.get(Header::LENGTH..).unwrap_or_default();
        let (entries, _) = entries.as_chunks::<{ ktx2::LevelIndex::LENGTH }>();
        let levels = entries.iter().take(header.level_count.max(1) as usize);
        let levels = levels.map(|entry| {
            let entry = ktx2::LevelIndex::from_bytes(entry);
            Level {
                offset: entry.byte_offset,
                length: entry.byte_length,
                uncompressed_length: entry.uncompressed_byte_length,
            }
        });
        let levels = levels.collect();
        Ok(Ktx2 { bytes, reader, levels, max_texels: 1 << 28 })
    }

    /// Sets the most texels that a level may have to be decompressed or decoded, in all its layers, faces and slices
    /// together. The default is 2^28, which is 16384 x 16384.
    pub fn with_max_texels(self, max_texels: u64) -> Ktx2<'a> {
        Ktx2 { max_texels, ..self }
    }

    /// Returns the header as it is stored (3.1 to 3.8).
    pub fn header(&self) -> Header {
        self.reader.header()
    }

    /// Returns the Vulkan name of the texel format without its prefix, such as `R8G8B8A8_UNORM`. Basis Universal
    /// formats are `UNDEFINED`, and an unknown number is `Format(n)`.
    pub fn format_name(&self) -> String {
        let format = self.header().format;
        format.map_or_else(|| "UNDEFINED".to_owned(), |format| format!("{format:?}"))
    }

    /// Returns the basic data format descriptor: colour model, primaries, transfer function, flags and samples. Returns
    /// `None` if the file has only other descriptors.
    pub fn descriptor(&self) -> Option<&dfd::Basic> {
        self.reader.basic_dfd()
    }

    /// Returns the key/value pairs in the file's order, which should be the order of the keys' bytes (3.11.3). Values
    /// are as stored: text includes its NUL. Pairs without a key are left out.
    pub fn key_values(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.reader.key_value_data()
    }

    /// Returns the level index, largest level first. It is never empty.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// Returns the number of levels in the file, at least 1.
    pub fn level_count(&self) -> u32 {
        self.levels.len() as u32
    }

    /// Returns width and height of level `level` in texels, each at least 1.
    pub fn level_size(&self, level: u32) -> (u32, u32) {
        let Header { pixel_width: width, pixel_height: height, .. } = self.header();
        let at = |size: u32| size.checked_shr(level).unwrap_or(0).max(1);
        (at(width), at(height))
    }

    /// Returns the payload of level `level` without Zstandard and zlib: all layers, faces and slices, rows top to
    /// bottom without padding. The payload is never larger than its size and format need, whatever the compressed data
    /// holds.
    ///
    /// # Errors
    /// See [`ReadError`]. BasisLZ has no such payload and is [`ReadError::Unsupported`].
    pub fn level_bytes(&self, level: u32) -> Result<Cow<'a, [u8]>, ReadError> {
        let expected = self.payload_length(level)?;
        let (_, stored) = self.stored(level)?;
        self.check_length(level)?;
        let inflated = match self.header().supercompression_scheme {
            Some(SupercompressionScheme::BasisLZ) => {
                let what = "a BasisLZ payload by itself".to_owned();
                return Err(ReadError::Unsupported { what });
            }
            None => return Ok(Cow::Borrowed(stored)),
            Some(SupercompressionScheme::Zstandard) => match inflate::declared_length(stored) {
                Some(found) if found != expected => return Err(ReadError::LevelLength { level, expected, found }),
                _ => inflate::zstd(stored, expected),
            },
            Some(SupercompressionScheme::ZLIB) => inflate::zlib(stored, expected),
            Some(other) => {
                let what = format!("supercompression scheme {}", other.value());
                return Err(ReadError::Unsupported { what });
            }
        };
        let inflated = inflated.map_err(|error| match error.kind() {
            io::ErrorKind::OutOfMemory => OutOfMemory { bytes: expected }.into(),
            _ => ReadError::Compression { level, what: error.to_string() },
        })?;
        if inflated.len() as u64 != expected {
            return Err(ReadError::LevelLength { level, expected, found: inflated.len() as u64 });
        }
        Ok(Cow::Owned(inflated))
    }

    /// Checks the uncompressed length that the level index gives for level `level` against its size and format. Its
    /// bytes are not read. Under BasisLZ the level index has no such length, and nothing is checked.
    ///
    /// # Errors
    /// [`ReadError::LevelLength`], or the reason why there is no such length.
    pub fn check_length(&self, level: u32) -> Result<(), ReadError> {
        let expected = self.payload_length(level)?;
        let (entry, _) = self.stored(level)?;
        let found = match self.header().supercompression_scheme {
            None => entry.length,
            Some(SupercompressionScheme::BasisLZ) => return Ok(()),
            Some(_) => entry.uncompressed_length,
        };
        if found == expected { Ok(()) } else { Err(ReadError::LevelLength { level, expected, found }) }
    }

    /// Decodes level `level` of a plain 2D texture.
    ///
    /// 8-bit and 16-bit normalised formats keep their depth, and sRGB values are not linearised. Floats are widened to
    /// `f32`. Signed normalised values become `f32` in [-1, 1]. BC1, BC2, BC3, BC7, UASTC and ETC1S give 8 bits. BC4
    /// and BC5 give 16 bits, because their steps are finer than 8 bits. BC6H gives floats. The channels are those of
    /// the format. For Basis Universal they are those that the descriptor names: red and alpha of `RRRG` and `RRR` +
    /// `GGG` become two channels.
    ///
    /// # Errors
    /// See [`ReadError`].
    pub fn decode_level(&self, level: u32) -> Result<Image, ReadError> {
        self.check_shape()?;
        let coding = Coding::of(self.header().format, self.descriptor()).ok_or_else(|| {
            let what = match (self.header().format, self.descriptor()) {
                (None, Some(basic)) => format!("colour model {:?}", basic.color_model),
                _ => self.format_name(),
            };
            ReadError::Unsupported { what }
        })?;
        let (width, height) = self.level_size(level);
        // The size is checked here too, because ETC1S has no payload of a known length.
        self.check_texels(level)?;
        memory::check(coding.decoded_bytes(width, height))?;
        let samples = match &coding {
            Coding::Etc1s(channels) => {
                let (_, stored) = self.stored(level)?;
                let codebooks = self.reader.supercompression_global_data();
                let levels = (level, self.level_count());
                basis::etc1s(stored, codebooks, levels, (width, height), channels)
            }
            coding => decode(self.level_bytes(level)?, coding, (width, height)),
        };
        let samples =
            samples.ok_or_else(|| ReadError::Compression { level, what: "the transcoder refuses it".to_owned() })?;
        Ok(Image { width, height, channels: coding.channels(), samples })
    }

    fn check_shape(&self) -> Result<(), ReadError> {
        let header = self.header();
        let kind = match (header.pixel_height, header.pixel_depth) {
            (0, _) => "a 1D texture",
            (_, 1..) => "a 3D texture",
            _ if header.layer_count > 1 => "an array",
            _ if header.face_count > 1 => "a cube map",
            _ => return Ok(()),
        };
        Err(ReadError::NotPlain2d { kind })
    }

    /// Returns the index entry of a level and its stored bytes.
    fn stored(&self, level: u32) -> Result<(Level, &'a [u8]), ReadError> {
        let no_level = ReadError::NoLevel { asked: level, count: self.level_count() };
        let entry = *self.levels.get(level as usize).ok_or(no_level)?;
        let range = entry.offset as usize..(entry.offset + entry.length) as usize;
        let truncated = ReadError::Truncated { length: self.bytes.len() as u64 };
        Ok((entry, self.bytes.get(range).ok_or(truncated)?))
    }

    /// Checks the number of texels of a level against the limit. Returns the number of 2D images in the level.
    fn check_texels(&self, level: u32) -> Result<u64, ReadError> {
        let header = self.header();
        let (width, height) = self.level_size(level);
        let depth = header.pixel_depth.checked_shr(level).unwrap_or(0).max(1);
        let images = u64::from(header.layer_count.max(1)) * u64::from(depth);
        let images = images.saturating_mul(header.face_count.into());
        let texels = u64::from(width) * u64::from(height);
        match texels.checked_mul(images) {
            Some(texels) if texels <= self.max_texels => Ok(images),
            _ => Err(ReadError::TooLarge { width, height, images, limit: self.max_texels }),
        }
    }

    /// Returns the length of a level without supercompression, in bytes.
    fn payload_length(&self, level: u32) -> Result<u64, ReadError> {
        let images = self.check_texels(level)?;
        let descriptor = self.descriptor();
        let block = block_of(self.header().format, descriptor).ok_or_else(|| malformed("no size of a texel block"))?;
        let (width, height) = self.level_size(level);
        let across = u64::from(width.div_ceil(block.width));
        let down = u64::from(height.div_ceil(block.height));
        (across * down)
            .checked_mul(images)
            .and_then(|blocks| blocks.checked_mul(block.bytes))
            .ok_or_else(|| malformed("a level of more than 2^64 bytes"))
    }
}

/// Decodes a level of `size` texels as [`crate::codec::encode`] returns it. Returns `None` if the payload has another
/// length than the size needs.
pub fn decode_payload(payload: &[u8], format: crate::codec::PayloadFormat, size: (u32, u32)) -> Option<Image> {
    let coding = match format.codec().identity {
        Identity::Vulkan(vulkan) => Coding::of(Some(vulkan), None)?,
        Identity::Transcodable(descriptor) => Coding::of(None, Some(&descriptor()))?,
    };
    if payload.len() != format.level_bytes(size.0, size.1) {
        return None;
    }
    let samples = decode(Cow::Borrowed(payload), &coding, size)?;
    Some(Image { width: size.0, height: size.1, channels: coding.channels(), samples })
}

/// Decodes a payload of the right length. Returns `None` for ETC1S, which needs codebooks.
fn decode(payload: Cow<'_, [u8]>, coding: &Coding, size: (u32, u32)) -> Option<Samples> {
    match coding {
        Coding::Uastc(channels) => basis::uastc(&payload, size, channels),
        Coding::Blocks(format) => Some(blocks::decode(&payload, size, format)),
        Coding::Texels(texel) => Some(uncompressed::decode(payload, texel)),
        Coding::Etc1s(_) => None,
    }
}

fn malformed(what: &'static str) -> ReadError {
    ReadError::Malformed { what }
}

fn from_parser(error: &ParseError, bytes: &[u8]) -> ReadError {
    match error {
        ParseError::BadMagic => ReadError::NotKtx2,
        ParseError::ZeroWidth => malformed("a width of 0"),
        ParseError::ZeroFaceCount => malformed("0 faces"),
        ParseError::InvalidSampleBitLength => malformed("a sample of 256 bits"),
        _ => ReadError::Truncated { length: bytes.len() as u64 },
    }
}

/// Most entries of the key/value data. The specification names some ten keys, and writers add a few of their own.
const MAX_KEYS: usize = 1000;

/// Refuses more than [`MAX_KEYS`] entries (3.11), since a search for one key reads all keys before it.
fn check_key_count(bytes: &[u8]) -> Result<(), ReadError> {
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|word| word.try_into().ok());
        word.map_or(0, u32::from_le_bytes) as usize
    };
    let (start, length) = (word(56), word(60));
    // The parser reports a section outside the file.
    let mut section = bytes.get(start..start.saturating_add(length)).unwrap_or_default();
    for _ in 0..MAX_KEYS {
        let Some((length, rest)) = section.split_first_chunk() else { return Ok(()) };
        let length = u32::from_le_bytes(*length).checked_next_multiple_of(4).map_or(usize::MAX, |n| n as usize);
        section = rest.get(length..).unwrap_or_default();
    }
    if section.is_empty() { Ok(()) } else { Err(ReadError::TooManyKeys { limit: MAX_KEYS }) }
}

/// Refuses texel block dimensions of 256. `ktx2` 0.5 adds 1 to the stored 255 in 8 bits, and panics.
fn check_descriptor(bytes: &[u8]) -> Result<(), ReadError> {
    let word = |at: usize| {
        let bytes = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?) as usize)
    };
    let section = || {
        let (start, length) = (word(48)?, word(52)?);
        bytes.get(start.checked_add(4)?..start.checked_add(length)?)
    };
    // The parser reports a section outside the file.
    let mut blocks = section().unwrap_or_default();
    // The size of a descriptor block is in the upper half of its second word, and the block dimensions are its fifth
    // word (Khronos Data Format 1.3, section 5).
    while let Some(&[low, high]) = blocks.get(6..8) {
        if blocks.get(12..16).is_some_and(|sizes| sizes.contains(&u8::MAX)) {
            return Err(malformed("a texel block of 256 texels"));
        }
        let size = usize::from(u16::from_le_bytes([low, high])).max(1);
        blocks = blocks.get(size..).unwrap_or_default();
    }
    Ok(())
}

#[cfg(test)]
mod tests;
